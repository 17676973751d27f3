// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What rounding costs a program: its operations in double, one by one as they will be emitted, against the
// same operations in 40 digits, at given states. The optimiser decides by it, so it comes out the same on
// every machine: double is used for + - * / and roots alone, which IEEE 754 rounds correctly, each on its own
// (nothing to contract into a fused multiplication and addition); sines, cosines and other functions, in
// which libraries differ, are rounded from 40 digits.

#include <limits>
#include <string>
#include <vector>

#include "tape/interface.hpp"

namespace anholon {

/// Random states at which errors are measured; further ones are chosen.
inline constexpr int measured_states = 32;

/// In units of 2^-52 of an output's natural scale: the largest entry of its block, at this state or, where
/// that is larger, at the median of the random ones. Of a state's outputs the worst counts.
struct RoundingError {
  double median = std::numeric_limits<double>::quiet_NaN();  // of the states
  double worst = std::numeric_limits<double>::quiet_NaN();   // not a number: not measured
  double excess = std::numeric_limits<double>::quiet_NaN();  // worst in units of what is allowed there

  [[nodiscard]] bool is_measured() const { return worst >= 0; }
  /// "0.52  3.1", or dashes.
  [[nodiscard]] std::string text() const;
};

/// Programs that compute the same outputs; what they share is evaluated once.
/// @param programs  output blocks of each; of empty blocks nothing is said
/// @param states  one value for each input of the tape, in order of their making; states where exact
/// evaluation of some program divides by zero or leaves a domain are left out
/// @param allowance  at each state, for each block of a program: the ulps there that are worth one; 1 where
/// empty
/// @return one error for each program; not measured where no state is left
std::vector<RoundingError> rounding_errors(const Tape& tape,
                                           const std::vector<std::vector<OutputBlock>>& programs,
                                           const std::vector<std::vector<double>>& states,
                                           const std::vector<std::vector<double>>& allowance = {});

}  // namespace anholon
