// SPDX-License-Identifier: GPL-2.0-or-later
#include "tape/derivative.hpp"

#include <unordered_map>

namespace anholon {
std::vector<NodeId> directional_derivative(Tape& tape, const std::vector<NodeId>& roots,
                                           const std::vector<std::pair<NodeId, NodeId>>& direction) {
  std::unordered_map<NodeId, NodeId> tangents;  // nonzero ones only
  for (const auto& [input, seed] : direction) {
    if (!tape.is_zero(seed)) tangents[input] = seed;
  }
  for (const NodeId id : tape.reachable(roots)) {
    const Node n = tape.node(id);
    const int arity = info(n.op).arity;
    if (arity == 0) continue;
    const auto of = [&](NodeId x) {
      const auto found = tangents.find(x);
      return found == tangents.end() ? Expr(0) : Expr(tape, found->second);
    };
    const Expr da = of(n.a);
    const Expr db = arity == 2 ? of(n.b) : Expr(0);
    if (da.is_zero() && db.is_zero()) continue;
    const Expr a(tape, n.a);
    const Expr b = arity == 2 ? Expr(tape, n.b) : Expr(0);
    const Expr dy = tangent(n.op, Expr(tape, id), a, b, da, db);
    if (!dy.is_zero()) tangents[id] = dy.id(tape);
  }
  std::vector<NodeId> result;
  result.reserve(roots.size());
  for (const NodeId root : roots) {
    const auto found = tangents.find(root);
    result.push_back(found == tangents.end() ? tape.constant(0) : found->second);
  }
  return result;
}

NodeId derivative(Tape& tape, NodeId root, NodeId x) {
  return directional_derivative(tape, {root}, {{x, tape.constant(1)}}).front();
}

}  // namespace anholon
