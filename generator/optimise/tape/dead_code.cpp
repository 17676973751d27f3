// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/dead_code.hpp"

#include <algorithm>

#include "tape/node_set.hpp"

namespace anholon {

std::vector<NodeId> needed_nodes(const Tape& tape, const std::vector<NodeId>& roots,
                                 const std::vector<NodeId>& given) {
  NodeId last = 0;
  for (const NodeId root : roots) last = std::max(last, root);
  NodeSet needed(last + std::size_t{1}), is_given(last + std::size_t{1});
  for (const NodeId root : roots) needed.insert(root);
  for (const NodeId id : given) {
    if (id <= last) is_given.insert(id);
  }
  needed.visit_backwards([&](NodeId id) {  // operands precede their users
    if (is_given.contains(id)) return;
    const Node& node = tape.node(id);
    const int arity = info(node.op).arity;
    if (arity >= 1) needed.insert(node.a);
    if (arity == 2) needed.insert(node.b);
  });
  return needed.members();
}

}  // namespace anholon
