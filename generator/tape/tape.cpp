// SPDX-License-Identifier: GPL-2.0-or-later
#include "tape/tape.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tape/node_set.hpp"

namespace anholon {
namespace {

/// splitmix64, Steele, Lea and Flood 2014: spreads every input bit over the word.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

StructuralKey combined(std::uint64_t tag, const StructuralKey& a, const StructuralKey& b) {
  StructuralKey key;
  key.high = mixed(mixed(mixed(tag) ^ a.high) + 3 * mixed(b.high ^ 0x5851F42D4C957F2DULL));
  key.low = mixed(mixed(mixed(tag + 77) + a.low) ^ (5 * mixed(b.low + 0x14057B7EF767814FULL)));
  return key;
}

StructuralKey key_of_text(std::uint64_t tag, std::string_view text) {
  StructuralKey key{mixed(tag), mixed(tag + 1)};
  for (const char c : text) {
    key.high = mixed(key.high ^ static_cast<unsigned char>(c));
    key.low = mixed(key.low + static_cast<unsigned char>(c));
  }
  return key;
}

/// Irrational constants may make a simple number, as sqrt(2)/2 squared does: their rounding must not hide it.
/// @param size  of what x was made from
Exact without_rounding(const Exact& x, const Exact& size) {
  static const Exact rounding = Exact::from_decimal("1e-100");  // of 128 digits
  if (x.is_rational()) return x;
  if (abs(x) <= rounding * size) return 0;
  const double eighths = 8 * x.to_double();
  if (!(std::abs(eighths) < 1e6)) return x;
  const Exact near = Exact::ratio(std::lround(eighths), 8);
  return abs(x - near) <= rounding * abs(x) ? near : x;
}
Exact folded_sum(const Exact& a, const Exact& b) { return without_rounding(a + b, std::max(abs(a), abs(b))); }
Exact folded_product(const Exact& a, const Exact& b) {
  const Exact x = a * b;
  return without_rounding(x, abs(x));
}

}  // namespace

Tape::Tape() {
  sections_.emplace_back();
  zero_ = constant(0);
  one_ = constant(1);
}

void Tape::section(std::string title) { sections_.push_back(std::move(title)); }

NodeId Tape::push(Node node, StructuralKey key) {
  nodes_.push_back(node);
  keys_.push_back(key);
  section_of_.push_back(static_cast<std::uint32_t>(sections_.size() - 1));
  return static_cast<NodeId>(nodes_.size() - 1);
}

NodeId Tape::input(std::string name) {
  const auto index = static_cast<std::uint32_t>(inputs_.size());
  inputs_.push_back(std::move(name));
  const NodeId id = push({Op::input, index, 0}, combined(2, {index, index}, {}));
  input_nodes_.push_back(id);
  return id;
}

NodeId Tape::constant(const Exact& value) {
  std::string text = value.key();
  const auto [found, is_new] = constant_index_.try_emplace(text, 0);
  if (is_new) {
    constants_.push_back(value);
    found->second =
        push({Op::constant, static_cast<std::uint32_t>(constants_.size() - 1), 0}, key_of_text(1, text));
  }
  return found->second;
}

NodeId Tape::intern(Op op, NodeId a, NodeId b) {
  if ((op == Op::add || op == Op::mul) && keys_[b] < keys_[a]) std::swap(a, b);
  const Node node{op, a, b};
  const auto [found, is_new] = index_.try_emplace(node, 0);
  if (is_new) {
    const bool binary = info(op).arity == 2;
    found->second = push(
        node, combined(100 + static_cast<std::uint64_t>(op), keys_[a], binary ? keys_[b] : StructuralKey{}));
  }
  return found->second;
}

NodeId Tape::apply(Op op, NodeId a, NodeId b) {
  switch (op) {
    case Op::add:
      return add(a, b);
    case Op::sub:
      return sub(a, b);
    case Op::mul:
      return mul(a, b);
    case Op::div:
      return div(a, b);
    case Op::neg:
      return neg(a);
    case Op::constant:
    case Op::input:
      throw std::logic_error("a leaf is not made by apply");
    default:
      break;
  }
  if (is_constant(a) && (info(op).arity == 1 || is_constant(b))) {
    return constant(anholon::apply(op, value(a), info(op).arity == 2 ? value(b) : Exact()));
  }
  if (is(a, Op::neg) && info(op).arity == 1) {  // odd and even functions
    const NodeId positive = nodes_[a].a;
    if (op == Op::cos || op == Op::abs) return apply(op, positive);
    if (op == Op::sin || op == Op::tan || op == Op::asin || op == Op::tanh || op == Op::sign)
      return neg(apply(op, positive));
  }
  return intern(op, a, b);
}

std::pair<Exact, NodeId> Tape::scaled(NodeId id) const {
  if (is(id, Op::mul)) {
    if (is_constant(nodes_[id].a)) return {value(nodes_[id].a), nodes_[id].b};
    if (is_constant(nodes_[id].b)) return {value(nodes_[id].b), nodes_[id].a};
  }
  return {Exact(1), id};
}

NodeId Tape::neg(NodeId a) {
  if (is_constant(a)) return constant(-value(a));
  if (is(a, Op::neg)) return nodes_[a].a;
  if (is(a, Op::sub)) return sub(nodes_[a].b, nodes_[a].a);
  return intern(Op::neg, a, 0);
}

NodeId Tape::add(NodeId a, NodeId b) {
  if (is_zero(a)) return b;
  if (is_zero(b)) return a;
  if (is_constant(a) && is_constant(b)) return constant(folded_sum(value(a), value(b)));
  if (is(b, Op::neg)) return sub(a, nodes_[b].a);
  if (is(a, Op::neg)) return sub(b, nodes_[a].a);
  if (is(a, Op::sub) && nodes_[a].b == b) return nodes_[a].a;  // (x - b) + b
  if (is(b, Op::sub) && nodes_[b].b == a) return nodes_[b].a;
  if (!is_constant(a) && !is_constant(b)) {
    const auto [ca, xa] = scaled(a);
    const auto [cb, xb] = scaled(b);
    if (xa == xb) return mul(constant(folded_sum(ca, cb)), xa);
  }
  if (is(a, Op::mul) && is(b, Op::mul) && nodes_[a].a == nodes_[a].b && nodes_[b].a == nodes_[b].b) {
    const Node& x = nodes_[nodes_[a].a];
    const Node& y = nodes_[nodes_[b].a];
    const bool pythagoras = (x.op == Op::sin && y.op == Op::cos) || (x.op == Op::cos && y.op == Op::sin);
    if (pythagoras && x.a == y.a) return one_;
  }
  for (const auto& [c, sum] : {std::pair{a, b}, std::pair{b, a}}) {  // c + (d + x)
    if (!is_constant(c) || !is(sum, Op::add)) continue;
    const Node s = nodes_[sum];
    if (is_constant(s.a)) return add(constant(folded_sum(value(c), value(s.a))), s.b);
    if (is_constant(s.b)) return add(constant(folded_sum(value(c), value(s.b))), s.a);
  }
  return intern(Op::add, a, b);
}

NodeId Tape::sub(NodeId a, NodeId b) {
  if (a == b) return zero_;
  if (is_zero(b)) return a;
  if (is_zero(a)) return neg(b);
  if (is_constant(a) && is_constant(b)) return constant(folded_sum(value(a), -value(b)));
  if (is(b, Op::neg)) return add(a, nodes_[b].a);
  if (is(a, Op::neg)) return neg(add(nodes_[a].a, b));
  if (is(a, Op::add) && nodes_[a].a == b) return nodes_[a].b;  // (b + x) - b
  if (is(a, Op::add) && nodes_[a].b == b) return nodes_[a].a;
  if (is(a, Op::sub) && nodes_[a].a == b) return neg(nodes_[a].b);  // (b - x) - b
  if (is(b, Op::sub) && nodes_[b].a == a) return nodes_[b].b;       // a - (a - x)
  if (is(b, Op::add) && nodes_[b].a == a) return neg(nodes_[b].b);  // a - (a + x)
  if (is(b, Op::add) && nodes_[b].b == a) return neg(nodes_[b].a);
  if (!is_constant(a) && !is_constant(b)) {
    const auto [ca, xa] = scaled(a);
    const auto [cb, xb] = scaled(b);
    if (xa == xb) return mul(constant(folded_sum(ca, -cb)), xa);
  }
  return intern(Op::sub, a, b);
}

NodeId Tape::mul(NodeId a, NodeId b) {
  if (is_constant(b)) std::swap(a, b);
  if (is_constant(a)) {
    if (is_zero(a)) return zero_;
    if (is_one(a)) return b;
    if (is_constant(b)) return constant(folded_product(value(a), value(b)));
    if (value(a) < Exact(0)) return neg(mul(constant(-value(a)), b));
    if (is(b, Op::neg)) return neg(mul(a, nodes_[b].a));
    if (const auto [c, x] = scaled(b); x != b) return mul(constant(folded_product(value(a), c)), x);
    return intern(Op::mul, a, b);
  }
  if (is(a, Op::neg) && is(b, Op::neg)) return mul(nodes_[a].a, nodes_[b].a);
  if (is(a, Op::neg)) return neg(mul(nodes_[a].a, b));
  if (is(b, Op::neg)) return neg(mul(a, nodes_[b].a));
  if (a == b && is(a, Op::sqrt)) return nodes_[a].a;
  if (is(a, Op::div) && nodes_[a].b == b) return nodes_[a].a;  // (x / b) * b
  if (is(b, Op::div) && nodes_[b].b == a) return nodes_[b].a;
  return intern(Op::mul, a, b);
}

NodeId Tape::div(NodeId a, NodeId b) {
  if (is_zero(b)) throw std::domain_error("division by a constant zero");
  if (is_zero(a)) return zero_;
  if (a == b) return one_;
  if (is_constant(b)) return mul(constant(Exact(1) / value(b)), a);
  if (is(a, Op::neg) && is(b, Op::neg)) return div(nodes_[a].a, nodes_[b].a);
  if (is(a, Op::neg)) return neg(div(nodes_[a].a, b));
  if (is(b, Op::neg)) return neg(div(a, nodes_[b].a));
  if (is(a, Op::mul) && nodes_[a].a == b) return nodes_[a].b;
  if (is(a, Op::mul) && nodes_[a].b == b) return nodes_[a].a;
  return intern(Op::div, a, b);
}

std::vector<NodeId> Tape::reachable(const std::vector<NodeId>& roots) const {
  NodeSet needed(nodes_.size());
  for (const NodeId root : roots) needed.insert(root);
  needed.visit_backwards([&](NodeId id) {  // operands precede their users
    const Node& n = nodes_[id];
    const int arity = info(n.op).arity;
    if (arity >= 1) needed.insert(n.a);
    if (arity == 2) needed.insert(n.b);
  });
  return needed.members();
}

}  // namespace anholon
