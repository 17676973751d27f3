// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A tape's programs as GiNaC's expressions, whose normal form is an opinion independent of ours. For small programs
// only: a tape shares its subexpressions, GiNaC's automatic flattening does not.

#include <cln/real.h>
#include <ginac/ginac.h>

#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tape/interpret.hpp"
#include "tape/tape.hpp"

namespace GiNaC {

/// Found by argument-dependent look-up where a tape applies Op::sign.
inline ex sign(const ex& x) { return csgn(x); }

}  // namespace GiNaC

namespace anholon {

/// With it, interpret<GiNaC::ex>(tape, roots, inputs) runs a tape over expressions.
template <>
struct FromExact<GiNaC::ex> {
  GiNaC::ex operator()(const Exact& value) const { return GiNaC::numeric(cln::cl_N(value.value())); }
};

namespace test {

class GinacView {
 public:
  explicit GinacView(const Tape& tape) : tape_(&tape) {}

  /// The node, with one symbol for each input. Rationals stay exact; floats are symbols too, since GiNaC's gcd
  /// refuses them.
  GiNaC::ex to_ginac(NodeId root) {
    std::map<NodeId, GiNaC::ex> known;
    for (const NodeId id : tape_->reachable({root})) {
      const Node n = tape_->node(id);
      if (n.op == Op::input) {
        known[id] = symbols_[id];
      } else if (n.op == Op::constant) {
        const Exact& value = tape_->value(id);
        known[id] = value.is_rational() ? FromExact<GiNaC::ex>()(value) : GiNaC::ex(symbols_[id]);
      } else {
        known[id] = apply<GiNaC::ex>(n.op, known[n.a], known[info(n.op).arity == 2 ? n.b : n.a]);
      }
    }
    return known[root];
  }

  /// Whether e is zero by c^2 + s^2 = 1, sums and multiples of angles expanded: the numerator of its normal form,
  /// made linear in every sine, is.
  bool vanishes(const GiNaC::ex& e) {
    GiNaC::ex result = without_functions(e).normal().numer().expand();
    for (const auto& [angle, circle] : circles_) {
      const int degree = result.degree(circle.sine);
      if (degree < 2) continue;
      GiNaC::ex reduced = 0;
      for (int i = 0; i <= degree; ++i) {
        reduced += result.coeff(circle.sine, i) * GiNaC::pow(circle.sine, i % 2) *
                   GiNaC::pow(1 - GiNaC::pow(circle.cosine, 2), i / 2);
      }
      result = reduced.expand();
    }
    return result.is_zero();
  }

 private:
  struct Circle {
    GiNaC::symbol cosine;
    GiNaC::symbol sine;
  };
  /// Cosine and sine of an angle.
  struct Turn {
    GiNaC::ex c = 1;
    GiNaC::ex s = 0;
  };
  static constexpr long largest_expanded_multiple = 4;

  static Turn composed(const Turn& x, const Turn& y) {
    return {(x.c * y.c - x.s * y.s).expand(), (x.s * y.c + x.c * y.s).expand()};
  }
  Turn turn(const GiNaC::ex& angle) {
    const GiNaC::ex e = angle.expand();
    if (e.is_zero()) return {};
    if (GiNaC::is_a<GiNaC::add>(e)) {
      Turn result;
      for (std::size_t i = 0; i < e.nops(); ++i) result = composed(result, turn(e.op(i)));
      return result;
    }
    if (GiNaC::is_a<GiNaC::mul>(e)) {
      GiNaC::numeric factor = 1;
      for (std::size_t i = 0; i < e.nops(); ++i) {
        if (GiNaC::is_a<GiNaC::numeric>(e.op(i))) factor = GiNaC::ex_to<GiNaC::numeric>(e.op(i));
      }
      if (factor.is_rational() && factor.numer() != 1 &&
          GiNaC::abs(factor.numer()) <= largest_expanded_multiple) {
        const Turn once = turn(e / factor.numer());
        const long multiple = factor.numer().to_long();
        Turn result;
        for (long i = 0; i < std::labs(multiple); ++i) result = composed(result, once);
        return {result.c, multiple < 0 ? -result.s : result.s};
      }
    }
    const Circle& circle = circles_[e];
    return {circle.cosine, circle.sine};
  }
  GiNaC::ex without_functions(const GiNaC::ex& e) {
    struct Replace : GiNaC::map_function {
      GinacView* view;
      GiNaC::ex operator()(const GiNaC::ex& x) override {
        if (!GiNaC::is_a<GiNaC::function>(x) || x.nops() != 1) return x.map(*this);
        const std::string name = GiNaC::ex_to<GiNaC::function>(x).get_name();
        if (name != "sin" && name != "cos" && name != "tan") return x.map(*this);
        const Turn t = view->turn((*this)(x.op(0)));
        return name == "sin" ? t.s : name == "cos" ? t.c : t.s / t.c;
      }
    };
    Replace replace;
    replace.view = this;
    return replace(e);
  }

  const Tape* tape_;
  std::map<NodeId, GiNaC::symbol> symbols_;
  std::map<GiNaC::ex, Circle, GiNaC::ex_is_less> circles_;
};

}  // namespace test
}  // namespace anholon
