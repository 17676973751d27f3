// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/rounding_shares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimise/accuracy/choice.hpp"
#include "optimise/accuracy/natural_scale.hpp"
#include "optimise/accuracy/rounded.hpp"
#include "reduce/samples.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

/// The operations that some outputs need, with their values and derivatives at one state.
class Evaluation {
 public:
  Evaluation(const Tape& tape, const std::vector<NodeId>& roots)
      : tape_(&tape), nodes_(tape.reachable(roots)), slot_(tape.size(), 0) {
    const WorkingDigits precision(rounded_digits);
    for (const NodeId id : nodes_) {
      slot_[id] = static_cast<std::uint32_t>(values_.size());
      values_.emplace_back(tape.is_constant(id) ? tape.value(id).to_double() : 0.0);
    }
    partial_.resize(nodes_.size());
    adjoint_.resize(nodes_.size());
  }

  [[nodiscard]] double value(NodeId id) const { return values_[slot_[id]].x; }
  [[nodiscard]] const std::vector<NodeId>& nodes() const { return nodes_; }

  void run(const std::vector<double>& inputs) {
    const WorkingDigits precision(rounded_digits);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Node& n = tape_->node(nodes_[i]);
      if (n.op == Op::input) values_[i] = Rounded(inputs[n.a]);
      const int arity = info(n.op).arity;
      if (arity == 0) continue;
      const Rounded a = values_[slot_[n.a]], b = arity == 2 ? values_[slot_[n.b]] : Rounded(0);
      const Rounded y = values_[i] = apply(n.op, a, b);
      partial_[i] = {tangent(n.op, y, a, b, Rounded(1), Rounded(0)).x,
                     arity == 2 ? tangent(n.op, y, a, b, Rounded(0), Rounded(1)).x : 0.0};
    }
  }

  /// Calls visit(node, derivative with respect to it) for all nodes that a sum, weights times roots, depends
  /// on.
  template <class Visit>
  void derivatives_of(const std::vector<std::pair<NodeId, double>>& sum, const Visit& visit) {
    std::ranges::fill(adjoint_, 0.0);
    std::size_t last = 0;
    for (const auto& [root, weight] : sum) {
      adjoint_[slot_[root]] += weight;
      last = std::max<std::size_t>(last, slot_[root]);
    }
    for (std::size_t i = last + 1; i-- > 0;) {
      if (adjoint_[i] == 0) continue;
      visit(nodes_[i], adjoint_[i]);
      const Node& n = tape_->node(nodes_[i]);
      const int arity = info(n.op).arity;
      if (arity >= 1) adjoint_[slot_[n.a]] += adjoint_[i] * partial_[i].first;
      if (arity == 2) adjoint_[slot_[n.b]] += adjoint_[i] * partial_[i].second;
    }
  }

 private:
  const Tape* tape_;
  std::vector<NodeId> nodes_;
  std::vector<std::uint32_t> slot_;
  std::vector<Rounded> values_;
  std::vector<std::pair<double, double>> partial_;
  std::vector<double> adjoint_;
};

/// The natural scale of each block at each state.
std::vector<std::vector<double>> scales_of(Evaluation& evaluation, const std::vector<OutputBlock>& outputs,
                                           const std::vector<std::vector<double>>& states,
                                           std::size_t random) {
  std::vector<std::vector<double>> scales(outputs.size());
  for (const std::vector<double>& state : states) {
    evaluation.run(state);
    for (std::size_t b = 0; b < outputs.size(); ++b) {
      double largest = 0;
      for (const NodeId id : outputs[b].nodes) largest = std::max(largest, std::abs(evaluation.value(id)));
      scales[b].push_back(largest);
    }
  }
  for (std::vector<double>& of_block : scales) of_block = natural_scales(of_block, random);
  return scales;
}

double allowance_of(double kappa) { return std::max(1.0, kappa / 5); }

}  // namespace

RoundingShares rounding_shares(const Tape& tape, const std::vector<OutputBlock>& outputs,
                               const std::vector<std::vector<double>>& states) {
  Evaluation evaluation(tape, roots_of(outputs));
  const auto scales = scales_of(evaluation, outputs, states, measured_states);
  RoundingShares result{std::vector(tape.size(), 0.0), {}};
  std::vector<double> at_state(tape.size(), 0.0);
  for (std::size_t s = 0; s < states.size(); ++s) {
    evaluation.run(states[s]);
    result.allowance.emplace_back();
    for (std::size_t b = 0; b < outputs.size(); ++b) {
      double kappa = 0;
      for (const NodeId root : outputs[b].nodes) {
        double of_inputs = 0;
        evaluation.derivatives_of({{root, 1.0}}, [&](NodeId id, double derivative) {
          const double change = std::abs(derivative * evaluation.value(id)) / scales[b][s];
          if (!std::isfinite(change)) return;
          if (tape.node(id).op == Op::input) {
            of_inputs += change;
          } else {
            at_state[id] = std::max(at_state[id], change / 2);
          }
        });
        kappa = std::max(kappa, of_inputs);
      }
      result.allowance[s].push_back(allowance_of(kappa));
      for (const NodeId id : evaluation.nodes()) {
        result.of_node[id] = std::max(result.of_node[id], at_state[id] / result.allowance[s][b]);
        at_state[id] = 0;
      }
    }
  }
  return result;
}

std::vector<double> expected_errors(const Tape& tape, const std::vector<OutputBlock>& outputs,
                                    const std::vector<std::vector<double>>& states) {
  Evaluation evaluation(tape, roots_of(outputs));
  const auto scales = scales_of(evaluation, outputs, states, states.size());
  std::vector<double> result;
  SampleSource signs;
  for (std::size_t s = 0; s < states.size(); ++s) {
    evaluation.run(states[s]);
    double error = 0;
    for (std::size_t b = 0; b < outputs.size(); ++b) {
      std::vector<std::pair<NodeId, double>> sum;
      for (const NodeId id : outputs[b].nodes) sum.emplace_back(id, signs.uniform() < 0.5 ? -1.0 : 1.0);
      double squares = 0, kappa = 0;
      evaluation.derivatives_of(sum, [&](NodeId id, double derivative) {
        const double change = std::abs(derivative * evaluation.value(id)) / scales[b][s];
        if (!std::isfinite(change)) return;
        if (tape.node(id).op == Op::input) {
          kappa += change;
        } else {
          squares += change * change / 4;
        }
      });
      error = std::max(error, std::sqrt(squares) / allowance_of(kappa));
    }
    result.push_back(error);
  }
  return result;
}

}  // namespace anholon
