// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Whether rounding has left digits in the accelerations at a state: the generated code against the same
// program in exact arithmetic, and where few are left, whether rounded inputs alone would have taken them.

#include "simulate/runner.hpp"
#include "simulate/scene_program.hpp"
#include "simulate/simulation.hpp"

namespace anholon {

/// At the state in the buffers. Needs impose() and set().
RoundingLoss rounding_loss(const SceneProgram& program, Runner<double>& run);

}  // namespace anholon
