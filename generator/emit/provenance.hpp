// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Where a generated file comes from: versions and hashes, never paths, dates or host names.

#include <string>
#include <string_view>

namespace anholon {

/// Version of this generator, "0.1.0".
std::string_view generator_version();

/// SHA-256 as 64 hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

/// What follows the last separator of a path.
std::string base_name(std::string_view path);

}  // namespace anholon
