// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/rounding_shares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "optimise/accuracy/choice.hpp"
#include "optimise/accuracy/compensation.hpp"
#include "optimise/accuracy/natural_scale.hpp"
#include "optimise/accuracy/rounded.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

/// The operations that some outputs need, with their values, derivatives and errors at one state.
class Evaluation {
 public:
  Evaluation(const Tape& tape, const std::vector<NodeId>& roots)
      : nodes_(tape.reachable(roots)), slot_(tape.size(), 0), steps_(nodes_.size()) {
    const WorkingDigits precision(rounded_digits);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Node& n = tape.node(nodes_[i]);
      slot_[nodes_[i]] = static_cast<std::uint32_t>(i);
      Step& step = steps_[i];
      step.op = n.op;
      step.arity = info(n.op).arity;
      step.a = step.arity > 0 ? slot_[n.a] : n.a;  // of an input: which
      step.b = step.arity > 1 ? slot_[n.b] : 0;
      if (n.op != Op::constant) continue;
      step.value = tape.value(nodes_[i]).to_double();
      step.lost = (tape.value(nodes_[i]) - Exact::from_double(step.value)).to_double();
    }
    for (const auto& [id, partner] : partners_on_circle(tape, nodes_)) {
      if (tape.node(id).op == Op::sin) circles_.emplace_back(slot_[id], slot_[partner]);
    }
    std::ranges::sort(circles_);
    adjoint_.resize(nodes_.size());
  }

  [[nodiscard]] double value(NodeId id) const { return steps_[slot_[id]].value; }
  [[nodiscard]] const std::vector<NodeId>& nodes() const { return nodes_; }

  void run(const std::vector<double>& inputs) {
    const WorkingDigits precision(rounded_digits);
    for (Step& s : steps_) {
      if (s.arity == 0) {
        if (s.op == Op::input) s.value = inputs[s.a];
        continue;
      }
      const double a = steps_[s.a].value, b = s.arity == 2 ? steps_[s.b].value : 0.0;
      switch (s.op) {  // what most operations are, without the detour through Rounded
        case Op::add:
          s.set(a + b, sum_error(a, b), 1, 1);
          break;
        case Op::sub:
          s.set(a - b, sum_error(a, -b), 1, -1);
          break;
        case Op::mul:
          s.set(a * b, product_error(a, b), b, a);
          break;
        default: {
          const Rounded ra(a), rb(b), y = apply(s.op, ra, rb);
          s.set(y.x, rounding_error(s.op, y, ra, rb), tangent(s.op, y, ra, rb, Rounded(1), Rounded(0)).x,
                s.arity == 2 ? tangent(s.op, y, ra, rb, Rounded(0), Rounded(1)).x : 0.0);
        }
      }
    }
    for (const auto& [sine, cosine] : circles_) {
      Step &s = steps_[sine], &c = steps_[cosine];
      const double off_circle = s.value * s.lost + c.value * c.lost;
      s.left = s.lost - s.value * off_circle, c.left = c.lost - c.value * off_circle;
    }
  }

  /// Errors of all nodes to first order, from what each operation lost in `run`: in one go for several
  /// programs.
  /// @param kept  for each node, of how many programs, the first ones, it is not compensated
  void carry_errors(const std::vector<std::uint8_t>& kept, std::size_t programs) {
    errors_.resize(steps_.size() * programs);
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const Step& s = steps_[i];
      double* const error = &errors_[i * programs];
      for (std::size_t k = 0; k < programs; ++k) error[k] = k < kept[i] ? s.lost : s.left;
      if (s.arity >= 1) add(error, s.by_a, &errors_[s.a * programs], programs);
      if (s.arity == 2) add(error, s.by_b, &errors_[s.b * programs], programs);
    }
  }
  [[nodiscard]] double error(NodeId id, std::size_t program, std::size_t programs) const {
    return errors_[slot_[id] * programs + program];
  }

  /// Calls visit(node, derivative with respect to it) for all nodes that an output depends on.
  template <class Visit>
  void derivatives_of(NodeId output, const Visit& visit) {
    std::ranges::fill(adjoint_, 0.0);
    adjoint_[slot_[output]] = 1;
    for (std::size_t i = slot_[output] + std::size_t{1}; i-- > 0;) {
      if (adjoint_[i] == 0) continue;
      visit(nodes_[i], adjoint_[i]);
      const Step& s = steps_[i];
      if (s.arity >= 1) adjoint_[s.a] += adjoint_[i] * s.by_a;
      if (s.arity == 2) adjoint_[s.b] += adjoint_[i] * s.by_b;
    }
  }

 private:
  struct Step {
    Op op;
    int arity;
    std::uint32_t a, b;
    double value = 0, by_a = 0, by_b = 0;
    double lost = 0, left = 0;  // by rounding, and what of it compensation leaves
    void set(double y, double error, double derivative_by_a, double derivative_by_b) {
      value = y, lost = error, by_a = derivative_by_a, by_b = derivative_by_b;
    }
  };
  static void add(double* to, double factor, const double* from, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) to[k] += factor * from[k];
  }

  std::vector<NodeId> nodes_;
  std::vector<std::uint32_t> slot_;
  std::vector<Step> steps_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> circles_;  // sine and cosine of one angle
  std::vector<double> adjoint_, errors_;
};

double largest_of(const Evaluation& evaluation, const OutputBlock& block) {
  double largest = 0;
  for (const NodeId id : block.nodes) largest = std::max(largest, std::abs(evaluation.value(id)));
  return largest;
}

/// What one ulp of every input changes in some entries of a block, in ulps of its scale.
/// @param visit_operation  told of every other node, and what one ulp of it changes in an entry
template <class Visit>
double largest_kappa(Evaluation& evaluation, const Tape& tape, const std::vector<NodeId>& entries,
                     double scale, const Visit& visit_operation) {
  double kappa = 0;
  for (const NodeId root : entries) {
    double of_inputs = 0;
    evaluation.derivatives_of(root, [&](NodeId id, double derivative) {
      const double change = std::abs(derivative * evaluation.value(id)) / scale;
      if (!std::isfinite(change)) return;
      if (tape.node(id).op == Op::input) {
        of_inputs += change;
      } else {
        visit_operation(id, change);
      }
    });
    kappa = std::max(kappa, of_inputs);
  }
  return kappa;
}
double largest_kappa(Evaluation& evaluation, const Tape& tape, const std::vector<NodeId>& entries,
                     double scale) {
  return largest_kappa(evaluation, tape, entries, scale, [](NodeId, double) {});
}

double allowance_of(double kappa) { return std::max(1.0, kappa / 5); }

}  // namespace

RoundingShares rounding_shares(const Tape& tape, const std::vector<OutputBlock>& outputs,
                               const std::vector<std::vector<double>>& states) {
  Evaluation evaluation(tape, roots_of(outputs));
  std::vector<std::vector<double>> scales(outputs.size());
  for (const std::vector<double>& state : states) {
    evaluation.run(state);
    for (std::size_t b = 0; b < outputs.size(); ++b) scales[b].push_back(largest_of(evaluation, outputs[b]));
  }
  for (std::vector<double>& of_block : scales) of_block = natural_scales(of_block, measured_states);
  RoundingShares result{std::vector(tape.size(), 0.0), {}};
  std::vector<double> at_state(tape.size(), 0.0);
  for (std::size_t s = 0; s < states.size(); ++s) {
    evaluation.run(states[s]);
    result.allowance.emplace_back();
    for (std::size_t b = 0; b < outputs.size(); ++b) {
      const double kappa =
          largest_kappa(evaluation, tape, outputs[b].nodes, scales[b][s],
                        [&](NodeId id, double change) { at_state[id] = std::max(at_state[id], change / 2); });
      result.allowance[s].push_back(allowance_of(kappa));
      for (const NodeId id : evaluation.nodes()) {
        result.of_node[id] = std::max(result.of_node[id], at_state[id] / result.allowance[s][b]);
        at_state[id] = 0;
      }
    }
  }
  return result;
}

std::vector<std::vector<double>> first_order_errors(const Tape& tape, const std::vector<OutputBlock>& outputs,
                                                    const std::vector<std::vector<double>>& states,
                                                    const std::vector<double>& shares,
                                                    const std::vector<double>& bounds) {
  constexpr double unquestioned = 5;        // ulps; what the inputs excuse matters beyond it only
  constexpr std::size_t large_block = 100;  // of more entries that with the largest error stands for all
  const std::size_t programs = bounds.size();
  Evaluation evaluation(tape, roots_of(outputs));
  const std::unordered_map<NodeId, NodeId> partners = partners_on_circle(tape, evaluation.nodes());
  std::vector<std::uint8_t> kept;
  for (const NodeId id : evaluation.nodes()) {
    const Op op = tape.node(id).op;
    const bool is_certain = shares.empty() || !(has_known_error(op) || partners.contains(id));
    const auto first_beyond =
        std::ranges::find_if(bounds, [&](double b) { return !is_certain && is_beyond(op, shares[id], b); });
    kept.push_back(static_cast<std::uint8_t>(is_certain ? programs : first_beyond - bounds.begin()));
  }
  // largest error and entry of each block at each state
  std::vector<std::vector<std::vector<double>>> errors(programs,
                                                       std::vector(outputs.size(), std::vector<double>()));
  std::vector<std::vector<double>> scales(outputs.size());
  std::vector<std::vector<NodeId>> worst_entry(outputs.size());  // of the first program
  for (const std::vector<double>& state : states) {
    evaluation.run(state);
    evaluation.carry_errors(kept, programs);
    for (std::size_t b = 0; b < outputs.size(); ++b) {
      scales[b].push_back(largest_of(evaluation, outputs[b]));
      worst_entry[b].push_back(std::ranges::max(outputs[b].nodes, {}, [&](NodeId id) {
        const double error = std::abs(evaluation.error(id, 0, programs));
        return std::isfinite(error) ? error : 0;
      }));
      for (std::size_t i = 0; i < programs; ++i) {
        double& largest = errors[i][b].emplace_back(0);
        for (const NodeId id : outputs[b].nodes) {
          const double error = std::abs(evaluation.error(id, i, programs));
          if (std::isfinite(error)) largest = std::max(largest, error);
        }
      }
    }
  }
  for (std::vector<double>& of_block : scales) of_block = natural_scales(of_block, states.size());
  std::vector<std::vector<double>> result(programs, std::vector(states.size(), 0.0));
  for (std::size_t s = 0; s < states.size(); ++s) {
    bool has_run = false;
    for (std::size_t b = 0; b < outputs.size(); ++b) {
      double allowance = 0;  // once it is needed
      for (std::size_t i = 0; i < programs; ++i) {
        double error = errors[i][b][s] / (scales[b][s] * std::numeric_limits<double>::epsilon());
        if (error > unquestioned) {
          if (!has_run) evaluation.run(states[s]), has_run = true;
          if (allowance == 0) {
            const bool is_large = outputs[b].nodes.size() > large_block;
            const std::vector<NodeId>& entries = is_large ? std::vector{worst_entry[b][s]} : outputs[b].nodes;
            allowance = allowance_of(largest_kappa(evaluation, tape, entries, scales[b][s]));
          }
          error /= allowance;
        }
        result[i][s] = std::max(result[i][s], error);
      }
    }
  }
  return result;
}

double first_order_condition(const Tape& tape, const OutputBlock& block, const std::vector<double>& state,
                             double scale) {
  Evaluation evaluation(tape, block.nodes);
  evaluation.run(state);
  return largest_kappa(evaluation, tape, block.nodes, scale);
}

}  // namespace anholon
