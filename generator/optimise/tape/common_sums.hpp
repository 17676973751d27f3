// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Parts that sums of several terms share in another order: (a + x) + b and (b + y) + a have a + b in common.

#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// Greedy, by pairs of terms: Breuer 1969. @return nodes with the values of the roots; never more additions,
/// multiplications and divisions than before
std::vector<NodeId> share_common_sums(Tape& tape, std::vector<NodeId> roots);

}  // namespace anholon
