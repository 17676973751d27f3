// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/rebuild.hpp"

#include "optimise/tape/dead_code.hpp"

namespace anholon {

NodeId copied(Tape& tape, NodeId old, const std::vector<NodeId>& image) {
  const Node n = tape.node(old);
  const int arity = info(n.op).arity;
  if (arity == 0) return old;
  if (image[n.a] == n.a && (arity == 1 || image[n.b] == n.b)) return old;  // most nodes: no search for them
  return tape.apply(n.op, image[n.a], arity == 2 ? image[n.b] : 0);
}

std::vector<NodeId> rebuild(Tape& tape, const std::vector<NodeId>& roots, const Replacement& replace) {
  std::vector<NodeId> image(tape.size(), 0);
  for (const NodeId id : needed_nodes(tape, roots)) image[id] = replace(id, image);
  std::vector<NodeId> result;
  for (const NodeId root : roots) result.push_back(image[root]);
  return result;
}

}  // namespace anholon
