// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Differences that cancel, written so that they do not:
//
//   1 - cos x             2 sin(x/2)^2;  1 - cos x cos y likewise, factor by factor
//   1 - cos(x)^2          sin(x)^2, and the other way round
//   cos x - cos y         -2 sin((x + y)/2) sin((x - y)/2);  sin x - sin y likewise
//   sin x cos y - cos x sin y    sin(x - y)
//   a^2 - b^2             (a - b) (a + b);  cos(x)^2 - sin(x)^2 is cos(2 x)
//   sqrt(k^2 + x) - k     x / (sqrt(k^2 + x) + k) for a number k > 0
//   exp(x) - 1            tanh(x/2) (exp(x) + 1)
//
// each with any common factor of both terms, among the terms of a longer sum, too. They hold everywhere,
// divide by nothing that vanishes and branch nowhere; what they cost is sines.

#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// @return nodes with the values of the roots; the roots themselves where nothing of the kind is there
std::vector<NodeId> stable_forms(Tape& tape, std::vector<NodeId> roots);

}  // namespace anholon
