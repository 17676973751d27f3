// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "algebra/ring.hpp"

namespace anholon::test {

/// Whether a - b is zero as a quotient of polynomials in the inputs, in the cosines and sines of angles (sums and
/// multiples of angles expanded, c^2 + s^2 = 1) and in other functions of equal arguments.
inline bool provably_equal(Tape& tape, NodeId a, NodeId b) {
  Ring ring(tape, 4000, Ring::Beyond::give_up);
  const auto values = ring.convert({a, b});
  return ring
      .normal(values[0].numerator * values[1].denominator - values[1].numerator * values[0].denominator)
      .is_zero();
}

}  // namespace anholon::test
