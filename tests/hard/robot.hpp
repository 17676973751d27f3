// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A model with its generated code, its exact evaluation and its recursion, and how many digits the first and
// the last have at a state.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "check/compile_cache.hpp"
#include "check/evaluate_program.hpp"
#include "derive/derive.hpp"
#include "describe/model.hpp"

namespace anholon::testing {

using Values = std::map<std::string, double>;

/// Of the accelerations at some states: the worst relative errors, each the largest error of an output over
/// its largest entry, and what explains them where the generated code is at its worst. kappa: sum over inputs
/// and parameters of the relative change of the output per relative change of one. kappa_M: condition of the
/// reduced mass matrix scaled to a unit diagonal (van der Sluis 1969), which bounds what elimination loses in
/// the coordinates at hand (Demmel 1989), whether or not the problem asks for it.
struct Kept {
  double in_double = 0, in_float = 0, recursion = 0;
  double kappa = 0, kappa_M = 0;
  // Largest error in units of what it may be: 1e-13 of the natural scale, beyond that 10 eps (kappa +
  // kappa_M); for float the same with its eps.
  double of_bound = 0, of_float_bound = 0, of_recursion_bound = 0;
  // The same where the problem alone counts, 10 eps kappa.
  double of_strict_bound = 0;
};

/// Functions of one model, for any values of its parameters.
class Robot {
 public:
  /// @param path  of the model, below the root of the project     @param defaults  other than the file's
  explicit Robot(const std::string& path, const Values& defaults = {});

  /// Adds one state. Inputs and parameters are rounded to double (to float for the float version, whose exact
  /// result is that of the rounded values); those that are not named are 0 or the default.
  /// @param of_recursion  condition of what the recursion alone inverts: its bound is that much wider
  void compare(const NamedValues<double>& inputs, const Values& parameters, Kept& kept, bool with_float,
               double of_recursion = 0);

  /// One call of the generated code.
  NamedValues<double> call(const std::string& function, const NamedValues<double>& inputs,
                           const Values& parameters);
  /// In arithmetic of `WorkingDigits::current()` digits.
  NamedValues<Exact> exact(const std::string& function, const NamedValues<Exact>& inputs,
                           const Values& parameters);

  [[nodiscard]] const Program& program() const { return derivation_->program; }
  /// How the accelerations are derived.
  [[nodiscard]] std::string route() const;

 private:
  [[nodiscard]] std::vector<double> values_of(const Values& parameters) const;
  /// eta_dot and r_p_ddot, one after the other, by the numeric recursion in double.
  [[nodiscard]] std::vector<double> by_recursion(const NamedValues<double>& inputs,
                                                 const std::vector<double>& parameters) const;

  Model model_;
  std::unique_ptr<Derivation> derivation_;
  std::unique_ptr<CompiledProgram> code_;
};

/// Exact numbers with the values of doubles.
NamedValues<Exact> exactly(const NamedValues<double>& values);

}  // namespace anholon::testing
