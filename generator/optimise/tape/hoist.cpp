// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/hoist.hpp"

#include <algorithm>
#include <unordered_set>

#include "optimise/tape/order.hpp"

namespace anholon {
namespace {

enum class Depends : char { nothing, parameters, state };

}  // namespace

Hoisted hoist(const Tape& tape, const std::vector<NodeId>& roots, const std::vector<NodeId>& parameters) {
  const std::unordered_set<NodeId> is_parameter(parameters.begin(), parameters.end());
  std::vector<Depends> depends(tape.size(), Depends::nothing);
  std::vector<char> used(tape.size(), 0);  // by an operation on the state, or as an output
  for (const NodeId root : roots) used[root] = 1;
  const std::vector<NodeId> reachable = tape.reachable(roots);
  for (const NodeId id : reachable) {
    const Node& n = tape.node(id);
    if (n.op == Op::input) depends[id] = is_parameter.contains(id) ? Depends::parameters : Depends::state;
    const int arity = info(n.op).arity;
    if (arity >= 1) depends[id] = depends[n.a];
    if (arity == 2) depends[id] = std::max(depends[id], depends[n.b]);
    if (depends[id] != Depends::state) continue;
    if (arity >= 1) used[n.a] = 1;
    if (arity == 2) used[n.b] = 1;
  }
  Hoisted result;
  for (const NodeId id : parameters) {
    if (id < used.size() && used[id] != 0) result.parameters.push_back(id);
  }
  std::vector<NodeId> values;
  std::unordered_set<NodeId> is_value;
  for (const NodeId id : reachable) {
    if (used[id] == 0 || depends[id] != Depends::parameters || tape.node(id).op == Op::input) continue;
    values.push_back(id);
    is_value.insert(id);
  }
  std::ranges::sort(values, {}, [&](NodeId id) { return tape.key(id); });  // by structure, not by node id
  for (const NodeId id : emission_order(tape, values).nodes) {
    if (is_value.contains(id)) result.values.push_back(id);
  }
  return result;
}

OperationCount operations_per_call(const Tape& tape, const std::vector<NodeId>& roots,
                                   const std::vector<NodeId>& parameters) {
  std::vector<char> fixed(tape.size(), 0);
  for (const NodeId id : parameters) fixed[id] = 1;
  std::vector<NodeId> prepared;
  for (const NodeId id : tape.reachable(roots)) {
    const Node& n = tape.node(id);
    const int arity = info(n.op).arity;
    if (arity == 0) {
      if (n.op == Op::constant) fixed[id] = 1;
    } else if (fixed[n.a] != 0 && (arity == 1 || fixed[n.b] != 0)) {
      fixed[id] = 1;
      prepared.push_back(id);
    }
  }
  return count_operations(tape, roots, prepared);
}

}  // namespace anholon
