// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace anholon {

/// Writes a file whole or not at all: into a temporary file beside it, which is then renamed. Missing folders
/// are made. A file that has these bytes already is not touched, so that builds which depend on it stay up to
/// date. Devices and pipes are written to as they are.
/// @return whether the file changed
/// @throws std::system_error naming the file
bool write_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace anholon
