// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The straight-line program: a hash-consed list of nodes in which every operand precedes its user. Algebraic
// folding happens while a node is made and looks at the operands' structure alone, so the program does not
// depend on the order in which a compiler evaluates the operands of a C++ expression.

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "number/exact.hpp"
#include "tape/op_table.hpp"

namespace anholon {

using NodeId = std::uint32_t;

struct Node {
  Op op;
  std::uint32_t a;  // operand; index into the constant pool or the list of inputs for a leaf
  std::uint32_t b;  // second operand of a binary operation, else 0
};

/// Key of a node's structure: equal on every run, machine and compiler for the same expression over the same
/// inputs.
struct StructuralKey {
  std::uint64_t high = 0;
  std::uint64_t low = 0;
  friend auto operator<=>(const StructuralKey&, const StructuralKey&) = default;
};

class Tape {
 public:
  Tape();

  /// A new input; names are unique by the caller's care and only serve to print.
  NodeId input(std::string name);
  NodeId constant(const Exact& value);
  /// Node of an operation, folded: 0 and 1, exact constants, signs, x + x, (a - b) + b, sin^2 + cos^2, ...
  NodeId apply(Op op, NodeId a, NodeId b = 0);

  /// Nodes made from now on belong to a new section with this title, which becomes a comment of emitted code.
  void section(std::string title);

  [[nodiscard]] const Node& node(NodeId id) const { return nodes_[id]; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] std::uint32_t section_of(NodeId id) const { return section_of_[id]; }
  [[nodiscard]] const std::vector<std::string>& sections() const { return sections_; }
  [[nodiscard]] const StructuralKey& key(NodeId id) const { return keys_[id]; }
  [[nodiscard]] const std::vector<std::string>& inputs() const { return inputs_; }
  [[nodiscard]] NodeId input_node(std::size_t index) const { return input_nodes_[index]; }
  [[nodiscard]] bool is_constant(NodeId id) const { return nodes_[id].op == Op::constant; }
  /// Value of a constant node.
  [[nodiscard]] const Exact& value(NodeId id) const { return constants_[nodes_[id].a]; }
  [[nodiscard]] bool is_zero(NodeId id) const { return id == zero_; }
  [[nodiscard]] bool is_one(NodeId id) const { return id == one_; }

  /// All nodes that the roots need, in order of creation.
  [[nodiscard]] std::vector<NodeId> reachable(const std::vector<NodeId>& roots) const;

 private:
  NodeId intern(Op op, NodeId a, NodeId b);
  NodeId push(Node node, StructuralKey key);
  NodeId add(NodeId a, NodeId b);
  NodeId sub(NodeId a, NodeId b);
  NodeId mul(NodeId a, NodeId b);
  NodeId div(NodeId a, NodeId b);
  NodeId neg(NodeId a);
  [[nodiscard]] bool is(NodeId id, Op op) const { return nodes_[id].op == op; }
  /// Splits c * x into (c, x); x alone has c = 1.
  [[nodiscard]] std::pair<Exact, NodeId> scaled(NodeId id) const;

  struct NodeHash {
    std::size_t operator()(const Node& n) const noexcept {
      return (static_cast<std::size_t>(n.op) * 0x9E3779B97F4A7C15ULL) ^
             (static_cast<std::size_t>(n.a) * 0xC2B2AE3D27D4EB4FULL) ^
             (static_cast<std::size_t>(n.b) * 0x165667B19E3779F9ULL);
    }
  };
  struct NodeEqual {
    bool operator()(const Node& x, const Node& y) const noexcept {
      return x.op == y.op && x.a == y.a && x.b == y.b;
    }
  };

  std::vector<Node> nodes_;
  std::vector<StructuralKey> keys_;
  std::vector<std::uint32_t> section_of_;
  std::vector<std::string> sections_;
  std::vector<std::string> inputs_;
  std::vector<NodeId> input_nodes_;
  std::vector<Exact> constants_;
  std::unordered_map<std::string, NodeId> constant_index_;
  std::unordered_map<Node, NodeId, NodeHash, NodeEqual> index_;
  NodeId zero_ = 0;
  NodeId one_ = 0;
};

}  // namespace anholon
