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
    default:
      return 0;
  }
}

/// Half of what the squares of sine and cosine lack of 1: either lacks that part of itself, to first order
/// and along the radius. Their sum would be folded to 1.
Expr missing_to_circle(const Expr& sine, const Expr& cosine) {
  const Expr s2 = sine * sine, c2 = cosine * cosine;
  const Expr missing = (Expr(1) - s2) - c2 + sum_error(Expr(1), -s2) - product_error(sine, sine) -
                       product_error(cosine, cosine);
  return missing / Expr(2);
}

}  // namespace

bool is_beyond(Op op, double share, double tolerated) {
  return share > (op == Op::sin || op == Op::cos ? 3 : 1) * tolerated;
}

std::unordered_map<NodeId, NodeId> partners_on_circle(const Tape& tape, const std::vector<NodeId>& nodes) {
  std::unordered_map<NodeId, NodeId> sine_of, partners;
  for (const NodeId id : nodes) {
    if (tape.node(id).op == Op::sin) sine_of.emplace(tape.node(id).a, id);
  }
  for (const NodeId id : nodes) {
    if (tape.node(id).op != Op::cos) continue;
    const auto sine = sine_of.find(tape.node(id).a);
    if (sine == sine_of.end()) continue;
    partners.emplace(id, sine->second);
    partners.emplace(sine->second, id);
  }
  return partners;
}

bool has_known_error(Op op) {
  return op == Op::constant || op == Op::add || op == Op::sub || op == Op::mul || op == Op::div;
}

std::optional<std::vector<NodeId>> compensated(Tape& tape, const std::vector<NodeId>& roots,
                                               const std::vector<double>& shares, double tolerated) {
  std::unordered_map<NodeId, Pair> pairs;
  bool is_compensated = false;
  const std::vector<NodeId> nodes = tape.reachable(roots);
  const std::unordered_map<NodeId, NodeId> partners = partners_on_circle(tape, nodes);
  for (const NodeId id : nodes) {
    const Node n = tape.node(id);
    const bool is_kept = is_beyond(n.op, shares[id], tolerated) && keeps_rest(n.op);
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
    if (is_kept && partners.contains(id)) rest += y * missing_to_circle(sin(a.rounded), cos(a.rounded));
    is_compensated = is_compensated || !rest.is_zero();
    pairs.emplace(id, is_kept ? Pair{y, rest} : Pair{y + rest, 0});
  }
  if (!is_compensated) return std::nullopt;
  std::vector<NodeId> result;
  for (const NodeId root : roots) result.push_back((pairs.at(root).rounded + pairs.at(root).rest).id(tape));
  return result;
}

}  // namespace anholon
