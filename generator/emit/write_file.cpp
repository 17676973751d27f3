// SPDX-License-Identifier: GPL-2.0-or-later
#include "emit/write_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace anholon {
namespace {

bool has_bytes(const std::filesystem::path& file, std::string_view bytes) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return false;
  const std::string present((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  return present == bytes;
}

}  // namespace

bool write_file(const std::filesystem::path& file, std::string_view bytes) {
  if (has_bytes(file, bytes)) return false;
  static std::atomic<unsigned> serial = 0;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::filesystem::path temporary = file;
  temporary += ".tmp" + std::to_string(::getpid()) + "_" + std::to_string(serial++);
  const auto fail = [&](int error) {
    ::unlink(temporary.c_str());
    throw std::system_error(error, std::generic_category(), "cannot write '" + file.string() + "'");
  };
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(errno);
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      ::close(descriptor);
      fail(error);
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::close(descriptor) != 0) fail(errno);
  if (std::rename(temporary.c_str(), file.c_str()) != 0) fail(errno);
  return true;
}

}  // namespace anholon
