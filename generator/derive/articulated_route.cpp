// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/articulated_route.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "anholon/articulated.hpp"
#include "reduce/samples.hpp"
#include "tape/interpret.hpp"

namespace anholon {

bool is_rigid_tree(const Mechanism<Expr>& mechanism, const State<Expr>& state) {
  const auto is_rigid = [](const Body<Expr>& b) { return b.modes.empty() && !b.fluid; };
  if (!mechanism.rows.empty() || !mechanism.wrenches.empty() ||
      !std::ranges::all_of(mechanism.bodies, is_rigid))
    return false;
  RigidTree<Expr> tree(mechanism);
  tree.position(state.r);
  return joints_are_independent(tree);
}

std::vector<Expr> articulated_accelerations(const Mechanism<Expr>& mechanism, const State<Expr>& state,
                                            const std::vector<Expr>& torque) {
  mechanism.section("accelerations without joints' own");
  const Vec3<Expr> drift =
      cross(state.eta.angular, state.eta.linear) - transposed_times(state.R, mechanism.gravity);
  const bool is_free = mechanism.group == GroupKind::SE3;  // gravity then never enters
  std::vector<Expr> force = torque, applied(6 + torque.size(), Expr(0));
  if (mechanism.generalised_forces) mechanism.generalised_forces(state, applied);
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += applied[6 + i];
  RigidTree<Expr> tree(mechanism);
  tree.position(state.r);
  tree.move_base(state.eta.angular, {}, is_free ? Vec3<Expr>{} : drift);
  tree.move(state.r_dot, std::vector<Expr>(torque.size(), Expr(0)));
  TreeAcceleration<Expr> result = articulated_acceleration(tree, force);
  if (is_free) result.base.linear -= drift;
  std::vector<Expr> accelerations;
  for (const int c : free_components(mechanism.group)) accelerations.push_back(result.base[c]);
  accelerations.insert(accelerations.end(), result.r_ddot.begin(), result.r_ddot.end());
  return accelerations;
}

double rounding_of(const Tape& tape, const std::vector<NodeId>& nodes, std::span<const NodeId> parameters,
                   std::span<const Exact> values) {
  constexpr int states = 6;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const WorkingDigits precision(60);
  Interpreter<Exact> exactly(tape, nodes);
  Interpreter<double> rounded(tape, nodes);
  std::vector<Exact> in(tape.inputs().size()), want(nodes.size());
  std::vector<double> in_double(in.size()), got(nodes.size());
  SampleSource source(8);
  double worst = 0;
  for (int s = 0; s < states; ++s) {
    for (Exact& x : in) x = source.uniform(Exact(-3), Exact(3));
    for (std::size_t i = 0; i < parameters.size(); ++i)
      in[tape.node(parameters[i]).a] = Exact::from_double(values[i].to_double());
    std::ranges::transform(in, in_double.begin(), [](const Exact& x) { return x.to_double(); });
    try {
      exactly(in, want);
    } catch (const std::domain_error&) {
      return infinite;
    }
    rounded(in_double, got);
    double error = 0, size = std::numeric_limits<double>::min();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!std::isfinite(got[i])) return infinite;
      error = std::max(error, abs(Exact::from_double(got[i]) - want[i]).to_double());
      size = std::max(size, std::abs(want[i].to_double()));
    }
    worst = std::max(worst, error / size);
  }
  return worst;
}

}  // namespace anholon
