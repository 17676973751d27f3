// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Which nodes a set of roots needs when some values are already given.

#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// Nodes that the roots need, in order of creation. A given node is kept where it is needed, but what it is
/// made of is not followed.
std::vector<NodeId> needed_nodes(const Tape& tape, const std::vector<NodeId>& roots,
                                 const std::vector<NodeId>& given = {});

}  // namespace anholon
