// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace anholon {

/// SHA-256 of some bytes, as 64 hexadecimal digits.
std::string sha256_of(std::string_view bytes);

}  // namespace anholon
