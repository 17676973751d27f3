// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Accelerations of an unconstrained tree of rigid bodies by articulated bodies (anholon/articulated.hpp). The
// mass matrix in joint coordinates hides the inertia of a small body below that of long or heavy ones on it;
// articulated bodies never add what a free joint takes away again, since nothing of a body's inertia about
// its own joint's axis reaches its parent.

#include <span>
#include <vector>

#include "anholon/mechanism.hpp"
#include "tape/expr.hpp"
#include "tape/tape.hpp"

namespace anholon {

/// Whether it applies: no rows, modes, fluids or wrenches, and a coordinate of its own for every joint.
bool is_rigid_tree(const Mechanism<Expr>& mechanism, const State<Expr>& state);

/// (n + s) accelerations (eta_dot, r_ddot).
/// @param torque  (s) on the coordinates, beside the mechanism's own forces
std::vector<Expr> articulated_accelerations(const Mechanism<Expr>& mechanism, const State<Expr>& state,
                                            const std::vector<Expr>& torque);

/// How much of nodes' values is rounding: their largest error in double, relative to the largest of them, at
/// a few states whose inputs are drawn from +-3, the same on every machine. Infinite where a value is not
/// finite.
/// @param parameters  input nodes, with the values that they have
double rounding_of(const Tape& tape, const std::vector<NodeId>& nodes, std::span<const NodeId> parameters,
                   std::span<const Exact> values);

}  // namespace anholon
