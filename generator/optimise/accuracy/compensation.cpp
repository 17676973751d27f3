// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/compensation.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "tape/derivative.hpp"

namespace anholon {
namespace {

/// A value as the sum of two: what double holds, and what was rounded off.
struct Pair {
  Expr rounded, rest;
};

/// What the rest of an operation follows from to first order without a division by what may vanish.
bool keeps_rest(Op op) {
  switch (op) {
    case Op::constant:
    case Op::add:
    case Op::sub:
    case Op::mul:
    case Op::div:
    case Op::neg:
    case Op::sin:
    case Op::cos:
      return true;
    default:
      return false;
  }
}

bool is_power_of_two(const Expr& x) {
  const std::optional<Exact> value = x.constant_value();
  int exponent = 0;
  return value && std::abs(std::frexp(value->to_double(), &exponent)) == 0.5;
}

Expr rounding_error_of(Op op, const Expr& a, const Expr& b) {
  switch (op) {
    case Op::add:
      return sum_error(a, b);
    case Op::sub:
      return sum_error(a, -b);
    case Op::mul:
      return is_power_of_two(a) || is_power_of_two(b) ? Expr(0) : product_error(a, b);
    case Op::div:
      return quotient_error(a, b);
    default:  // of sines and cosines it is not known
      return 0;
  }
}

}  // namespace

bool has_known_error(Op op) {
  return op == Op::constant || op == Op::add || op == Op::sub || op == Op::mul || op == Op::div;
}

std::optional<std::vector<NodeId>> compensated(Tape& tape, const std::vector<NodeId>& roots,
                                               const std::vector<double>& shares, double tolerated) {
  std::unordered_map<NodeId, Pair> pairs;
  bool is_compensated = false;
  for (const NodeId id : tape.reachable(roots)) {
    const Node n = tape.node(id);
    const bool is_kept = shares[id] > tolerated && keeps_rest(n.op);
    if (info(n.op).arity == 0) {
      Pair value{Expr(tape, id), 0};
      if (is_kept && n.op == Op::constant) {
        const Exact exact = tape.value(id), rounded = Exact::from_double(exact.to_double());
        value = {Expr(tape, tape.constant(rounded)), Expr(tape, tape.constant(exact - rounded))};
      }
      pairs.emplace(id, value);
      continue;
    }
    Pair a = pairs.at(n.a), b = info(n.op).arity == 2 ? pairs.at(n.b) : Pair{0, 0};
    if (!keeps_rest(n.op)) a = {a.rounded + a.rest, 0}, b = {b.rounded + b.rest, 0};
    const Expr y(tape, tape.apply(n.op, a.rounded.id(tape), b.rounded.id(tape)));
    Expr rest = tangent(n.op, y, a.rounded, b.rounded, a.rest, b.rest);
    if (is_kept) rest += rounding_error_of(n.op, a.rounded, b.rounded);
    is_compensated = is_compensated || !rest.is_zero();
    pairs.emplace(id, is_kept ? Pair{y, rest} : Pair{y + rest, 0});
  }
  if (!is_compensated) return std::nullopt;
  std::vector<NodeId> result;
  for (const NodeId root : roots) result.push_back((pairs.at(root).rounded + pairs.at(root).rest).id(tape));
  return result;
}

}  // namespace anholon
