// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/common_sums.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <unordered_map>

#include "optimise/tape/count.hpp"
#include "optimise/tape/dead_code.hpp"
#include "optimise/tape/rebuild.hpp"

namespace anholon {
namespace {

struct Term {
  NodeId node;  // a node, or the number of a shared pair behind all nodes
  bool negative;
};

/// Two terms of a sum up to the sign of both.
struct Pair {
  NodeId x, y;
  bool opposite;
  friend auto operator<=>(const Pair&, const Pair&) = default;
};

/// The pair that most sums have comes first; of equals, the first by structure.
using Rank = std::tuple<int, StructuralKey, StructuralKey, Pair>;

/// The sums of three terms or more whose inner nodes nothing else uses, and the pairs that they share.
class SharedSums {
 public:
  SharedSums(Tape& tape, const std::vector<NodeId>& roots)
      : tape_(tape), inner_(tape.size(), 0), first_pair_(static_cast<NodeId>(tape.size())) {
    const std::vector<NodeId> needed = needed_nodes(tape, roots);
    std::vector<int> uses(tape.size(), 0);
    for (const NodeId id : needed) {
      const Node& n = tape.node(id);
      if (info(n.op).arity >= 1) ++uses[n.a];
      if (info(n.op).arity == 2) ++uses[n.b];
    }
    for (const NodeId root : roots) uses[root] += 2;
    for (const NodeId id : needed) {
      const Node& n = tape.node(id);
      if (!is_sum(id)) continue;
      for (const NodeId x : {n.a, n.b}) {
        if (is_sum(x) && uses[x] == 1) inner_[x] = 1;
      }
    }
    for (const NodeId id : needed) {
      if (!is_sum(id) || inner_[id] != 0) continue;
      std::vector<Term> terms;
      flatten(id, false, terms);
      if (terms.size() > most_terms) continue;
      sums_[id] = std::move(terms);
    }
    find_pairs();
  }

  [[nodiscard]] bool found() const { return !pairs_.empty(); }

  NodeId operator()(NodeId old, const std::vector<NodeId>& image) {
    const auto sum = sums_.find(old);
    if (sum == sums_.end() || !changed_.contains(old)) return copied(tape_, old, image);
    std::vector<Term> terms;
    for (const Term& t : sum->second) terms.push_back({value(t.node, image), t.negative});
    std::ranges::stable_sort(terms, {}, [](const Term& t) { return t.negative; });
    NodeId total = terms[0].negative ? tape_.apply(Op::neg, terms[0].node) : terms[0].node;
    for (std::size_t i = 1; i < terms.size(); ++i)
      total = tape_.apply(terms[i].negative ? Op::sub : Op::add, total, terms[i].node);
    return total;
  }

 private:
  static constexpr std::size_t most_terms = 24;

  [[nodiscard]] bool is_sum(NodeId id) const {
    return tape_.node(id).op == Op::add || tape_.node(id).op == Op::sub;
  }
  [[nodiscard]] StructuralKey key(NodeId id) const {
    return id < first_pair_ ? tape_.key(id) : StructuralKey{~0ULL, id};
  }

  void flatten(NodeId id, bool negative, std::vector<Term>& terms) const {
    const Node n = tape_.node(id);
    for (const auto& [x, sign] : {std::pair{n.a, negative}, std::pair{n.b, negative != (n.op == Op::sub)}}) {
      if (inner_[x] != 0) {
        flatten(x, sign, terms);
      } else {
        terms.push_back({x, sign});
      }
    }
  }

  [[nodiscard]] Pair pair_of(const Term& a, const Term& b) const {
    const bool ordered = key(a.node) < key(b.node);
    return {ordered ? a.node : b.node, ordered ? b.node : a.node, a.negative != b.negative};
  }

  [[nodiscard]] std::pair<std::size_t, std::size_t> occurrence(const std::vector<Term>& terms,
                                                               const Pair& pair) const {
    for (std::size_t i = 0; i < terms.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (terms[i].node != terms[j].node && pair_of(terms[i], terms[j]) == pair) return {i, j};
      }
    }
    throw std::logic_error("a pair is not in its sum");
  }

  /// Takes the pair that most sums have, puts a new term in its place, and goes on while a pair stands in two
  /// sums.
  void find_pairs() {
    std::map<Pair, std::set<NodeId>> where;
    std::set<Rank> ranks;  // of the pairs that two sums have
    const auto rank = [&](const Pair& p, std::size_t users) {
      return Rank{-static_cast<int>(users), key(p.x), key(p.y), p};
    };
    const auto enter = [&](NodeId sum, bool add) {
      const std::vector<Term>& terms = sums_[sum];
      std::set<Pair> pairs;
      for (std::size_t i = 0; i < terms.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          if (terms[i].node != terms[j].node) pairs.insert(pair_of(terms[i], terms[j]));
        }
      }
      for (const Pair& p : pairs) {
        std::set<NodeId>& users = where[p];
        if (users.size() > 1) ranks.erase(rank(p, users.size()));
        if (add) {
          users.insert(sum);
        } else {
          users.erase(sum);
        }
        if (users.size() > 1) ranks.insert(rank(p, users.size()));
        if (users.empty()) where.erase(p);
      }
    };
    for (const auto& [sum, terms] : sums_) enter(sum, true);
    while (!ranks.empty()) {
      const Pair pair = std::get<Pair>(*ranks.begin());
      const std::set<NodeId> users = where[pair];
      const auto term = static_cast<NodeId>(first_pair_ + pairs_.size());
      pairs_.push_back(pair);
      for (const NodeId sum : users) {
        enter(sum, false);
        std::vector<Term>& terms = sums_[sum];
        const auto [i, j] = occurrence(terms, pair);  // a node may stand in a sum twice, with either sign
        const bool negative = terms[i].node == pair.x ? terms[i].negative : terms[j].negative;
        terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(std::max(i, j)));
        terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(std::min(i, j)));
        terms.push_back({term, negative});
        changed_.insert(sum);
        enter(sum, true);
      }
    }
  }

  /// Image of a term; a pair is made when it is first used.
  NodeId value(NodeId term, const std::vector<NodeId>& image) {
    if (term < first_pair_) return image[term];
    const Pair& p = pairs_[term - first_pair_];
    return tape_.apply(p.opposite ? Op::sub : Op::add, value(p.x, image), value(p.y, image));
  }

  Tape& tape_;
  std::vector<char> inner_;
  NodeId first_pair_;
  std::map<NodeId, std::vector<Term>> sums_;
  std::vector<Pair> pairs_;
  std::set<NodeId> changed_;
};

}  // namespace

std::vector<NodeId> share_common_sums(Tape& tape, std::vector<NodeId> roots) {
  for (int round = 0; round < 4; ++round) {
    SharedSums pass(tape, roots);
    if (!pass.found()) break;
    const std::vector<NodeId> next =
        rebuild(tape, roots, [&](NodeId old, const std::vector<NodeId>& image) { return pass(old, image); });
    if (count_operations(tape, next).total() >= count_operations(tape, roots).total()) break;
    roots = next;
  }
  return roots;
}

}  // namespace anholon
