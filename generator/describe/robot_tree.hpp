// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Links and joints as a tree: who hangs on whom, and which joint follows which.

#include <vector>

#include "describe/robot_file.hpp"

namespace anholon {

/// A link in the order of bodies, with the joint that carries it.
struct RobotNode {
  int link = 0;
  int joint = -1;   // -1: the root
  int parent = -1;  // index of the node of the parent link
};

/// Displacement of a joint as multiplier * (that of joint `leader`) + offset.
struct RobotFollower {
  int leader = 0;
  Exact multiplier = 1;
  Exact offset = 0;
};

struct RobotTree {
  std::vector<RobotNode> nodes;          // parents first, children in the order of the file
  std::vector<RobotFollower> followers;  // one for each joint; its own leader where it does not mimic
};

/// @throws ModelError where the file is no tree or mimics go round in a circle
RobotTree robot_tree(const RobotFile& file, const Location& whole_file);

}  // namespace anholon
