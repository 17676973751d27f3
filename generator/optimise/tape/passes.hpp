// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The passes over a program, in the order in which they run.

#include <string>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// What a pass left that was worth its while.
struct AfterPass {
  std::string pass;
  std::vector<NodeId> roots;
  int operations = 0;  // of one call, after prepare()
};

/// Opposite differences, common factors, common sums and parameters that are gathered, over and over until no
/// operation falls away; at most three times. On a tape of more than 400000 nodes none of them, because they
/// would dominate the time of generation.
/// @return the steps in order, the last of which is the result; none where nothing helps
std::vector<AfterPass> run_passes(Tape& tape, std::vector<NodeId> roots,
                                  const std::vector<NodeId>& parameters);

}  // namespace anholon
