// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Characters of names and numbers, whatever the locale.

namespace anholon {

constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace anholon
