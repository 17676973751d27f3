// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/read_bytes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>

#include "describe/location.hpp"

namespace anholon {
namespace {

thread_local FilesRead* innermost = nullptr;

}  // namespace

FilesRead::FilesRead() : outer_(innermost) { innermost = this; }
FilesRead::~FilesRead() { innermost = outer_; }

std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(largest_file + 1, '\0');
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(path, ignored) ||
      (stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size())), stream.bad())) {
    throw ModelError({path.string(), 0, 0}, "the file cannot be read", "check its path and permissions");
  }
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  if (bytes.size() > largest_file)
    throw ModelError({path.string(), 0, 0}, fmt::format("the file is larger than {} bytes", largest_file),
                     "split it");
  for (FilesRead* reader = innermost; reader != nullptr; reader = reader->outer_) {
    const auto at = std::ranges::lower_bound(reader->files_, path);
    if (at == reader->files_.end() || *at != path) reader->files_.insert(at, path);
  }
  return bytes;
}

}  // namespace anholon
