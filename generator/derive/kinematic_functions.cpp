// SPDX-License-Identifier: GPL-2.0-or-later
// Functions of velocities and positions: eqs. (2), (11) and (70), and the conditions under which they hold.
#include <algorithm>

#include "derive/deriver.hpp"

namespace anholon {

std::vector<OutputBlock> Deriver::split_passive(const Partition& p, const std::vector<Expr>& passive,
                                                const std::string& order) {
  const Partition original = partition_of(model_);
  std::vector<Expr> eta(passive.begin(), passive.begin() + p.n);
  std::vector<Expr> r_p, r_a;
  for (auto i = static_cast<std::size_t>(p.n); i < p.passive.size(); ++i) {
    const bool is_active = std::ranges::find(original.active, p.passive[i]) != original.active.end();
    (is_active ? r_a : r_p).push_back(passive[i]);
  }
  const bool acceleration = order == "dot";
  const std::string driven = p.active.empty() && request_.torque_driven.empty() ? "r_a" : "r_d";
  return {block(acceleration ? "eta_dot" : "eta", acceleration ? "m/s^2, rad/s^2" : "m/s, rad/s",
                "twist of the reference body in its own axes, linear part first", eta),
          block(acceleration ? "r_p_ddot" : "r_p_dot", "per r_p", "passive coordinates", r_p),
          block(driven + (acceleration ? "_ddot" : "_dot"), "per r_a", "torque-driven coordinates", r_a)};
}

void Deriver::derive_kinematics() {
  const KinematicReduction& k = *motion_.reduction;
  if (wanted("kinematics")) {
    const std::vector<Expr> passive = k.velocities(r_a_dot_, nu_);
    std::vector<OutputBlock> outputs = split_passive(motion_partition_, passive, "");
    outputs.push_back(block("H", "mixed", "kernel of (A, B_p), rows (eta, r_p)", k.kernel().H));
    outputs.push_back(block("J", "mixed", "rows (eta, r_p)", k.kernel().J));
    emit("kinematics", "Passive velocities from reduced ones, eq. (11): (eta, r_p_dot) = J r_a_dot + H nu.",
         {{"kernel", outputs}});
  }
  if (wanted("reduced_velocities")) {
    const std::vector<Expr> passive = full_passive();
    emit("reduced_velocities", "Reduced velocities of admissible ones: the inverse of eq. (11) on its range.",
         {{"kernel", {block("nu", "mixed", "reduced velocities", k.reduced_velocities(passive, r_a_dot_))}}});
  }
}

std::vector<Expr> Deriver::eta_input() {
  return symbols_.block("eta", motion_partition_.n, "m/s, rad/s",
                        "twist of the reference body in its own axes, linear part first");
}

std::vector<Expr> Deriver::r_p_dot_input() {
  return symbols_.block("r_p_dot", partition_of(model_).s_p(), "rad/s or m/s", "rates of r_p");
}

std::vector<Expr> Deriver::full_passive() {
  std::vector<Expr> passive = eta_input();
  const std::vector<Expr> r_p_dot = r_p_dot_input();
  passive.insert(passive.end(), r_p_dot.begin(), r_p_dot.end());
  if (motion_partition_.passive.size() >
      passive.size()) {  // torque-driven coordinates in the reduced dynamics
    const auto driven =
        symbols_.block("r_d_dot", static_cast<int>(motion_partition_.passive.size() - passive.size()),
                       "rad/s or m/s", "rates of torque-driven coordinates");
    passive.insert(passive.end(), driven.begin(), driven.end());
  }
  return passive;
}

void Deriver::derive_constraints() {
  if (!wanted("constraints") || mechanism_.rows.empty()) return;
  tape_.section("constraints");
  const auto [G, bias] = dynamics_.constraints(symbols_.moving(full_velocity()));
  const Partition p = partition_of(model_);
  const std::vector<int> rows = range(G.rows());
  std::vector<int> coordinates(p.passive.begin() + p.n, p.passive.end());
  emit("constraints",
       "Rows of eq. (2), A eta + B_p r_p_dot + B_a r_a_dot = 0, and the bias (A_dot eta + B_p_dot r_p_dot + "
       "B_a_dot r_a_dot).",
       {{"recursion",
         {block("A", "mixed", "rows x n", G.block(rows, range(p.n))),
          block("B_p", "mixed", "rows x s_p", G.block(rows, coordinates)),
          block("B_a", "mixed", "rows x s_a", G.block(rows, p.active)), block("bias", "mixed", "rows", bias),
          block("lambda_stat_basis", "1", "basis of ker (A, B_p)^T, rows x (rows - rank)",
                motion_.reduction->static_basis())}}});
}

void Deriver::derive_compatibility() {
  if (!wanted("compatibility") || motion_.ranks.m <= motion_.ranks.m_locked) return;
  const KinematicReduction& k = *motion_.reduction;
  tape_.section("compatibility");
  const Matrix<Expr> Nt = k.static_basis().transposed();
  const std::vector<Expr> velocity = k.rows().B * r_a_dot_;
  const State<Expr> state = symbols_.moving(merged(motion_partition_, k.velocities(r_a_dot_, nu_), r_a_dot_));
  std::vector<Expr> acceleration = k.rows().B * r_a_ddot_;
  const std::vector<Expr> bias = dynamics_.constraints(state).second;
  for (std::size_t i = 0; i < acceleration.size(); ++i) acceleration[i] += bias[i];
  const auto residuals = [&](const std::vector<Expr>& of_velocity, const std::vector<Expr>& of_acceleration) {
    return std::vector<OutputBlock>{
        block("velocity_residual", "mixed", "N^T B_a r_a_dot", Nt * of_velocity),
        block("acceleration_residual", "mixed", "N^T (B_a r_a_ddot + bias)", Nt * of_acceleration)};
  };
  const auto projected = [&] {  // errors of N towards the rows then meet nothing
    return std::vector<Route>{
        {"projected twice", residuals(k.out_of_range(velocity), k.out_of_range(acceleration))}};
  };
  emit("compatibility",
       "Conditions on the imposed motion of an over-constrained system (remark 3): both residuals must "
       "vanish.",
       {{"kernel", residuals(velocity, acceleration)}}, "", true, projected);
}

void Deriver::derive_position_conditions() {
  if (!wanted("position_conditions") || model_.positions.empty()) return;
  tape_.section("conditions on the position");
  const auto [values, slopes] = dynamics_.conditions(symbols_.position());
  emit("position_conditions",
       "Conditions on the position that the constraint rows keep: zero, or their value where the contact "
       "began.",
       {{"recursion",
         {block("Phi", "m or 1", "values", values),
          block("Phi_q", "mixed",
                "derivatives by the velocities (twist in the reference body's axes, coordinates in "
                "declared order)",
                slopes)}}});
}

void Deriver::derive_poses() {
  if (!wanted("body_poses")) return;
  std::vector<Mat3<Expr>> R;
  std::vector<Vec3<Expr>> p;
  FreeDynamics<Expr>(described_).poses(symbols_.position(), R, p);  // also of bodies that are merged
  std::vector<OutputBlock> outputs;
  for (std::size_t b = 0; b < R.size(); ++b) {
    Matrix<Expr> rotation(3, 3);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rotation(i, j) = R[b](i, j);
    }
    outputs.push_back(
        block("R_" + model_.bodies[b].name, "1", "orientation in the world, row-major", rotation));
    outputs.push_back(
        block("p_" + model_.bodies[b].name, "m", "origin in the world", std::vector{p[b].x, p[b].y, p[b].z}));
  }
  emit("body_poses", "Poses of the body frames in the world, eq. (70).", {{"recursion", outputs}});
}

}  // namespace anholon
