// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/articulated_route.hpp"

#include <algorithm>
#include <limits>

#include "anholon/articulated.hpp"
#include "optimise/accuracy/rounding_error.hpp"
#include "reduce/samples.hpp"

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
  SampleSource source(8);
  std::vector<std::vector<double>> states(6, std::vector<double>(tape.inputs().size()));
  for (std::vector<double>& state : states) {
    for (double& x : state) x = source.uniform(Exact(-3), Exact(3)).to_double();
    for (std::size_t i = 0; i < parameters.size(); ++i)
      state[tape.node(parameters[i]).a] = values[i].to_double();
  }
  OutputBlock all;
  all.nodes = nodes;
  const RoundingError error = rounding_errors(tape, {{all}}, states).front();
  return error.is_measured() ? error.worst * std::numeric_limits<double>::epsilon()
                             : std::numeric_limits<double>::infinity();
}

}  // namespace anholon
