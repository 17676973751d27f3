// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Tables for the functions that are emitted as loops (templates/tree_loops.inl), and what the loops of the
// regressor start from.

#include <optional>
#include <string>
#include <vector>

#include "anholon/rigid_tree.hpp"
#include "tape/expr.hpp"
#include "tape/interface.hpp"

namespace anholon {

/// Function from whose outputs the loops of the regressor start.
inline constexpr const char* regressor_motion = "regressor_motion";

/// Whether a function can be emitted as loops.
bool has_loops(const std::string& function);

/// Tables of a function of a tree whose position is set; none where the function has no loops, or where the
/// coordinates are not one for each joint in the order of the tree, subtree by subtree.
std::optional<TreeLoops> tree_loops(const std::string& function, const RigidTree<Expr>& tree);

/// Bodies in the axes of the reference body and joints as twists, as regressor_rows takes them. Needs
/// position() and move().
struct RegressorMotion {
  std::vector<Expr> motion;  // (bodies x 21)
  std::vector<Expr> axes;    // (bodies x 6)
};
RegressorMotion motion_for_regressor(const RigidTree<Expr>& tree);

}  // namespace anholon
