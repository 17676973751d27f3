// SPDX-License-Identifier: GPL-2.0-or-later
// The derivatives of the rates of the state by the state.
#include "derive/deriver.hpp"

namespace anholon {

void Deriver::prepare_state_jacobian() {
  if (!wants_state_jacobian()) return;
  const auto r_a_dddot =
      symbols_.block("r_a_dddot", motion_partition_.s_a(), "rad/s^3 or m/s^3", "third derivatives of r_a");
  result_->directions =
      state_directions(tape_, symbols_, motion_partition_, nu_, r_a_dot_, r_a_ddot_, r_a_dddot);
}

Matrix<Expr> Deriver::differentiated_accelerations(bool project) {
  const auto a = symbols_.block("nu_dot", motion_.k(), "mixed", "derivative of nu");
  const std::vector<Expr> force = driving_force(motion_partition_);
  const ReducedDynamics d =
      reduced_dynamics(motion_, motion_.reduction->kernel().H, nu_, r_a_dot_, r_a_ddot_, force, project);
  std::vector<Expr> unbalanced =
      picked(dynamics_.inverse_dynamics(symbols_.moving(d.velocity),
                                        accelerations(motion_, motion_.reduction->kernel().H, d, a)),
             motion_partition_.passive);
  for (std::size_t i = 0; i < unbalanced.size(); ++i) unbalanced[i] = force[i] - unbalanced[i];
  std::vector<NodeId> residual;
  for (const Expr& e : motion_.reduction->kernel().H.transposed() * unbalanced)
    residual.push_back(e.id(tape_));
  tape_.section("derivatives of the reduced forces");
  const Matrix<Expr> slopes = derivatives(tape_, residual, result_->directions);
  std::vector<NodeId> nodes;
  for (const Expr& e : slopes.entries()) nodes.push_back(e.id(tape_));
  tape_.section("reduced accelerations");
  const std::vector<Expr> nu_dot = solve_symmetric(d.M_r, {d.f_r}).front();
  nodes = substituted(tape_, nodes, a, nu_dot);
  std::vector<std::vector<Expr>> sides = {d.f_r};
  for (int j = 0; j < slopes.cols(); ++j) {
    sides.emplace_back();
    for (int i = 0; i < slopes.rows(); ++i)
      sides.back().emplace_back(tape_, nodes[static_cast<std::size_t>(i * slopes.cols() + j)]);
  }
  tape_.section("derivatives of the accelerations");
  const auto solved = solve_symmetric(d.M_r, sides);
  Matrix<Expr> result(slopes.rows(), slopes.cols());
  for (int j = 0; j < slopes.cols(); ++j) {
    for (int i = 0; i < slopes.rows(); ++i)
      result(i, j) = solved[static_cast<std::size_t>(j + 1)][static_cast<std::size_t>(i)];
  }
  return result;
}

void Deriver::derive_state_jacobian() {
  if (!wants_state_jacobian()) return;
  const auto nodes_of = [&](const std::vector<Expr>& v) {
    std::vector<NodeId> nodes;
    for (const Expr& e : v) nodes.push_back(e.id(tape_));
    return nodes;
  };
  tape_.section("derivatives of the velocities");
  const Matrix<Expr> velocities =
      derivatives(tape_, nodes_of(motion_.reduction->velocities(r_a_dot_, nu_)), result_->directions);
  std::vector<Route> routes;
  const auto add = [&](const std::string& name, const Matrix<Expr>& accelerations) {
    const int rows = velocities.rows() + accelerations.rows(), columns = velocities.cols() - 1;
    Matrix<Expr> by_state(rows, columns);
    std::vector<Expr> by_time;
    for (int i = 0; i < rows; ++i) {
      const auto entry = [&](int j) {
        return i < velocities.rows() ? velocities(i, j) : accelerations(i - velocities.rows(), j);
      };
      for (int j = 0; j < columns; ++j) by_state(i, j) = entry(j);
      by_time.push_back(entry(columns));
    }
    routes.push_back(
        {name,
         {block("rates_x", "mixed",
                "rows (eta, r_p_dot, nu_dot), columns (twist of the pose in body axes, r_p, "
                "nu); torque-driven coordinates behind the passive ones",
                by_state),
          block("rates_t", "mixed", "derivative by time, the motion of r_a going on", by_time)}});
  };
  if (motion_.k() == 0) {
    add("kinematics", Matrix<Expr>(0, velocities.cols()));
  } else {
    for (const bool project : {true, false})
      add(project ? "residual of the projected recursion" : "residual, (66)-(68)",
          differentiated_accelerations(project));
    for (const Function& f : program_.functions) {
      if (f.name != prefix_ + "forward_dynamics") continue;
      tape_.section("derivatives of the accelerations");
      add("derivative of forward_dynamics", derivatives(tape_, f.outputs.front().nodes, result_->directions));
    }
  }
  emit("state_jacobian",
       "Derivatives of the rates of the state (eta, r_p_dot, nu_dot) by the state and by time, exact.",
       routes);
}

}  // namespace anholon
