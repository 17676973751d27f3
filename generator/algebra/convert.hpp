// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// GiNaC <-> tape. Include it only in this folder and in tests: GiNaC is no part of any other interface.

#include <ginac/ginac.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

class GinacConverter {
 public:
  /// cos x and sin x as two symbols related by c^2 + s^2 = 1, or as GiNaC's functions.
  enum class Angles { symbols, functions };

  GinacConverter(Tape& tape, Angles angles) : tape_(&tape), angles_(angles) {}

  /// The node as an expression: one symbol for each input and, with Angles::symbols, two for each angle (sums
  /// and multiples of angles expanded). Rationals stay exact; floats are symbols too, since GiNaC's gcd
  /// refuses them. Beware: a tape shares its subexpressions, GiNaC's automatic flattening does not. For small
  /// programs only.
  GiNaC::ex to_ginac(NodeId root);

  /// The expression as a node. Operands are sorted by a text made of the symbols' numbers and of the
  /// structure, the leading sign is pulled out of every sum, integer powers are squared repeatedly: GiNaC's
  /// own order, which differs from run to run, leaves no trace.
  /// @throws std::invalid_argument on symbols and functions that the tape does not know
  NodeId to_tape(const GiNaC::ex& e);

  /// Numerator of normal(e), expanded, linear in every sine: zero exactly where e is zero by c^2 + s^2 = 1.
  GiNaC::ex residual(const GiNaC::ex& e);

 private:
  struct Circle {
    GiNaC::symbol cosine;
    GiNaC::symbol sine;
  };
  /// Sign pulled out, and the text that orders operands, which does not see that sign.
  struct Canonical {
    bool negative;
    NodeId magnitude;
    std::string key;
  };

  GiNaC::ex symbol(NodeId id);
  std::pair<GiNaC::ex, GiNaC::ex> turn(const GiNaC::ex& angle);
  GiNaC::ex without_functions(const GiNaC::ex& e);
  Canonical canonical(const GiNaC::ex& e);
  Canonical canonical_sum(const GiNaC::ex& e);
  Canonical canonical_product(const GiNaC::ex& e);
  Canonical canonical_power(const GiNaC::ex& e);
  Canonical canonical_function(const GiNaC::ex& e);
  NodeId with_sign(const Canonical& c);
  NodeId power(NodeId base, unsigned long exponent);

  Tape* tape_;
  Angles angles_;
  std::map<NodeId, GiNaC::symbol> symbols_;
  std::map<GiNaC::ex, NodeId, GiNaC::ex_is_less> nodes_;           // of symbols; looked up, never iterated
  std::map<GiNaC::ex, std::size_t, GiNaC::ex_is_less> circle_of_;  // by angle; looked up, never iterated
  std::vector<Circle> circles_;
};

}  // namespace anholon
