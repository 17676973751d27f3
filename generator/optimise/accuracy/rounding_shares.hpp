// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Which operations the rounding error of a program comes from, and what the rounding of the inputs excuses:
// first order estimates from derivatives, far quicker than measuring.

#include <vector>

#include "tape/interface.hpp"

namespace anholon {

struct RoundingShares {
  /// For each node of the tape, the most that rounding it to double moves any output at any state: half an
  /// ulp of the node times the derivative of the output, in ulps of the output's natural scale (the largest
  /// entry of its block, at this state or at the median one) and of the allowance there. Zero for nodes that
  /// are not needed.
  std::vector<double> of_node;
  /// At each state, for each block: how much larger than elsewhere an error may be. 1, or a fifth of kappa
  /// where kappa, what one ulp of every input changes in the block, is beyond 5: as `anholon verify` has it
  /// with 50 ulps and 10 kappa ulps.
  std::vector<std::vector<double>> allowance;
};

/// What follows comes out the same on every machine.
/// @param states  one value for each input of the tape, in order of their making
RoundingShares rounding_shares(const Tape& tape, const std::vector<OutputBlock>& outputs,
                               const std::vector<std::vector<double>>& states);

/// What a program loses at each state to first order, in ulps of the scale and of the allowance there; the
/// worst entry counts. What each operation loses there is known, and is carried to the outputs by
/// derivatives.
/// @param shares  of each node; empty: nothing is compensated
/// @param bounds  operations whose share is beyond such a bound are taken to be compensated; in falling order
/// @return for each bound the errors at each state
std::vector<std::vector<double>> first_order_errors(const Tape& tape, const std::vector<OutputBlock>& outputs,
                                                    const std::vector<std::vector<double>>& states,
                                                    const std::vector<double>& shares = {},
                                                    const std::vector<double>& bounds = {0});

/// What one ulp of every input, parameters among them, changes in a block, in ulps of a scale: to first
/// order, with derivatives in double.
double first_order_condition(const Tape& tape, const OutputBlock& block, const std::vector<double>& state,
                             double scale);

}  // namespace anholon
