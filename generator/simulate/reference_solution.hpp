// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The final state of a scene to more digits than double has, by another method and another way to run the
// program: Gauss collocation of order 12 over the tape itself in long double, or, where the program has a
// Jacobian, Radau collocation of order 9. Steps are halved until the state settles.

#include <vector>

#include "simulate/motion_sizes.hpp"
#include "simulate/scene_program.hpp"

namespace anholon {

struct ReferenceSolution {
  std::vector<long double> state;  // R (9, row-major), p (3), r_p, r_d, nu; empty where none was found
  long steps = 0;                  // of the finer of two runs that agree; 0: none was found
  double own_error = 0;            // how far the two differ, as in state_error()
  const char* method = "";
};

/// Largest difference of two final states: of an entry of R as it is, of the others relative to their size
/// along the motion. Infinite where a value is not finite or the reference is empty.
template <class S>
double state_error(const std::vector<S>& state, const std::vector<long double>& reference,
                   const MotionSizes& sizes);

/// @param enough  own error at which it need not become better
ReferenceSolution reference_solution(const Scene& scene, const SceneProgram& program,
                                     const MotionSizes& sizes, double enough = 0);

}  // namespace anholon
