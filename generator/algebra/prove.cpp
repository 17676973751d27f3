// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/prove.hpp"

#include "algebra/ring.hpp"

namespace anholon {

bool provably_equal(Tape& tape, NodeId a, NodeId b, std::size_t max_terms) {
  if (a == b) return true;
  try {
    Ring ring(tape, max_terms, Ring::Beyond::give_up);
    const auto values = ring.convert({a, b});
    const Polynomial difference =
        values[0].numerator * values[1].denominator - values[1].numerator * values[0].denominator;
    return ring.normal(difference).is_zero();
  } catch (const SizeLimitExceeded&) {
    return false;
  }
}

}  // namespace anholon
