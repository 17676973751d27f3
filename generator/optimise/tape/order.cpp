// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/order.hpp"

#include <algorithm>
#include <tuple>
#include <unordered_set>

#include "optimise/tape/dead_code.hpp"

namespace anholon {
namespace {

/// An argument such as 2 q + phi is computed in front of its sine; a longer one waits for its section.
constexpr int longest_argument = 4;

/// Operations beyond which nobody reads a function: it is ordered for the registers. Shorter ones gain too,
/// up to a tenth, where the caller asks for it.
constexpr std::size_t long_function = 1600;

class Ordering {
 public:
  Ordering(const Tape& tape, const std::vector<NodeId>& roots, const std::vector<NodeId>& given)
      : tape_(tape),
        needed_(needed_nodes(tape, roots, given)),
        done_(tape.size(), 0),
        given_(given.begin(), given.end()) {
    for (const NodeId id : needed_) {
      if (is_leaf(id)) done_[id] = 1;
    }
  }

  void emit_sincos() {
    std::vector<int> depth(tape_.size(),
                           0);  // of an argument made of + - * and neg; too deep for anything else
    std::vector<NodeId> calls;
    for (const NodeId id : needed_) {
      if (is_leaf(id)) continue;
      const Node& n = tape_.node(id);
      const CostClass cost = info(n.op).cost;
      const int below = std::max(depth[n.a], info(n.op).arity == 2 ? depth[n.b] : 0);
      const bool cheap =
          cost == CostClass::addition || cost == CostClass::multiplication || cost == CostClass::negation;
      depth[id] = cheap ? below + 1 : longest_argument + 1;
      if (cost == CostClass::trigonometric && below <= longest_argument) calls.push_back(id);
    }
    // inputs in their order, then longer arguments by structure; the sine before the cosine of each
    const auto rank = [&](NodeId call) {
      const NodeId x = tape_.node(call).a;
      const bool bare = tape_.node(x).op == Op::input;
      return std::tuple(depth[x], bare ? tape_.node(x).a : 0, tape_.key(x), tape_.node(call).op);
    };
    std::sort(calls.begin(), calls.end(), [&](NodeId x, NodeId y) { return rank(x) < rank(y); });
    for (const NodeId call : calls) visit(call);
  }

  void emit_section(const std::vector<NodeId>& members, NodeOrder order) {
    if (order == NodeOrder::levels) {
      emit_levels(members);
    } else {
      emit_depth_first(members);
    }
  }

  /// What the last output needs first: outputs of a tree are listed from the base to the tips, so that a limb
  /// is finished before the next one begins and its motion need not be kept for the way back. Of two operands
  /// the one with the longer path below it comes first, because the other may wait in fewer registers (Sethi
  /// and Ullman 1970).
  void emit_by_lifetimes(const std::vector<NodeId>& roots) {
    std::vector<int> path(tape_.size(), 0);
    for (const NodeId id : needed_) {
      if (done_[id] != 0) continue;
      const Node& n = tape_.node(id);
      path[id] = 1 + std::max(path[n.a], info(n.op).arity == 2 ? path[n.b] : 0);
    }
    for (auto root = roots.rbegin(); root != roots.rend(); ++root) visit(*root, &path);
  }

  /// Whether many operations are left.
  [[nodiscard]] bool is_long() const {
    const auto is_left = [this](NodeId id) { return done_[id] == 0; };
    return static_cast<std::size_t>(std::ranges::count_if(needed_, is_left)) > long_function;
  }

  /// The sections, each with the nodes that are needed and not emitted yet.
  std::vector<std::vector<NodeId>> rest_by_section() const {
    std::vector<std::vector<NodeId>> result(tape_.sections().size());
    for (const NodeId id : needed_) {
      if (done_[id] == 0) result[tape_.section_of(id)].push_back(id);
    }
    return result;
  }

  std::vector<NodeId> take() { return std::move(order_); }
  [[nodiscard]] std::size_t size() const { return order_.size(); }

 private:
  [[nodiscard]] bool is_leaf(NodeId id) const {
    return info(tape_.node(id).op).arity == 0 || given_.contains(id);
  }

  /// Emits a node after what it needs: the operand with the longer path first, else from left to right, where
  /// those of a commutative operation are sorted by structure already.
  void visit(NodeId id, const std::vector<int>* path = nullptr) {
    std::vector<NodeId> stack = {id};
    while (!stack.empty()) {
      const NodeId top = stack.back();
      if (done_[top] != 0) {
        stack.pop_back();
        continue;
      }
      const Node& n = tape_.node(top);
      const std::size_t before = stack.size();
      if (info(n.op).arity == 2 && done_[n.b] == 0) stack.push_back(n.b);
      if (done_[n.a] == 0) stack.push_back(n.a);  // on top: the first operand is computed first
      if (path != nullptr && stack.size() == before + 2 && (*path)[n.b] > (*path)[n.a])
        std::swap(stack[before], stack[before + 1]);
      if (stack.size() > before) continue;
      done_[top] = 1;
      order_.push_back(top);
      stack.pop_back();
    }
  }

  void emit_levels(const std::vector<NodeId>& members) {
    std::vector<std::tuple<int, StructuralKey, NodeId>> ranked;
    level_.resize(tape_.size(), 0);
    for (const NodeId id : members) {
      const Node& n = tape_.node(id);
      const auto level_of = [&](NodeId x) { return done_[x] != 0 ? 0 : level_[x]; };
      level_[id] = 1 + std::max(level_of(n.a), info(n.op).arity == 2 ? level_of(n.b) : 0);
      ranked.emplace_back(level_[id], tape_.key(id), id);
    }
    std::sort(ranked.begin(), ranked.end());
    for (const auto& [level, key, id] : ranked) {
      done_[id] = 1;
      order_.push_back(id);
    }
  }

  void emit_depth_first(const std::vector<NodeId>& members) {
    std::unordered_set<NodeId> used_inside;
    for (const NodeId id : members) {
      const Node& n = tape_.node(id);
      used_inside.insert(n.a);
      if (info(n.op).arity == 2) used_inside.insert(n.b);
    }
    std::vector<std::pair<StructuralKey, NodeId>> results;  // of the section: nothing in it uses them
    for (const NodeId id : members) {
      if (!used_inside.contains(id)) results.emplace_back(tape_.key(id), id);
    }
    std::sort(results.begin(), results.end());
    for (const auto& [key, id] : results) visit(id);
  }

  const Tape& tape_;
  std::vector<NodeId> needed_;
  std::vector<char> done_;  // emitted, or a leaf
  std::vector<int> level_;
  std::unordered_set<NodeId> given_;
  std::vector<NodeId> order_;
};

}  // namespace

EmissionOrder emission_order(const Tape& tape, const std::vector<NodeId>& roots,
                             const std::vector<NodeId>& given, NodeOrder order) {
  EmissionOrder result;
  Ordering ordering(tape, roots, given);
  ordering.emit_sincos();
  result.sincos = ordering.size();
  if (order == NodeOrder::by_length)
    order = ordering.is_long() ? NodeOrder::lifetimes : NodeOrder::depth_first;
  if (order == NodeOrder::lifetimes) {
    ordering.emit_by_lifetimes(roots);
  } else {
    for (const auto& members : ordering.rest_by_section()) ordering.emit_section(members, order);
  }
  result.nodes = ordering.take();
  return result;
}

}  // namespace anholon
