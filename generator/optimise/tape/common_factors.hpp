// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Sums of products with a common factor: c x + c y + ... becomes c (x + y) + ..., where nothing else uses the
// products.

#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// @return nodes with the values of the roots; never more additions, multiplications and divisions than
/// before
std::vector<NodeId> extract_common_factors(Tape& tape, std::vector<NodeId> roots);

}  // namespace anholon
