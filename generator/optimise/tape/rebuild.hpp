// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Copies what some roots need onto the end of their own tape, node by node, so that a pass may put other
// nodes in the place of single ones and the folding rules of the tape act on the result.

#include <functional>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// What a node becomes. @param image  the new node of every node that was seen before, by old id
using Replacement = std::function<NodeId(NodeId old, const std::vector<NodeId>& image)>;

/// The operation of an old node on the images of its operands.
NodeId copied(Tape& tape, NodeId old, const std::vector<NodeId>& image);

/// @return the images of the roots
std::vector<NodeId> rebuild(Tape& tape, const std::vector<NodeId>& roots, const Replacement& replace);

}  // namespace anholon
