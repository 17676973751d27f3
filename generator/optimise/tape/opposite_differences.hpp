// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// a - b and b - a are one operation: signs are taken out of products and differences and carried to the
// users, so that values that differ in sign alone are computed once.

#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// @return nodes with the values of the roots; never more additions, multiplications and divisions than
/// before
std::vector<NodeId> merge_opposite_differences(Tape& tape, const std::vector<NodeId>& roots);

}  // namespace anholon
