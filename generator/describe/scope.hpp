// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the names in expressions stand for, and which kinds of them an expression may use.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "describe/units.hpp"
#include "tape/expr.hpp"

namespace anholon {

/// A value with its unit, where the unit is known: numbers take whatever unit fits.
struct Quantity {
  Expr value = 0;
  std::optional<Dimension> unit;
};

/// What a name stands for. Expressions are allowed to use some kinds and not others.
enum class SymbolKind : unsigned { parameter = 1, coordinate = 2, velocity = 4, pose = 8, time = 16 };

/// A set of kinds of symbols.
struct Allowed {
  unsigned kinds = 0;
  constexpr Allowed() = default;
  constexpr Allowed(SymbolKind kind)
      : kinds(static_cast<unsigned>(kind)) {}  // NOLINT: a kind is a set of one
  [[nodiscard]] constexpr bool contains(SymbolKind kind) const {
    return (kinds & static_cast<unsigned>(kind)) != 0;
  }
};
constexpr Allowed operator|(Allowed a, Allowed b) {
  a.kinds |= b.kinds;
  return a;
}
constexpr Allowed operator|(SymbolKind a, SymbolKind b) { return Allowed(a) | Allowed(b); }

struct Symbol {
  SymbolKind kind = SymbolKind::parameter;
  Quantity quantity;
  std::string objection;  // why the name may not be used though it is known; else empty
  std::string mend = "remove it";
};

/// The names that expressions of one file may use.
class Scope {
 public:
  void add(std::string name, Symbol symbol) { symbols_[std::move(name)] = std::move(symbol); }
  /// What dot(name) stands for.
  void add_rate(std::string name, Symbol symbol) { rates_[std::move(name)] = std::move(symbol); }

  [[nodiscard]] const Symbol* find(std::string_view name) const;
  [[nodiscard]] const Symbol* find_rate(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> names(Allowed allowed) const;
  [[nodiscard]] std::vector<std::string> names_with_rate() const;

 private:
  std::map<std::string, Symbol, std::less<>> symbols_, rates_;
};

/// "a coordinate", "the time", ...
std::string_view description(SymbolKind kind);
/// "parameters, coordinates and t"
std::string description(Allowed allowed);

}  // namespace anholon
