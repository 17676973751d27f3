// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Random inputs of a whole program, at which the optimiser measures rounding.

#include <vector>

#include "describe/model.hpp"
#include "tape/interface.hpp"

namespace anholon {

/// Pose and shape in the working range, everything else in +-1, parameters at their defaults. The value of an
/// input depends on its name and the number of the state alone, not on which other inputs there are.
/// @return for each state one value for each input of the tape, in order of their making
std::vector<std::vector<double>> sampled_inputs(const Model& model, const Program& program, int states);

}  // namespace anholon
