// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Runs a part of a tape over any scalar: double for numeric checks, Exact for the oracle, Expr to copy it
// onto another tape, and GiNaC's ex through the converter.

#include <span>
#include <vector>

#include "tape/expr.hpp"
#include "tape/tape.hpp"

namespace anholon {

/// How a scalar is made from an exact constant.
template <class S>
struct FromExact {
  S operator()(const Exact& value) const { return static_cast<S>(value.to_double()); }
};
template <>
struct FromExact<Exact> {
  Exact operator()(const Exact& value) const { return value; }
};
template <>
struct FromExact<long double> {
  long double operator()(const Exact& value) const {
    return std::strtold(value.decimal(30).c_str(), nullptr);
  }
};
template <>
struct FromExact<Expr> {
  Tape* tape;
  Expr operator()(const Exact& value) const { return {*tape, tape->constant(value)}; }
};

/// The nodes that some roots need, ready to be run many times without allocation.
template <class S>
class Interpreter {
 public:
  Interpreter() = default;
  template <class Constant = FromExact<S>>
  Interpreter(const Tape& tape, const std::vector<NodeId>& roots, const Constant& constant = {}) {
    std::vector<std::uint32_t> slot(tape.size(), 0);
    for (const NodeId id : tape.reachable(roots)) {
      const Node& n = tape.node(id);
      slot[id] = static_cast<std::uint32_t>(values_.size());
      values_.emplace_back(n.op == Op::constant ? constant(tape.value(id)) : S(0));
      if (n.op == Op::input) inputs_.emplace_back(slot[id], n.a);
      if (info(n.op).arity > 0)
        steps_.push_back({n.op, slot[id], slot[n.a], info(n.op).arity == 2 ? slot[n.b] : slot[n.a]});
    }
    for (const NodeId id : roots) roots_.push_back(slot[id]);
  }

  /// @param inputs  one value for each input of the tape, in order of their making
  /// @param outputs  one value for each root
  void operator()(std::span<const S> inputs, std::span<S> outputs) {
    for (const auto& [to, from] : inputs_) values_[to] = inputs[from];
    for (const Step& s : steps_) values_[s.to] = apply(s.op, values_[s.a], values_[s.b]);
    for (std::size_t i = 0; i < roots_.size(); ++i) outputs[i] = values_[roots_[i]];
  }

  [[nodiscard]] std::size_t output_count() const { return roots_.size(); }

 private:
  struct Step {
    Op op;
    std::uint32_t to, a, b;
  };
  std::vector<S> values_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> inputs_;
  std::vector<Step> steps_;
  std::vector<std::uint32_t> roots_;
};

template <class S>
std::vector<S> interpret(const Tape& tape, const std::vector<NodeId>& roots, std::span<const S> inputs,
                         FromExact<S> constant = {}) {
  std::vector<S> outputs(roots.size(), S(0));
  Interpreter<S>(tape, roots, constant)(inputs, outputs);
  return outputs;
}

}  // namespace anholon
