// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The inputs of a program: parameters, pose, shape, velocities. Pose is R (row-major) and p for SE3, (x, y,
// theta) for SE2, R for SO3, p for translations.

#include <string>
#include <vector>

#include "anholon/mechanism.hpp"
#include "describe/model.hpp"
#include "reduce/configuration_search.hpp"
#include "reduce/elimination.hpp"
#include "reduce/partition.hpp"
#include "tape/interface.hpp"

namespace anholon {

class ProgramSymbols {
 public:
  ProgramSymbols(const Model& model, const Partition& partition, Program& program);

  /// Parameters in the model's order.
  [[nodiscard]] const std::vector<Expr>& parameters() const { return parameters_; }
  /// Pose and shape, with zero velocities.
  [[nodiscard]] const State<Expr>& position() const { return position_; }
  /// The entries of a new or existing input block.
  std::vector<Expr> block(const std::string& name, int size, const std::string& unit,
                          const std::string& meaning);

  /// Position with velocities v (n + s).
  [[nodiscard]] State<Expr> moving(const std::vector<Expr>& v) const;
  /// (input, rate) of every position input for velocities v (n + s), with t_dot = 1.
  [[nodiscard]] std::vector<std::pair<NodeId, NodeId>> motion(const std::vector<Expr>& v) const;
  /// Evaluates nodes that depend on parameters and position at some states, default parameters.
  [[nodiscard]] Sampler sampler(const std::vector<State<double>>& states) const;
  /// Evaluates these nodes at any state, default parameters.
  [[nodiscard]] ConfigurationSearch::Values evaluator(const std::vector<NodeId>& nodes) const;

  /// Values of the position and parameter inputs at a state; other inputs are zero.
  template <class S>
  void fill_position(const State<S>& state, const std::vector<S>& parameters, std::vector<S>& inputs) const {
    using std::atan2;
    const auto set = [&](const Expr& e, const S& value) {
      inputs[program_.tape.node(e.id(program_.tape)).a] = value;
    };
    for (std::size_t i = 0; i < parameters_.size(); ++i) set(parameters_[i], parameters[i]);
    set(position_.t, state.t);
    for (std::size_t i = 0; i < position_.r.size(); ++i) set(position_.r[i], state.r[i]);
    if (model_.group == GroupKind::SE2) {
      set(planar_[0], state.p.x), set(planar_[1], state.p.y),
          set(planar_[2], atan2(state.R(1, 0), state.R(0, 0)));
      return;
    }
    if (model_.group == GroupKind::SE3 || model_.group == GroupKind::SO3) {
      for (std::size_t i = 0; i < 9; ++i) set(position_.R.m[i], state.R.m[i]);
    }
    for (const int c : free_components(model_.group)) {
      if (c < 3) set(position_.p[c], state.p[c]);
    }
  }

 private:
  [[nodiscard]] std::vector<double> default_parameters() const;

  const Model& model_;
  Program& program_;
  std::vector<Expr> parameters_;
  State<Expr> position_;
  std::vector<Expr> planar_;  // x, y, theta of SE2
};

}  // namespace anholon
