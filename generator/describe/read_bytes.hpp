// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The one way in which descriptions, scenes, robot files and tables are read.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace anholon {

/// Largest file that is read, in bytes.
inline constexpr std::size_t largest_file = 1 << 20;

/// Bytes of a file. @throws ModelError where it cannot be read or is larger than `largest_file`
std::string read_bytes(const std::filesystem::path& path);

/// The files that read_bytes reads in this thread while the object lives, each once, sorted: what a result depends on.
class FilesRead {
 public:
  FilesRead();
  FilesRead(const FilesRead&) = delete;
  FilesRead& operator=(const FilesRead&) = delete;
  ~FilesRead();

  [[nodiscard]] const std::vector<std::filesystem::path>& files() const { return files_; }

 private:
  friend std::string read_bytes(const std::filesystem::path& path);

  FilesRead* outer_;
  std::vector<std::filesystem::path> files_;
};

}  // namespace anholon
