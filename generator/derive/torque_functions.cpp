// SPDX-License-Identifier: GPL-2.0-or-later
// Torques and multipliers, eqs. (26)-(27), and the dynamics with torques given, eq. (9).
#include <algorithm>

#include "derive/deriver.hpp"

namespace anholon {

void Deriver::derive_torques_and_multipliers() {
  const bool torques = wanted("inverse_torques") && motion_partition_.s_a() > 0;
  const bool multipliers = wanted("multipliers") && !mechanism_.rows.empty();
  if (!torques && !multipliers) return;
  const KinematicReduction& k = *motion_.reduction;
  const Partition& p = motion_partition_;
  const auto nu_dot = symbols_.block("nu_dot", motion_.k(), "mixed", "derivative of nu");
  const int redundant = k.static_basis().cols();
  const auto lambda_stat = symbols_.block(
      "lambda_stat", redundant, "mixed",
      "coordinates of the static loading in lambda_stat_basis; zero is the generalised inverse's share");
  const std::vector<Expr> force = driving_force(p);
  tape_.section("admissible velocities");
  const std::vector<Expr> passive = k.velocities(r_a_dot_, nu_);
  const std::vector<Expr> velocity = merged(p, passive, r_a_dot_);
  const State<Expr> state = symbols_.moving(velocity);
  std::vector<Expr> bias;
  if (!mechanism_.rows.empty()) bias = dynamics_.constraints(state).second;
  tape_.section("passive accelerations");
  std::vector<Expr> v_p = k.drift(r_a_dot_, nu_, bias, symbols_.motion(velocity));
  const std::vector<Expr> imposed = k.kernel().J * r_a_ddot_;
  const std::vector<Expr> reduced = k.kernel().H * nu_dot;
  for (std::size_t i = 0; i < v_p.size(); ++i) v_p[i] += imposed[i] + reduced[i];
  const std::vector<Expr> residual = dynamics_.inverse_dynamics(state, merged(p, v_p, r_a_ddot_));
  std::vector<Expr> passive_residual = picked(residual, p.passive);
  for (std::size_t i = 0; i < force.size(); ++i) passive_residual[i] -= force[i];
  if (torques) {
    tape_.section("torques");
    std::vector<Expr> tau = picked(residual, p.active);
    const std::vector<Expr> carried = k.kernel().J.transposed() * passive_residual;
    const std::vector<Expr> loading = k.rows().B.transposed() * (k.static_basis() * lambda_stat);
    for (std::size_t i = 0; i < tau.size(); ++i) tau[i] += carried[i] - loading[i];
    emit("inverse_torques", "Torques of the active joints, eq. (27) with the sign of lambda_stat of (26).",
         {{"projected recursion", {block("tau_a", "N m or N", "torques conjugate to r_a", tau)}}});
  }
  if (multipliers) {
    tape_.section("multipliers");
    emit("multipliers", "Constraint forces, eq. (26). They grow without bound where (A, B_p) loses rank.",
         {{"projected recursion",
           {block("lambda", "mixed", "one for each row of eq. (2)",
                  k.multipliers(passive_residual, lambda_stat))}}});
  }
}

void Deriver::derive_torque_driven() {
  const std::vector<std::string> family = {"torque_driven_dynamics", "torque_driven_kinematics",
                                           "torque_driven_velocities", "torque_driven_multipliers"};
  if (std::ranges::none_of(family, [this](const std::string& f) { return wanted(f); }) ||
      partition_of(model_).s_a() == 0 || !request_.torque_driven.empty())
    return;
  torque_driven_ = reduce(partition_of(model_, {"*"}));
  Reduced& all = torque_driven_;
  atlas_ = &all.atlas;
  const auto w =
      symbols_.block("w", all.k(), "mixed", "reduced velocities with r_a free: " + meaning_of_nu(all));
  for (std::size_t c = 0; c < all.atlas.charts.size(); ++c) {
    prefix_ = chart_prefix(c);
    chart_ = c;
    all.reduction = all.atlas.charts[c].get();
    derive_torque_driven(all, w, family);
  }
  prefix_.clear();
  chart_ = 0;
  if (all.atlas.charts.size() > 1)
    emit_quality(all.atlas, "torque_driven_chart_quality", "w", family[2], family[1]);
  atlas_ = &motion_.atlas;
  result_->torque_driven = report(all);
}

void Deriver::derive_torque_driven(const Reduced& all, const std::vector<Expr>& w,
                                   const std::vector<std::string>& family) {
  const KinematicReduction& k = *all.reduction;
  if (wanted(family[1])) {
    std::vector<OutputBlock> outputs = split_passive(all.partition, k.velocities({}, w), "");
    outputs.push_back(block("H_w", "mixed", "kernel of (A, B_p, B_a), rows (eta, r_p, r_a)", k.kernel().H));
    emit(family[1], "All velocities from the reduced ones, active joints free.", {{"kernel", outputs}});
  }
  if (wanted(family[2])) {
    std::vector<Expr> passive = eta_input();
    for (const Expr& e : r_p_dot_input()) passive.push_back(e);
    for (const Expr& e : r_a_dot_) passive.push_back(e);
    emit(family[2], "Reduced velocities of admissible ones, active joints free.",
         {{"kernel", {block("w", "mixed", "reduced velocities", k.reduced_velocities(passive, {}))}}});
  }
  const std::vector<Expr> force = driving_force(all.partition);
  if (wanted(family[0]) && all.k() > 0) {
    std::vector<Route> routes;
    for (const bool project : {true, false}) {
      const ReducedDynamics d = reduced_dynamics(all, k.kernel().H, w, {}, {}, force, project);
      routes.push_back({project ? "projected recursion" : "all blocks, (66)-(68)",
                        acceleration_blocks(all, "w", solved(all, d))});
    }
    emit(family[0],
         "Forward dynamics with the torques given, eq. (9): every constraint holds, compatibility included.",
         routes, "", true, [&] { return accurate_routes(all, "w", w, {}, {}, force); });
  }
  if (wanted(family[3]) && !mechanism_.rows.empty()) {
    const auto w_dot = symbols_.block("w_dot", all.k(), "mixed", "derivative of w");
    const ReducedDynamics d = reduced_dynamics(all, k.kernel().H, w, {}, {}, force, true);
    std::vector<Expr> residual = picked(
        dynamics_.inverse_dynamics(symbols_.moving(d.velocity), accelerations(all, k.kernel().H, d, w_dot)),
        all.partition.passive);
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= force[i];
    tape_.section("multipliers");
    emit(family[3], "Constraint forces with the torques given, least norm.",
         {{"projected recursion",
           {block("lambda", "mixed", "one for each row of eq. (2)",
                  k.multipliers(residual, std::vector<Expr>(static_cast<std::size_t>(k.static_basis().cols()),
                                                            Expr(0))))}}});
  }
}

}  // namespace anholon
