// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "tape/tape.hpp"

namespace anholon {

/// Whether a - b is zero as a quotient of polynomials in the inputs, in the cosines and sines of angles (sums
/// and multiples of angles expanded, c^2 + s^2 = 1) and in other functions of equal arguments. `false` also
/// where a polynomial on the way has more than `max_terms` terms: not proved.
bool provably_equal(Tape& tape, NodeId a, NodeId b, std::size_t max_terms = 4000);

}  // namespace anholon
