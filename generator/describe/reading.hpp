// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the parts of a description share while it is read: the model that is being filled, the names that
// expressions may use, the errors found so far, and the value of every expression at the default parameters.

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "describe/document.hpp"
#include "describe/expression.hpp"
#include "describe/findings.hpp"
#include "describe/model.hpp"

namespace anholon {

namespace units {
inline constexpr Dimension kg_m{{1, 1, 0}};
inline constexpr Dimension kg_m2{{1, 2, 0}};
inline constexpr Dimension m_per_s{{0, 1, -1}};
inline constexpr Dimension m_per_s2{{0, 1, -2}};
inline constexpr Dimension per_s{{0, 0, -1}};
inline constexpr Dimension newton{{1, 1, -2}};
inline constexpr Dimension newton_m{{1, 2, -2}};
inline constexpr Dimension watt{{1, 2, -3}};
}  // namespace units

/// Values of a tape's nodes at the default parameters, at rest in the reference configuration; each computed
/// once.
class DefaultValues {
 public:
  explicit DefaultValues(const Tape& tape) : tape_(tape) {}
  /// Value of the next input of the tape.
  void add_input(Exact value) { inputs_.push_back(std::move(value)); }
  /// Empty where it is undefined there (a root of a negative number, a division by zero, a number out of
  /// range).
  std::optional<Exact> at(const Expr& x);

 private:
  [[nodiscard]] std::optional<Exact> computed(NodeId id) const;

  const Tape& tape_;
  std::vector<Exact> inputs_;
  std::vector<std::optional<Exact>> values_;
};

class Reading {
 public:
  Reading(Model& model, Findings& findings) : model(model), findings(findings), defaults(*model.tape) {}

  /// A number or an expression as a node of the model's tape; after an error, zero.
  /// @param what  the number as it stands in messages: "the mass of body 'wheel'"
  /// @param unit  the unit it has to have, where one is prescribed
  Expr number(const Value& value, std::string_view what, std::optional<Dimension> unit,
              Allowed allowed = SymbolKind::parameter);
  /// An array of three numbers.
  std::array<Expr, 3> vector3(const Value& value, std::string_view what, std::optional<Dimension> unit,
                              Allowed allowed = SymbolKind::parameter);
  /// An array of three numbers scaled to unit length; scaling leaves a note.
  std::array<Expr, 3> direction(const Value& value, std::string_view what);
  /// Scales to unit length a vector whose components are numbers and parameters.
  std::array<Expr, 3> normalised(const std::array<Expr, 3>& v, const Location& where, std::string_view what);
  /// [lower, upper] at the default parameters; empty after an error.
  std::optional<std::array<Exact, 2>> range(const Value& value, std::string_view what, Dimension unit);
  /// Value at the default parameters; an undefined one is an error, and zero.
  Exact at_defaults(const Expr& x, const Location& where, std::string_view what);

  /// A name for something new, checked; empty after an error.
  std::string new_name(const Value& value, std::string_view what);

  Model& model;
  Findings& findings;
  Scope scope;
  DefaultValues defaults;
};

/// The text of a TOML number without its underscores; empty if it is not a decimal number.
std::string decimal_text(const Value& value);

/// A decimal number of bounded size, or a string that holds one.
std::optional<Exact> decimal_value(const Value& value);

/// Runs `fill`, in which derivatives are taken. @throws ModelError, naming the file alone, where constants
/// meet in one of them and leave it undefined, far from where they stand
template <class Fill>
void fill_model(const std::string& file, Findings& findings, const Fill& fill) {
  try {
    fill();
  } catch (const std::domain_error& error) {
    findings.throw_if_any();
    throw ModelError({file, 0, 0}, std::string("a derivative is undefined everywhere: ") + error.what(),
                     "check couplings, rows and motions for constant divisions and roots");
  }
  findings.throw_if_any();
}

/// Scalar and vector product.
Expr dot(const std::array<Expr, 3>& a, const std::array<Expr, 3>& b);
std::array<Expr, 3> cross(const std::array<Expr, 3>& a, const std::array<Expr, 3>& b);

}  // namespace anholon
