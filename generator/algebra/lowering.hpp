// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Polynomials and quotients back onto the tape. The order of every sum and product follows from the ring's
// numbering of the variables.

#include <map>
#include <vector>

#include "algebra/ring.hpp"

namespace anholon {

class Lowering {
 public:
  Lowering(Tape& tape, const Ring& ring) : tape_(&tape), ring_(&ring) {}

  /// Factors, then nested: whatever most terms have in common is taken out of them, again and again.
  NodeId polynomial(const Polynomial& p);
  /// Quotients with one division for each different denominator.
  std::vector<NodeId> fractions(const std::vector<Fraction>& values);

 private:
  NodeId leading_positive(const Polynomial& p);
  /// Product of factors.
  NodeId product(const Polynomial& p);
  /// Nested form of a polynomial without common monomial.
  NodeId nested(const Polynomial& p);
  NodeId sum(const Polynomial& p);
  NodeId power(NodeId base, unsigned exponent);
  NodeId scaled(const cln::cl_RA& factor, NodeId id);

  Tape* tape_;
  const Ring* ring_;
  std::map<Polynomial, NodeId> known_;
};

/// Weight of the operations that the roots need: additions and multiplications 2, negations 1, divisions and
/// roots 8, others 40.
std::size_t operation_weight(const Tape& tape, const std::vector<NodeId>& roots);

}  // namespace anholon
