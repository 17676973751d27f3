// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The functions of a driven tree at one state, in the form of everything else that is evaluated.

#include "check/tree_reference.hpp"

namespace anholon {

template <class S>
TreePoint<S> tree_point(const EvaluationInput<S>& input, const Spatial<Exact>& eta_dot) {
  TreePoint<S> point{input.state, {}, input.r_ddot, input.tau};
  for (int i = 0; i < 6; ++i) point.eta_dot[i] = FromExact<S>{}(eta_dot[i]);
  return point;
}

/// Functions that evaluate_tree calls, besides those that a request names.
const std::vector<std::string>& functions_of_evaluation();

/// What answer() needs, from compiled code of a tree's program.
Evaluated<double> evaluate_tree(const Mechanism<double>& mechanism, const ProgramCaller<double>& call,
                                const EvaluationInput<double>& input, const TreePoint<double>& point);

}  // namespace anholon
