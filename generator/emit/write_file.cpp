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

[[noreturn]] void throw_cannot_write(const std::filesystem::path& file, int error) {
  throw std::system_error(error, std::generic_category(), "cannot write '" + file.string() + "'");
}

/// @return 0 or errno
int write_and_close(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      ::close(descriptor);
      return error;
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::close(descriptor) == 0 ? 0 : errno;
}

/// Devices and pipes keep their name: /dev/stdout, or >(gzip).
void write_to_device(const std::filesystem::path& file, std::string_view bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  const int error = descriptor < 0 ? errno : write_and_close(descriptor, bytes);
  if (error != 0) throw_cannot_write(file, error);
}

}  // namespace

bool write_file(const std::filesystem::path& named, std::string_view bytes) {
  if (std::filesystem::exists(named) && !std::filesystem::is_regular_file(named)) {
    write_to_device(named, bytes);
    return true;
  }
  // what a link leads to is replaced, not the link
  const std::filesystem::path file =
      std::filesystem::is_symlink(named) ? std::filesystem::weakly_canonical(named) : named;
  if (has_bytes(file, bytes)) return false;
  static std::atomic<unsigned> serial = 0;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::filesystem::path temporary = file;
  temporary += ".tmp" + std::to_string(::getpid()) + "_" + std::to_string(serial++);
  const auto fail = [&](int error) {
    ::unlink(temporary.c_str());
    throw_cannot_write(file, error);
  };
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(errno);
  const int error = write_and_close(descriptor, bytes);
  if (error != 0) fail(error);
  if (std::rename(temporary.c_str(), file.c_str()) != 0) fail(errno);
  return true;
}

}  // namespace anholon
