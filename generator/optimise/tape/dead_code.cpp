// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/dead_code.hpp"

#include <algorithm>

namespace anholon {

std::vector<NodeId> needed_nodes(const Tape& tape, const std::vector<NodeId>& roots,
                                 const std::vector<NodeId>& given) {
  NodeId last = 0;
  for (const NodeId root : roots) last = std::max(last, root);
  std::vector<char> needed(last + std::size_t{1}, 0);
  std::vector<char> is_given(last + std::size_t{1}, 0);
  for (const NodeId root : roots) needed[root] = 1;
  for (const NodeId id : given) {
    if (id <= last) is_given[id] = 1;
  }
  if (roots.empty()) return {};
  for (std::size_t i = last + std::size_t{1}; i-- > 0;) {  // operands precede their users
    if (needed[i] == 0 || is_given[i] != 0) continue;
    const Node& node = tape.node(static_cast<NodeId>(i));
    const int arity = info(node.op).arity;
    if (arity >= 1) needed[node.a] = 1;
    if (arity == 2) needed[node.b] = 1;
  }
  std::vector<NodeId> result;
  for (std::size_t i = 0; i <= last; ++i) {
    if (needed[i] != 0) result.push_back(static_cast<NodeId>(i));
  }
  return result;
}

}  // namespace anholon
