// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/convert.hpp"

#include <cln/rational_ring.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <stdexcept>

#include "algebra/ginac_scalar.hpp"

namespace anholon {
namespace {

constexpr long largest_expanded_multiple = 4;

struct NamedFunction {
  const char* ginac;
  Op op;
};
constexpr std::array named_functions = {
    NamedFunction{"sin", Op::sin},   NamedFunction{"cos", Op::cos},   NamedFunction{"tan", Op::tan},
    NamedFunction{"asin", Op::asin}, NamedFunction{"acos", Op::acos}, NamedFunction{"atan2", Op::atan2},
    NamedFunction{"exp", Op::exp},   NamedFunction{"log", Op::log},   NamedFunction{"tanh", Op::tanh},
    NamedFunction{"abs", Op::abs},   NamedFunction{"csgn", Op::sign},
};

bool is_integer(const GiNaC::ex& e) { return e.info(GiNaC::info_flags::integer); }

}  // namespace

GiNaC::ex GinacConverter::symbol(NodeId id) {
  const auto [found, is_new] = symbols_.try_emplace(id);
  if (is_new) nodes_.emplace(found->second, id);
  return found->second;
}

std::pair<GiNaC::ex, GiNaC::ex> GinacConverter::turn(const GiNaC::ex& angle) {
  const GiNaC::ex e = angle.expand();
  if (e.is_zero()) return {1, 0};
  const auto composed = [](const std::pair<GiNaC::ex, GiNaC::ex>& x,
                           const std::pair<GiNaC::ex, GiNaC::ex>& y) {
    return std::pair<GiNaC::ex, GiNaC::ex>{(x.first * y.first - x.second * y.second).expand(),
                                           (x.second * y.first + x.first * y.second).expand()};
  };
  if (GiNaC::is_a<GiNaC::add>(e)) {
    std::pair<GiNaC::ex, GiNaC::ex> result{1, 0};
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
      const auto once = turn(e / factor.numer());
      const long multiple = factor.numer().to_long();
      std::pair<GiNaC::ex, GiNaC::ex> result{1, 0};
      for (long i = 0; i < std::labs(multiple); ++i) result = composed(result, once);
      return {result.first, multiple < 0 ? -result.second : result.second};
    }
  }
  const auto [found, is_new] = circle_of_.try_emplace(e, circles_.size());
  if (is_new) {
    const NodeId argument = to_tape(e);
    circles_.emplace_back();
    nodes_.emplace(circles_.back().cosine, tape_->apply(Op::cos, argument));
    nodes_.emplace(circles_.back().sine, tape_->apply(Op::sin, argument));
  }
  const Circle& circle = circles_[found->second];
  return {circle.cosine, circle.sine};
}

GiNaC::ex GinacConverter::to_ginac(NodeId root) {
  std::map<NodeId, GiNaC::ex> known;
  for (const NodeId id : tape_->reachable({root})) {
    const Node n = tape_->node(id);
    const int arity = info(n.op).arity;
    if (n.op == Op::input) {
      known[id] = symbol(id);
    } else if (n.op == Op::constant) {
      const bool exact = tape_->value(id).is_rational();
      known[id] = exact ? FromExact<GiNaC::ex>()(tape_->value(id)) : symbol(id);
    } else if (angles_ == Angles::symbols && (n.op == Op::cos || n.op == Op::sin || n.op == Op::tan)) {
      const auto [c, s] = turn(known[n.a]);
      known[id] = n.op == Op::cos ? c : n.op == Op::sin ? s : s / c;
    } else {
      known[id] = apply<GiNaC::ex>(n.op, known[n.a], known[arity == 2 ? n.b : n.a]);
    }
  }
  return known[root];
}

GiNaC::ex GinacConverter::without_functions(const GiNaC::ex& e) {
  struct Replace : GiNaC::map_function {
    GinacConverter* self;
    GiNaC::ex operator()(const GiNaC::ex& x) override {
      if (GiNaC::is_a<GiNaC::function>(x) && x.nops() == 1) {
        const std::string name = GiNaC::ex_to<GiNaC::function>(x).get_name();
        if (name == "sin") return self->turn((*this)(x.op(0))).second;
        if (name == "cos") return self->turn((*this)(x.op(0))).first;
        if (name == "tan") {
          const auto [c, s] = self->turn((*this)(x.op(0)));
          return s / c;
        }
      }
      return x.map(*this);
    }
  };
  Replace replace;
  replace.self = this;
  return replace(e);
}

GiNaC::ex GinacConverter::residual(const GiNaC::ex& e) {
  GiNaC::ex result = without_functions(e).normal().numer().expand();
  for (const Circle& circle : circles_) {
    const int degree = result.degree(circle.sine);
    if (degree < 2) continue;
    GiNaC::ex reduced = 0;
    for (int i = 0; i <= degree; ++i) {
      reduced += result.coeff(circle.sine, i) * GiNaC::pow(circle.sine, i % 2) *
                 GiNaC::pow(1 - GiNaC::pow(circle.cosine, 2), i / 2);
    }
    result = reduced.expand();
  }
  return result;
}

NodeId GinacConverter::power(NodeId base, unsigned long exponent) {
  if (exponent == 0) return tape_->constant(1);
  if (exponent == 1) return base;
  const NodeId half = power(base, exponent / 2);
  const NodeId square = tape_->apply(Op::mul, half, half);
  return exponent % 2 == 0 ? square : tape_->apply(Op::mul, square, base);
}

NodeId GinacConverter::with_sign(const Canonical& c) {
  return c.negative ? tape_->apply(Op::neg, c.magnitude) : c.magnitude;
}

GinacConverter::Canonical GinacConverter::canonical_sum(const GiNaC::ex& e) {
  std::vector<Canonical> terms;
  for (std::size_t i = 0; i < e.nops(); ++i) terms.push_back(canonical(e.op(i)));
  std::ranges::sort(terms, {}, &Canonical::key);
  const bool negative = terms.front().negative;
  Canonical result{negative, terms.front().magnitude, "(+ " + terms.front().key};
  for (std::size_t i = 1; i < terms.size(); ++i) {
    const bool minus = terms[i].negative != negative;
    result.magnitude = tape_->apply(minus ? Op::sub : Op::add, result.magnitude, terms[i].magnitude);
    result.key += (minus ? " -" : " ") + terms[i].key;
  }
  result.key += ")";
  return result;
}

GinacConverter::Canonical GinacConverter::canonical_product(const GiNaC::ex& e) {
  Canonical result{false, 0, "(*"};
  std::vector<Canonical> above;
  std::vector<Canonical> below;
  for (std::size_t i = 0; i < e.nops(); ++i) {
    const GiNaC::ex factor = e.op(i);
    const bool inverse = GiNaC::is_a<GiNaC::power>(factor) && factor.op(1).info(GiNaC::info_flags::negative);
    Canonical c = canonical(inverse ? GiNaC::pow(factor.op(0), -factor.op(1)) : factor);
    result.negative = result.negative != c.negative;
    if (!tape_->is_one(c.magnitude)) (inverse ? below : above).push_back(std::move(c));
  }
  if (above.size() == 1 && below.empty()) {  // -x sorts like x
    above.front().negative = result.negative;
    return above.front();
  }
  const auto multiplied = [&](std::vector<Canonical>& factors) {
    std::ranges::sort(factors, {}, &Canonical::key);
    NodeId product = tape_->constant(1);
    for (const Canonical& c : factors) {
      product = tape_->apply(Op::mul, product, c.magnitude);
      result.key += " " + c.key;
    }
    return product;
  };
  const NodeId numerator = multiplied(above);
  result.key += " /";
  const NodeId denominator = multiplied(below);
  result.key += ")";
  result.magnitude = tape_->apply(Op::div, numerator, denominator);
  return result;
}

GinacConverter::Canonical GinacConverter::canonical_power(const GiNaC::ex& e) {
  const GiNaC::ex exponent = e.op(1);
  const Canonical base = canonical(e.op(0));
  if (!GiNaC::is_a<GiNaC::numeric>(exponent) || !is_integer(2 * exponent)) {  // x^y = exp(y log x)
    const Canonical y = canonical(exponent);
    const NodeId log = tape_->apply(Op::log, with_sign(base));
    const std::string key =
        fmt::format("(^ {}{} {}{})", base.negative ? "-" : "", base.key, y.negative ? "-" : "", y.key);
    return {false, tape_->apply(Op::exp, tape_->apply(Op::mul, with_sign(y), log)), key};
  }
  if (exponent.info(GiNaC::info_flags::negative)) {
    const Canonical inverse = canonical(GiNaC::pow(e.op(0), -exponent));
    return {inverse.negative, tape_->apply(Op::div, tape_->constant(1), inverse.magnitude),
            "(/ " + inverse.key + ")"};
  }
  const auto n = static_cast<unsigned long>(GiNaC::ex_to<GiNaC::numeric>(2 * exponent).to_long());
  if (n % 2 == 0)
    return {base.negative && n % 4 != 0, power(base.magnitude, n / 2),
            fmt::format("(^ {} {})", base.key, n / 2)};
  const NodeId root = tape_->apply(Op::sqrt, with_sign(base));
  return {false, power(root, n), fmt::format("(sqrt^ {}{} {})", base.negative ? "-" : "", base.key, n)};
}

GinacConverter::Canonical GinacConverter::canonical_function(const GiNaC::ex& e) {
  const std::string name = GiNaC::ex_to<GiNaC::function>(e).get_name();
  const auto entry = std::ranges::find_if(named_functions, [&](const auto& f) { return name == f.ginac; });
  if (entry == named_functions.end()) throw std::invalid_argument("the tape has no function " + name);
  const Canonical a = canonical(e.op(0));
  if (info(entry->op).arity == 2) {
    const Canonical b = canonical(e.op(1));
    const std::string key =
        fmt::format("({} {}{} {}{})", name, a.negative ? "-" : "", a.key, b.negative ? "-" : "", b.key);
    return {false, tape_->apply(entry->op, with_sign(a), with_sign(b)), key};
  }
  const bool odd = entry->op == Op::sin || entry->op == Op::tan || entry->op == Op::asin ||
                   entry->op == Op::tanh || entry->op == Op::sign;
  const bool even = entry->op == Op::cos || entry->op == Op::abs;
  const bool keeps_sign = a.negative && !odd && !even;
  return {a.negative && odd, tape_->apply(entry->op, keeps_sign ? with_sign(a) : a.magnitude),
          fmt::format("({} {}{})", name, keeps_sign ? "-" : "", a.key)};
}

GinacConverter::Canonical GinacConverter::canonical(const GiNaC::ex& e) {
  if (GiNaC::is_a<GiNaC::numeric>(e)) {
    const auto& number = GiNaC::ex_to<GiNaC::numeric>(e);
    if (!number.is_real()) throw std::invalid_argument("the tape has no complex numbers");
    const Exact value(cln::the<cln::cl_R>(number.to_cl_N()));
    const bool negative = value < Exact(0);
    const Exact magnitude = negative ? -value : value;
    return {negative, tape_->constant(magnitude), "#" + magnitude.key()};
  }
  if (GiNaC::is_a<GiNaC::symbol>(e)) {
    const auto found = nodes_.find(e);
    if (found == nodes_.end()) throw std::invalid_argument("a symbol that the tape does not know");
    const Node& n = tape_->node(found->second);
    const StructuralKey key = tape_->key(found->second);
    const std::string text =
        n.op == Op::input ? fmt::format("{:08}", n.a) : fmt::format("{:016x}{:016x}", key.high, key.low);
    return {false, found->second, text};
  }
  if (GiNaC::is_a<GiNaC::add>(e)) return canonical_sum(e);
  if (GiNaC::is_a<GiNaC::mul>(e)) return canonical_product(e);
  if (GiNaC::is_a<GiNaC::power>(e)) return canonical_power(e);
  if (GiNaC::is_a<GiNaC::function>(e)) return canonical_function(e);
  if (e.is_equal(GiNaC::Pi)) return {false, tape_->constant(Exact::pi()), "pi"};
  throw std::invalid_argument("an expression that the tape cannot hold");
}

NodeId GinacConverter::to_tape(const GiNaC::ex& e) { return with_sign(canonical(e)); }

}  // namespace anholon
