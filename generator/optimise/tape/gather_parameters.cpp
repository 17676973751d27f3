// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/gather_parameters.hpp"

#include "optimise/tape/dead_code.hpp"
#include "optimise/tape/hoist.hpp"
#include "optimise/tape/rebuild.hpp"

namespace anholon {
namespace {

struct Operand {
  NodeId node;
  bool negative;  // of a product: never
};

class GatherPass {
 public:
  GatherPass(const Tape& tape, const std::vector<NodeId>& roots, const std::vector<NodeId>& parameters)
      : is_fixed_(tape.size(), 0), inner_(tape.size(), 0) {
    std::vector<int> uses(tape.size(), 0);
    for (const NodeId id : parameters) is_fixed_[id] = 1;
    const std::vector<NodeId> needed = needed_nodes(tape, roots);
    for (const NodeId id : needed) {
      const Node& n = tape.node(id);
      const int arity = info(n.op).arity;
      if (arity >= 1) ++uses[n.a];
      if (arity == 2) ++uses[n.b];
      if (tape.is_constant(id)) is_fixed_[id] = 1;
      if (arity >= 1) is_fixed_[id] = is_fixed_[n.a] != 0 && (arity == 1 || is_fixed_[n.b] != 0) ? 1 : 0;
    }
    for (const NodeId root : roots) uses[root] += 2;
    for (const NodeId id : needed) {
      const Node& n = tape.node(id);
      if (!is_chain(n.op)) continue;
      for (const NodeId x : {n.a, n.b}) {
        const Op op = tape.node(x).op;
        if (is_chain(op) && (op == Op::mul) == (n.op == Op::mul) && uses[x] == 1 && is_fixed_[x] == 0)
          inner_[x] = 1;
      }
    }
  }

  NodeId operator()(Tape& tape, NodeId old, const std::vector<NodeId>& image) const {
    const Op op = tape.node(old).op;
    if (!is_chain(op) || inner_[old] != 0 || is_fixed_[old] != 0) return copied(tape, old, image);
    std::vector<Operand> fixed, moving;
    flatten(tape, old, false, fixed, moving);
    if (fixed.size() < 2) return copied(tape, old, image);
    const auto combined = [&](const std::vector<Operand>& terms) {
      Operand total{image[terms[0].node], terms[0].negative};
      for (std::size_t i = 1; i < terms.size(); ++i) {
        const bool same = terms[i].negative == total.negative;
        total.node = tape.apply(op == Op::mul ? Op::mul
                                : same        ? Op::add
                                              : Op::sub,
                                total.node, image[terms[i].node]);
      }
      return total;
    };
    const Operand a = combined(moving);
    const Operand b = combined(fixed);
    if (op == Op::mul) return tape.apply(Op::mul, a.node, b.node);
    const NodeId sum = tape.apply(a.negative == b.negative ? Op::add : Op::sub, a.node, b.node);
    return a.negative ? tape.apply(Op::neg, sum) : sum;
  }

 private:
  static bool is_chain(Op op) { return op == Op::add || op == Op::sub || op == Op::mul; }

  void flatten(const Tape& tape, NodeId id, bool negative, std::vector<Operand>& fixed,
               std::vector<Operand>& moving) const {
    const Node& n = tape.node(id);
    for (const auto& [x, sign] : {Operand{n.a, negative}, Operand{n.b, negative != (n.op == Op::sub)}}) {
      if (inner_[x] != 0) {
        flatten(tape, x, sign, fixed, moving);
      } else {
        (is_fixed_[x] != 0 ? fixed : moving).push_back({x, sign});
      }
    }
  }

  std::vector<char> is_fixed_;  // depends on parameters alone
  std::vector<char> inner_;     // of a longer chain of the same kind, without another use
};

}  // namespace

std::vector<NodeId> gather_parameters(Tape& tape, const std::vector<NodeId>& roots,
                                      const std::vector<NodeId>& parameters) {
  const GatherPass pass(tape, roots, parameters);
  const std::vector<NodeId> next = rebuild(
      tape, roots, [&](NodeId old, const std::vector<NodeId>& image) { return pass(tape, old, image); });
  const auto cost = [&](const std::vector<NodeId>& r) {
    return operations_per_call(tape, r, parameters).total();
  };
  return cost(next) < cost(roots) ? next : roots;
}

}  // namespace anholon
