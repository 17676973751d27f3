// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Generated code against exact evaluation of the same program, and that program against the exact recursion,
// which knows no kernel basis and no optimiser: the first measures rounding, the second the formulas.

#include <functional>
#include <string>
#include <vector>

#include "derive/derive.hpp"

namespace anholon {

struct OutputError {
  std::string function, output;
  double median = 0, p99 = 0, worst = 0;  // of |generated - exact| / natural scale
  double recursion_worst = -1;  // of |double recursion - exact| / natural scale; negative: not computed there
  double condition = 0;         // at the worst, if beyond the bound: relative change per that of the inputs
  std::string worst_at;
  bool passed = true;
  std::string failed_at;  // the sample that is farthest beyond what its condition allows
};

struct Verification {
  std::vector<OutputError> outputs;
  double formula_worst = 0;   // program against recursion, both exact, relative to the natural scale
  std::string formula_at;     // the output where
  double energy_balance = 0;  // worst |dE/dt - power| / scale of the powers
  int samples = 0;
  int formula_samples = 0;
  bool passed = true;
};

/// How many states, and what an error may be, relative to the natural scale; beyond it 10 eps kappa.
struct VerificationPlan {
  int samples = 1000;
  double bound = 1e-13;
};
inline constexpr double formula_bound = 1e-30;  // both sides carry 60 digits

/// @param progress  called now and then with the number of samples done; may be empty
Verification verify_program(const Model& model, const Derivation& derivation, const VerificationPlan& plan,
                            const std::function<void(int)>& progress);

}  // namespace anholon
