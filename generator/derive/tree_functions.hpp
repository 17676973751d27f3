// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The functions of an unconstrained tree of rigid bodies, all of whose coordinates are driven: inverse and
// forward dynamics, mass matrix and their like. Each is derived in several frames and by several algorithms;
// the shortest program that keeps enough digits is taken.

#include <memory>
#include <string>
#include <vector>

#include "derive/derive.hpp"
#include "describe/model.hpp"
#include "tape/interface.hpp"

namespace anholon {

struct TreeRequest {
  std::string scene = "standard";
  std::vector<std::string> functions;  // wanted; empty: standard_tree_functions()
  bool search = true;  // try every choice of frames and algorithm; else only the first of each
  OptimiseFor optimise = OptimiseFor::balanced;
  bool trace = false;  // fill TreeDerivation::trace, and the errors of all candidates
};

struct TreeDerivation {
  Program program;
  std::vector<CandidateReport> candidates;
  std::vector<std::string> passes;  // what the passes on the mechanism did
  std::vector<PassReport> trace;    // in the order in which the passes run, function by function
};

/// Names of the functions that derive_tree knows, in the order in which programs list them.
const std::vector<std::string>& tree_function_names();

/// Those that are derived where none are named: inverse and forward dynamics, bias, gravity, mass matrix.
const std::vector<std::string>& standard_tree_functions();

/// Whether a model is one: no rows, external wrenches or compliant bodies, every coordinate driven, no force
/// of time, none on the reference body but gravity.
bool is_driven_tree(const Model& model);

/// Inputs are R (orientation of the reference body, for a group that turns), eta, eta_dot, r, r_dot, r_ddot,
/// tau; twists and wrenches are those of the described reference body in its own axes, (V, Omega) and (force,
/// torque).
/// @throws UnsupportedError where the model has constraints, external wrenches or compliant bodies
std::unique_ptr<TreeDerivation> derive_tree(const Model& model, const TreeRequest& request = {});

}  // namespace anholon
