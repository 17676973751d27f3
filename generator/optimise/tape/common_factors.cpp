// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/common_factors.hpp"

#include <algorithm>
#include <map>

#include "optimise/tape/count.hpp"
#include "optimise/tape/dead_code.hpp"
#include "optimise/tape/rebuild.hpp"

namespace anholon {
namespace {

struct Summand {
  NodeId node;
  bool negative;
};

class FactorPass {
 public:
  FactorPass(Tape& tape, const std::vector<NodeId>& roots)
      : tape_(tape), uses_(tape.size(), 0), inner_(tape.size(), 0) {
    const std::vector<NodeId> needed = needed_nodes(tape, roots);
    for (const NodeId id : needed) {
      const Node& n = tape.node(id);
      if (info(n.op).arity >= 1) ++uses_[n.a];
      if (info(n.op).arity == 2) ++uses_[n.b];
    }
    for (const NodeId root : roots) uses_[root] += 2;  // an output stays a node of its own
    for (const NodeId id : needed) {
      const Node& n = tape.node(id);
      if (!is_sum(id)) continue;
      for (const NodeId x : {n.a, n.b}) {
        if (is_sum(x) && uses_[x] == 1) inner_[x] = 1;
      }
    }
  }

  NodeId operator()(NodeId old, const std::vector<NodeId>& image) {
    if (!is_sum(old) || inner_[old] != 0) return copied(tape_, old, image);
    std::vector<Summand> terms;
    flatten(old, false, terms);
    std::vector<std::vector<Summand>> groups;  // each with the factor in front
    std::vector<NodeId> factors;
    while (true) {
      const auto [factor, members] = best_factor(terms);
      if (members.size() < 2) break;
      factors.push_back(factor);
      groups.push_back(members);
      std::erase_if(terms, [&members = members](const Summand& t) {
        return std::ranges::any_of(members, [&](const Summand& m) { return m.node == t.node; });
      });
    }
    if (groups.empty()) return copied(tape_, old, image);
    std::vector<Summand> sum;
    for (const Summand& t : terms) sum.push_back({image[t.node], t.negative});
    for (std::size_t g = 0; g < groups.size(); ++g) {
      std::vector<Summand> cofactors;
      for (const Summand& t : groups[g]) {
        const Node n = tape_.node(t.node);
        cofactors.push_back({image[n.a == factors[g] ? n.b : n.a], t.negative});
      }
      sum.push_back({tape_.apply(Op::mul, image[factors[g]], added(cofactors)), false});
    }
    return added(sum);
  }

 private:
  [[nodiscard]] bool is_sum(NodeId id) const {
    return tape_.node(id).op == Op::add || tape_.node(id).op == Op::sub;
  }

  void flatten(NodeId id, bool negative, std::vector<Summand>& terms) const {
    const Node n = tape_.node(id);
    const auto descend = [&](NodeId x, bool sign) {
      if (inner_[x] != 0) {
        flatten(x, sign, terms);
      } else {
        terms.push_back({x, sign});
      }
    };
    descend(n.a, negative);
    descend(n.b, negative != (n.op == Op::sub));
  }

  /// The factor that most products share; of equals, the first by structure. Only products without another
  /// use count.
  [[nodiscard]] std::pair<NodeId, std::vector<Summand>> best_factor(const std::vector<Summand>& terms) const {
    std::map<StructuralKey, std::pair<NodeId, std::vector<Summand>>> by_factor;
    for (const Summand& t : terms) {
      const Node& n = tape_.node(t.node);
      if (n.op != Op::mul || uses_[t.node] != 1) continue;
      for (const NodeId f : {n.a, n.b}) {
        auto& [factor, members] = by_factor[tape_.key(f)];
        factor = f;
        if (members.empty() || members.back().node != t.node) members.push_back(t);
      }
    }
    std::pair<NodeId, std::vector<Summand>> best{0, {}};
    for (const auto& [key, entry] : by_factor) {
      if (entry.second.size() > best.second.size()) best = entry;
    }
    return best;
  }

  /// Sum of terms, positive ones first, as a balanced tree.
  NodeId added(std::vector<Summand> terms) {
    std::ranges::stable_sort(terms, {}, [](const Summand& t) { return t.negative; });
    while (terms.size() > 1) {
      std::vector<Summand> next;
      for (std::size_t i = 0; i + 1 < terms.size(); i += 2) {
        const Summand& x = terms[i];
        const Summand& y = terms[i + 1];
        next.push_back(
            {tape_.apply(x.negative == y.negative ? Op::add : Op::sub, x.node, y.node), x.negative});
      }
      if (terms.size() % 2 == 1) next.push_back(terms.back());
      terms = std::move(next);
    }
    return terms[0].negative ? tape_.apply(Op::neg, terms[0].node) : terms[0].node;
  }

  Tape& tape_;
  std::vector<int> uses_;
  std::vector<char> inner_;  // sums that only another sum uses
};

}  // namespace

std::vector<NodeId> extract_common_factors(Tape& tape, std::vector<NodeId> roots) {
  for (int round = 0; round < 8; ++round) {
    FactorPass pass(tape, roots);
    const std::vector<NodeId> next =
        rebuild(tape, roots, [&](NodeId old, const std::vector<NodeId>& image) { return pass(old, image); });
    if (count_operations(tape, next).total() >= count_operations(tape, roots).total()) break;
    roots = next;
  }
  return roots;
}

}  // namespace anholon
