// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Functions that are emitted as loops over the tables of a tree (templates/tree_loops.inl): their values as
// nodes of a tape, for evaluation at any precision, and their operations.

#include <vector>

#include "optimise/tape/count.hpp"
#include "tape/expr.hpp"
#include "tape/interface.hpp"

namespace anholon {

/// Runs the loops on expressions.
/// @param from  outputs of the function that is called first, block by block
/// @return the outputs, block by block: L and D, the inverse, or Y
std::vector<std::vector<Expr>> values_of(const TreeLoops& loops, const std::vector<std::vector<Expr>>& from);

/// Operations of the loops alone: they are run on a scalar that counts.
OperationCount count_operations(const TreeLoops& loops);

/// The function whose nodes are emitted for `function`: itself, or the one before its loops.
/// @throws std::logic_error where the program lacks that
const Function& straight_line(const Program& program, const Function& function);

/// Operations of one call, after prepare(): those of the nodes, or of the loops and the function before them.
OperationCount operations_per_call(const Program& program, const Function& function);

}  // namespace anholon
