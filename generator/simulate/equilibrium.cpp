// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/equilibrium.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "describe/specialise.hpp"
#include "simulate/groups.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/runner.hpp"
#include "simulate/scene_program.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

/// Function `settling`: fourth and fifth derivatives of some passive coordinates along the motion, as
/// functions of pose, shape, nu and t alone.
void add_settling(SceneProgram& p, std::size_t chart, const std::vector<std::size_t>& which) {
  Program& program = p.derivation->program;
  Tape& tape = program.tape;
  const std::string prefix = chart_prefix(chart);
  std::vector<Expr> inputs, values;
  const auto replace = [&](const std::string& block, std::size_t i, NodeId value) {
    const auto found = std::ranges::find(program.inputs, block, &InputBlock::name);
    if (found == program.inputs.end()) return;
    inputs.emplace_back(tape, found->nodes[i]), values.emplace_back(tape, value);
  };
  for (const auto& [block, motion] : {std::pair{"r_a_dot", "r_m_dot"}, std::pair{"r_a_ddot", "r_m_ddot"}}) {
    const std::vector<NodeId> imposed = output_of(program, "imposed", motion);
    for (std::size_t i = 0; i < imposed.size(); ++i) replace(block, i, imposed[i]);
  }
  const std::vector<NodeId> r_m = output_of(program, "imposed", "r_m");
  for (std::size_t i = 0; i < r_m.size(); ++i) {
    const auto at = std::ranges::find(p.original.active, p.reduced.active[i]);
    replace("r_a", static_cast<std::size_t>(at - p.original.active.begin()), r_m[i]);
  }
  const std::vector<NodeId> torque = output_of(program, prefix + "imposed_torque", "torque");
  for (std::size_t i = 0; i < torque.size(); ++i)
    replace(p.reduced.active.empty() ? "tau_a" : "tau_d", i, torque[i]);
  const auto closed = [&](const std::vector<NodeId>& nodes) {
    return substituted(tape, substituted(tape, nodes, inputs, values), inputs,
                       values);  // torques have r_a_dot
  };
  std::vector<NodeId> moving, rates;
  for (const auto& [input, rate] : p.derivation->rates[chart]) moving.push_back(input), rates.push_back(rate);
  const auto nu = std::ranges::find(program.inputs, "nu", &InputBlock::name);
  const std::vector<NodeId> nu_dot = output_of(program, prefix + "forward_dynamics", "nu_dot");
  for (std::size_t i = 0; i < nu_dot.size(); ++i) moving.push_back(nu->nodes[i]), rates.push_back(nu_dot[i]);
  rates = closed(rates);
  Direction flow;
  for (std::size_t i = 0; i < moving.size(); ++i) flow.emplace_back(moving[i], rates[i]);

  std::vector<NodeId> accelerations = output_of(program, prefix + "forward_dynamics", "r_p_ddot");
  std::vector<NodeId> derivative;
  for (const std::size_t i : which) derivative.push_back(accelerations[i]);
  derivative = closed(derivative);
  OutputBlock block{"settling", "mixed", "fourth, then fifth derivatives", 2, static_cast<int>(which.size()),
                    {}};
  for (int order = 3; order <= 5; ++order) {
    derivative = directional_derivative(tape, derivative, flow);
    if (order >= 4) block.nodes.insert(block.nodes.end(), derivative.begin(), derivative.end());
  }
  program.functions.push_back(
      {prefix + "settling", "What vanishes on a motion without ringing.", {block}, ""});
}

/// The scene with (coordinates, rates) at the given values.
Scene started_at(const Scene& scene, const Eigen::VectorXd& values) {
  Scene moved = scene;
  const std::vector<int>& which = scene.initial.equilibrium;
  const auto count = static_cast<Eigen::Index>(which.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const int coordinate = which[static_cast<std::size_t>(i)];
    moved.initial.coordinates.emplace_back(coordinate, Exact::from_double(values(i)));
    moved.initial.velocities.emplace_back(6 + coordinate, Exact::from_double(values(count + i)));
  }
  return moved;
}

}  // namespace

Scene settled(const Scene& scene) {
  if (scene.initial.equilibrium.empty()) return scene;
  constexpr int most_iterations = 30;
  constexpr double step_share = 1e-4;  // of the working range: differences of what is nearly linear
  constexpr double done = 1e-12;       // change of the deflections, relative
  Scene open = scene;
  const std::vector<int> kept = kept_coordinates(scene.model, scene);
  std::erase_if(open.initial.equilibrium, [&](int c) { return kept[static_cast<std::size_t>(c)] < 0; });
  SceneProgram program = make_program(open);
  std::vector<std::size_t> which;
  for (const int c : open.initial.equilibrium) {
    const int velocity = kept[static_cast<std::size_t>(c)] + program.original.n;
    which.push_back(static_cast<std::size_t>(std::ranges::find(program.original.passive, velocity) -
                                             program.original.passive.begin() - program.original.n));
  }
  for (std::size_t c = 0; c < program.derivation->reduction.charts.size(); ++c)
    add_settling(program, c, which);

  const auto count = static_cast<Eigen::Index>(which.size());
  Eigen::VectorXd values = Eigen::VectorXd::Zero(2 * count);
  with_group<double>(program.model.group, [&]<class G>(std::type_identity<G>) {
    Runner<double> run(open, program, &program.derivation->program);
    const auto residual = [&](const Eigen::VectorXd& at) {
      initial_state<G>(started_at(open, at), program, run, 0);  // leaves it in the buffers
      bound(&program.derivation->program, chart_prefix(run.chart()) + "settling", run.b)();
      const std::vector<double>& found = run.b["settling"];
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(found.data(), 2 * count));
    };
    for (int iteration = 0;; ++iteration) {
      const Eigen::VectorXd here = residual(values);
      Eigen::MatrixXd slopes(2 * count, 2 * count);
      for (Eigen::Index j = 0; j < 2 * count; ++j) {
        const Coordinate& coordinate = scene.model.coordinates[static_cast<std::size_t>(
            open.initial.equilibrium[static_cast<std::size_t>(j % count)])];
        const double step = step_share * (coordinate.upper - coordinate.lower).to_double();
        Eigen::VectorXd moved = values;
        moved(j) += step;
        slopes.col(j) = (residual(moved) - here) / step;
      }
      const Eigen::VectorXd change = slopes.partialPivLu().solve(-here);
      if (!change.allFinite()) break;
      values += change;
      if (change.cwiseAbs().maxCoeff() <= done * values.cwiseAbs().maxCoeff()) {
        open = started_at(open, values);
        open.initial.equilibrium.clear();
        return;
      }
      if (iteration == most_iterations) break;
    }
  });
  if (!open.initial.equilibrium.empty())
    throw ModelError(scene.initial_where,
                     "no equilibrium was found for the coordinates that should start there",
                     "name compliant coordinates only, or give their initial values");
  return open;
}

}  // namespace anholon
