// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/opposite_differences.hpp"

#include "optimise/tape/count.hpp"
#include "optimise/tape/dead_code.hpp"

namespace anholon {
namespace {

/// A value as a node and a sign. The sign travels to the users until a sum, an output or a function takes it
/// up.
struct Signed {
  NodeId node = 0;
  bool negative = false;
};

class SignPass {
 public:
  explicit SignPass(Tape& tape) : tape_(tape) {}

  std::vector<NodeId> run(const std::vector<NodeId>& roots) {
    std::vector<Signed> image(tape_.size());
    for (const NodeId id : needed_nodes(tape_, roots)) image[id] = image_of(tape_.node(id), id, image);
    std::vector<NodeId> result;
    for (const NodeId root : roots) result.push_back(plain(image[root]));
    return result;
  }

 private:
  Signed image_of(const Node n, NodeId id, const std::vector<Signed>& image) {
    const int arity = info(n.op).arity;
    const auto is_unchanged = [&](NodeId x) { return image[x].node == x && !image[x].negative; };
    if (arity > 0 && is_unchanged(n.a) && (arity == 1 || is_unchanged(n.b)) && n.op != Op::neg &&
        !(n.op == Op::sub && tape_.key(n.b) < tape_.key(n.a)))
      return {id, false};
    switch (n.op) {
      case Op::input:
        return {id, false};
      case Op::constant:
        return positive(id);
      case Op::neg:
        return {image[n.a].node, !image[n.a].negative};
      case Op::add:
        return sum(image[n.a], image[n.b]);
      case Op::sub:
        return sum(image[n.a], {image[n.b].node, !image[n.b].negative});
      case Op::mul:
      case Op::div: {
        const Signed product = positive(tape_.apply(n.op, image[n.a].node, image[n.b].node));
        return {product.node, product.negative != (image[n.a].negative != image[n.b].negative)};
      }
      default:
        break;
    }
    const bool binary = info(n.op).arity == 2;
    return positive(tape_.apply(n.op, plain(image[n.a]), binary ? plain(image[n.b]) : 0));
  }

  /// Of x - y and y - x, the one whose first operand has the lesser structural key.
  Signed sum(const Signed& x, const Signed& y) {
    if (x.negative == y.negative) {
      const Signed s = positive(tape_.apply(Op::add, x.node, y.node));
      return {s.node, s.negative != x.negative};
    }
    const bool swap = tape_.key(y.node) < tape_.key(x.node);
    const Signed& first = swap ? y : x;
    const Signed& second = swap ? x : y;
    const Signed difference = positive(tape_.apply(Op::sub, first.node, second.node));
    return {difference.node, difference.negative != first.negative};
  }

  Signed positive(NodeId id) {
    if (tape_.node(id).op == Op::neg) return {tape_.node(id).a, true};
    if (tape_.is_constant(id) && tape_.value(id) < Exact(0)) return {tape_.constant(-tape_.value(id)), true};
    return {id, false};
  }
  NodeId plain(const Signed& x) { return x.negative ? tape_.apply(Op::neg, x.node) : x.node; }

  Tape& tape_;
};

}  // namespace

std::vector<NodeId> merge_opposite_differences(Tape& tape, const std::vector<NodeId>& roots) {
  const std::vector<NodeId> next = SignPass(tape).run(roots);
  return count_operations(tape, next).total() < count_operations(tape, roots).total() ? next : roots;
}

}  // namespace anholon
