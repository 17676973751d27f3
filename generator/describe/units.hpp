// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Units of the coherent SI, as text ("kg m^2", "N s/m") and as powers of kg, m and s. Units are checked,
// never converted: rad is 1, and a unit with a scale (mm, deg) is refused.

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace anholon {

/// Powers of kg, m and s.
struct Dimension {
  std::array<int, 3> power = {0, 0, 0};

  [[nodiscard]] bool is_number() const { return power == std::array<int, 3>{0, 0, 0}; }
  /// "kg m^2/s^2"; "1" for a plain number
  [[nodiscard]] std::string text() const;

  friend bool operator==(const Dimension&, const Dimension&) = default;
};

Dimension operator*(const Dimension& a, const Dimension& b);
Dimension operator/(const Dimension& a, const Dimension& b);

namespace units {
inline constexpr Dimension one{};
inline constexpr Dimension kg{{1, 0, 0}};
inline constexpr Dimension m{{0, 1, 0}};
inline constexpr Dimension s{{0, 0, 1}};
}  // namespace units

/// A unit that cannot be read.
struct UnitError : std::runtime_error {
  UnitError(std::size_t at, std::string what_is_wrong, std::string way_out)
      : std::runtime_error(what_is_wrong),
        offset(at),
        fact(std::move(what_is_wrong)),
        mend(std::move(way_out)) {}
  std::size_t offset;  // of the character in the text
  std::string fact, mend;
};

/// Reads units separated by spaces, each with an optional integer power; a slash divides by the unit behind
/// it.
/// @throws UnitError
Dimension read_unit(std::string_view text);

}  // namespace anholon
