// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Forward-mode differentiation on the tape. Zero tangents are not nodes, so sparsity costs nothing.

#include <utility>
#include <vector>

#include "tape/expr.hpp"

namespace anholon {

/// Derivatives of the roots along one direction of the inputs.
/// @param direction  (input node, its tangent); inputs that are not named stay fixed
std::vector<NodeId> directional_derivative(Tape& tape, const std::vector<NodeId>& roots,
                                           const std::vector<std::pair<NodeId, NodeId>>& direction);

/// d root / d x for an input node x.
NodeId derivative(Tape& tape, NodeId root, NodeId x);

}  // namespace anholon
