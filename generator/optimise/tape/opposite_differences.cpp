// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/opposite_differences.hpp"

#include <set>
#include <utility>

#include "optimise/tape/count.hpp"
#include "optimise/tape/dead_code.hpp"
#include "optimise/tape/rebuild.hpp"

namespace anholon {

std::vector<NodeId> merge_opposite_differences(Tape& tape, std::vector<NodeId> roots) {
  for (int round = 0; round < 16; ++round) {  // a merged pair may make its users opposite
    std::set<std::pair<NodeId, NodeId>> differences;
    for (const NodeId id : needed_nodes(tape, roots)) {
      const Node& n = tape.node(id);
      if (n.op == Op::sub) differences.insert({n.a, n.b});
    }
    bool found = false;
    const std::vector<NodeId> next = rebuild(tape, roots, [&](NodeId old, const std::vector<NodeId>& image) {
      const Node n = tape.node(old);
      if (n.op != Op::sub || tape.key(n.a) < tape.key(n.b) || !differences.contains({n.b, n.a})) return copied(tape, old, image);
      found = true;
      return tape.apply(Op::neg, tape.apply(Op::sub, image[n.b], image[n.a]));
    });
    if (!found || count_operations(tape, next).total() > count_operations(tape, roots).total()) break;
    roots = next;
  }
  return roots;
}

}  // namespace anholon
