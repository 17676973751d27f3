// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// (a + x) + b with parameters a and b becomes x + (a + b), and a (b x) becomes (a b) x: what depends on
// parameters alone is then computed once per parameter set (hoist.hpp). Constants are gathered with them, and
// by themselves where parameters are frozen.

#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// @param parameters  input nodes that are constant between calls
/// @return nodes with the values of the roots; never more additions, multiplications and divisions per call
/// than before
std::vector<NodeId> gather_parameters(Tape& tape, const std::vector<NodeId>& roots,
                                      const std::vector<NodeId>& parameters);

}  // namespace anholon
