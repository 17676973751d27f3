// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/units.hpp"

#include <fmt/format.h>

#include "describe/ascii.hpp"
#include "describe/names.hpp"

namespace anholon {
namespace {

struct Unit {
  std::string_view name;
  Dimension dimension;
};

constexpr auto table = std::to_array<Unit>({
    {"kg", {{1, 0, 0}}},
    {"m", {{0, 1, 0}}},
    {"s", {{0, 0, 1}}},
    {"rad", {{0, 0, 0}}},
    {"1", {{0, 0, 0}}},
    {"N", {{1, 1, -2}}},
    {"Pa", {{1, -1, -2}}},
    {"J", {{1, 2, -2}}},
    {"W", {{1, 2, -3}}},
    {"Hz", {{0, 0, -1}}},
});

/// Units that people write though they are not coherent, and what to write instead.
constexpr auto scaled_units = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"g", "kg"},  {"t", "kg"},    {"mm", "m"},       {"cm", "m"},      {"dm", "m"},   {"km", "m"},
    {"um", "m"},  {"in", "m"},    {"ft", "m"},       {"ms", "s"},      {"us", "s"},   {"min", "s"},
    {"h", "s"},   {"deg", "rad"}, {"degree", "rad"}, {"rpm", "rad/s"}, {"mN", "N"},   {"kN", "N"},
    {"lbf", "N"}, {"kPa", "Pa"},  {"MPa", "Pa"},     {"GPa", "Pa"},    {"bar", "Pa"}, {"kJ", "J"},
    {"mJ", "J"},  {"kW", "W"},    {"kHz", "Hz"},     {"lb", "kg"},
});

constexpr std::size_t longest_unit = 64;
constexpr int largest_power = 12;

class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : text_(text) {}

  Dimension read() {
    if (text_.size() > longest_unit) throw UnitError(0, "the unit is too long", "write it with base units");
    skip_spaces();
    if (at_ == text_.size()) throw UnitError(0, "the unit is empty", "write \"1\" for a plain number");
    Dimension result = factor();
    bool divided = false;
    for (skip_spaces(); at_ < text_.size(); skip_spaces()) {
      const std::size_t begin = at_;
      if (text_[at_] == '/') {
        ++at_;
        skip_spaces();
        result = result / factor();
        divided = true;
      } else {
        if (text_[at_] == '*') {
          ++at_;
          skip_spaces();
        }
        if (divided)
          throw UnitError(begin, "a product behind a slash is ambiguous",
                          "write products before the first '/'");
        result = result * factor();
      }
    }
    return result;
  }

 private:
  void skip_spaces() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }

  Dimension factor() {
    const std::size_t begin = at_;
    if (at_ < text_.size() && text_[at_] == '1') {
      ++at_;
    } else {
      while (at_ < text_.size() && is_letter(text_[at_])) ++at_;
    }
    if (at_ == begin) {
      throw UnitError(begin,
                      at_ == text_.size() ? "the unit ends where a unit is expected"
                                          : fmt::format("'{}' does not begin a unit", shown(text_[at_])),
                      "write for example \"kg m^2\" or \"N s/m\"");
    }
    const Dimension base = named(text_.substr(begin, at_ - begin), begin);
    const int exponent = power();
    Dimension result;
    for (std::size_t i = 0; i < 3; ++i) result.power[i] = exponent * base.power[i];
    return result;
  }

  static std::string shown(char c) {
    return c > ' ' && c < 127 ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }

  static Dimension named(std::string_view name, std::size_t begin) {
    for (const Unit& unit : table) {
      if (unit.name == name) return unit.dimension;
    }
    for (const auto& [scaled, coherent] : scaled_units) {
      if (scaled == name) {
        throw UnitError(begin, fmt::format("'{}' is not a unit of the coherent SI", name),
                        fmt::format("give the value in {}; numbers are never converted", coherent));
      }
    }
    std::vector<std::string> known;
    for (const Unit& unit : table) known.emplace_back(unit.name);
    throw UnitError(begin, fmt::format("'{}' is not a unit that is known here", name),
                    fmt::format("write it with {}", listed(known)));
  }

  int power() {
    if (at_ >= text_.size() || text_[at_] != '^') return 1;
    const std::size_t begin = ++at_;
    const bool negative = at_ < text_.size() && text_[at_] == '-';
    if (negative) ++at_;
    int value = 0;
    const std::size_t digits = at_;
    for (; at_ < text_.size() && is_digit(text_[at_]) && value <= largest_power; ++at_)
      value = 10 * value + (text_[at_] - '0');
    if (at_ == digits || value > largest_power) {
      throw UnitError(begin, "the power of a unit must be an integer",
                      fmt::format("at most {}", largest_power));
    }
    return negative ? -value : value;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

Dimension operator*(const Dimension& a, const Dimension& b) {
  return {{a.power[0] + b.power[0], a.power[1] + b.power[1], a.power[2] + b.power[2]}};
}

Dimension operator/(const Dimension& a, const Dimension& b) {
  return {{a.power[0] - b.power[0], a.power[1] - b.power[1], a.power[2] - b.power[2]}};
}

std::string Dimension::text() const {
  constexpr std::array<std::string_view, 3> names = {"kg", "m", "s"};
  std::string above, below;
  for (std::size_t i = 0; i < 3; ++i) {
    const int n = power[i] < 0 ? -power[i] : power[i];
    if (n == 0) continue;
    const std::string factor = n == 1 ? std::string(names[i]) : fmt::format("{}^{}", names[i], n);
    if (power[i] > 0) {
      above += (above.empty() ? "" : " ") + factor;
    } else {
      below += "/" + factor;
    }
  }
  return (above.empty() ? "1" : above) + below;
}

Dimension read_unit(std::string_view text) { return UnitReader(text).read(); }

}  // namespace anholon
