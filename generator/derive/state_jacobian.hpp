// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Derivatives of the rates of the state by the state and by time, exact, on the tape: what a linearly
// implicit integrator asks for, and a linearisation along a motion. Forward mode, one direction a column;
// zeros of the Jacobian are no operations.

#include <utility>
#include <vector>

#include "anholon/matrix.hpp"
#include "derive/symbols.hpp"
#include "tape/expr.hpp"

namespace anholon {

/// (input, its tangent) pairs.
using Direction = std::vector<std::pair<NodeId, NodeId>>;

/// The directions in which the state (g, r_p, r_d, nu) may move, and that of time.
struct StateDirections {
  std::vector<Direction> columns;  // twists of g in body axes, r_p, r_d, nu; the other inputs stay
  Direction time;  // t, and the motion of r_a with it: r_a -> r_a_dot -> r_a_ddot -> r_a_dddot
};

StateDirections state_directions(Tape& tape, const ProgramSymbols& symbols, const Partition& partition,
                                 const std::vector<Expr>& nu, const std::vector<Expr>& r_a_dot,
                                 const std::vector<Expr>& r_a_ddot, const std::vector<Expr>& r_a_dddot);

/// Columns of d roots / d direction, the last one that of time.
Matrix<Expr> derivatives(Tape& tape, const std::vector<NodeId>& roots, const StateDirections& directions);

/// The nodes with expressions in place of some inputs.
std::vector<NodeId> substituted(Tape& tape, const std::vector<NodeId>& nodes, const std::vector<Expr>& inputs,
                                const std::vector<Expr>& values);

}  // namespace anholon
