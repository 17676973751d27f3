// SPDX-License-Identifier: GPL-2.0-or-later
// Functions of forces and accelerations: eq. (1), and its projection on the kernel, eqs. (66)-(68), (23),
// (4)-(5).
#include <algorithm>
#include <limits>

#include "derive/articulated_route.hpp"
#include "derive/deriver.hpp"

namespace anholon {

void Deriver::derive_free_dynamics() {
  if (!wanted("free_dynamics")) return;
  const State<Expr> state = symbols_.moving(full_velocity());
  const Matrix<Expr> M = dynamics_.mass_matrix(state);
  const std::vector<Expr> f = dynamics_.forces(state);
  const Partition p = partition_of(model_);
  const std::vector<int> eta = range(p.n);
  const std::vector<int> r_p(p.passive.begin() + p.n, p.passive.end());
  emit("free_dynamics",
       "Blocks of eq. (1) with lambda = 0 and tau_a = 0, by sweeps of the recursion (section V.B).",
       {{"unit sweeps",
         {block("M_eta_eta", "kg, kg m, kg m^2", "n x n", M.block(eta, eta)),
          block("M_p", "mixed", "s_p x n", M.block(r_p, eta)),
          block("M_a", "mixed", "s_a x n", M.block(p.active, eta)),
          block("m_pp", "mixed", "s_p x s_p", M.block(r_p, r_p)),
          block("m_pa", "mixed", "s_p x s_a", M.block(r_p, p.active)),
          block("m_aa", "mixed", "s_a x s_a", M.block(p.active, p.active)),
          block("f", "N, N m", "n", picked(f, eta)), block("Q_p", "N m or N", "s_p", picked(f, r_p)),
          block("Q_a", "N m or N", "s_a", picked(f, p.active))}}});
}

Deriver::ReducedDynamics Deriver::reduced_dynamics(const Reduced& of, const Matrix<Expr>& H,
                                                   const std::vector<Expr>& nu,
                                                   const std::vector<Expr>& r_a_dot,
                                                   const std::vector<Expr>& r_a_ddot,
                                                   const std::vector<Expr>& input_force, bool project) {
  const KinematicReduction& k = *of.reduction;
  const Partition& p = of.partition;
  ReducedDynamics d;
  tape_.section("admissible velocities");
  const std::vector<Expr> passive = k.velocities(r_a_dot, nu);
  d.velocity = merged(p, passive, r_a_dot);
  const State<Expr> state = symbols_.moving(d.velocity);
  std::vector<Expr> bias;
  if (!mechanism_.rows.empty()) bias = dynamics_.constraints(state).second;
  tape_.section("drift of the kernel");
  std::vector<Expr> gamma = k.drift(r_a_dot, nu, bias, symbols_.motion(d.velocity));
  const std::vector<Expr> imposed = k.kernel().J * r_a_ddot;
  for (std::size_t i = 0; i < gamma.size(); ++i) gamma[i] += imposed[i];
  d.bias_acceleration = merged(p, gamma, r_a_ddot);
  const Matrix<Expr> Ht = H.transposed();
  d.M_r = Matrix<Expr>(H.cols(), H.cols());
  if (project) {
    const std::vector<Expr> residual =
        picked(dynamics_.inverse_dynamics(state, d.bias_acceleration), p.passive);
    tape_.section("reduced forces");
    std::vector<Expr> force = input_force;
    for (std::size_t i = 0; i < force.size(); ++i) force[i] -= residual[i];
    d.f_r = Ht * force;
    for (int c = 0; c < H.cols(); ++c) {
      const std::vector<Expr> Mh = mass_times(p, state, column_of(H, c));
      tape_.section("reduced mass matrix");
      const std::vector<Expr> column = Ht * Mh;
      for (int i = c; i < H.cols(); ++i) d.M_r(i, c) = d.M_r(c, i) = column[static_cast<std::size_t>(i)];
    }
  } else {
    const Matrix<Expr> M = dynamics_.mass_matrix(state);
    const std::vector<Expr> f = dynamics_.forces(state);
    tape_.section("reduced mass matrix");
    d.M_r = Ht * (M.block(p.passive, p.passive) * H);  // (66)
    for (int i = 0; i < H.cols(); ++i) {
      for (int j = 0; j < i; ++j) d.M_r(j, i) = d.M_r(i, j);
    }
    tape_.section("reduced forces");
    std::vector<Expr> force = input_force;  // (68)
    const std::vector<Expr> carried = M.block(p.passive, p.passive) * gamma;
    const std::vector<Expr> driven = M.block(p.passive, p.active) * r_a_ddot;
    for (std::size_t i = 0; i < force.size(); ++i)
      force[i] += f[static_cast<std::size_t>(p.passive[i])] - driven[i] - carried[i];
    d.f_r = Ht * force;  // (67)
  }
  return d;
}

std::vector<Expr> Deriver::mass_times(const Partition& p, const State<Expr>& state,
                                      const std::vector<Expr>& passive) {
  const std::vector<Expr> at_rest(p.active.size(), Expr(0));
  return picked(dynamics_.mass_times(state, merged(p, passive, at_rest)), p.passive);
}

std::vector<Expr> Deriver::driving_force(const Partition& p) {
  std::vector<Expr> force = no_force(p);
  const Partition original = partition_of(model_);
  std::vector<std::size_t> driven;
  for (std::size_t i = 0; i < p.passive.size(); ++i) {
    if (std::ranges::find(original.active, p.passive[i]) != original.active.end()) driven.push_back(i);
  }
  if (driven.empty()) return force;
  const bool all = driven.size() == original.active.size();
  const auto tau = symbols_.block(all ? "tau_a" : "tau_d", static_cast<int>(driven.size()), "N m or N",
                                  "torques of the torque-driven coordinates");
  for (std::size_t i = 0; i < driven.size(); ++i) force[driven[i]] = tau[i];
  return force;
}

std::vector<Expr> Deriver::accelerations(const Reduced& of, const Matrix<Expr>& H, const ReducedDynamics& d,
                                         const std::vector<Expr>& nu_dot) {
  std::vector<Expr> v = d.bias_acceleration;
  const std::vector<Expr> h = H * nu_dot;
  for (std::size_t i = 0; i < h.size(); ++i) v[static_cast<std::size_t>(of.partition.passive[i])] += h[i];
  return v;
}

std::pair<std::vector<Expr>, std::vector<Expr>> Deriver::solved(const Reduced& of, const ReducedDynamics& d) {
  tape_.section("reduced accelerations");
  std::vector<Expr> nu_dot;
  if (of.k() > 0) nu_dot = solve_symmetric(d.M_r, {d.f_r}).front();
  tape_.section(&of == &motion_ ? "passive accelerations" : "accelerations");
  std::vector<Expr> v_dot = accelerations(of, of.reduction->kernel().H, d, nu_dot);
  return {std::move(nu_dot), std::move(v_dot)};
}

std::vector<OutputBlock> Deriver::acceleration_blocks(
    const Reduced& of, const std::string& nu,
    const std::pair<std::vector<Expr>, std::vector<Expr>>& solution) {
  const auto& [nu_dot, v_dot] = solution;
  std::vector<OutputBlock> outputs = {block(nu + "_dot", "mixed", "derivative of " + nu, nu_dot)};
  for (OutputBlock& b : split_passive(of.partition, picked(v_dot, of.partition.passive), "dot"))
    outputs.push_back(std::move(b));
  return outputs;
}

void Deriver::derive_reduced_dynamics() {
  const bool reduced = wanted("reduced_dynamics"), forward = wanted("forward_dynamics"),
             split = wanted("split_dynamics");
  if (!reduced && !forward && !split) return;
  std::vector<Route> reduced_routes, forward_routes, split_routes;
  const std::vector<Expr> force = driving_force(motion_partition_);
  for (const bool project : {true, false}) {
    const std::string name = project ? "projected recursion" : "all blocks, (66)-(68)";
    const ReducedDynamics d =
        reduced_dynamics(motion_, motion_.reduction->kernel().H, nu_, r_a_dot_, r_a_ddot_, force, project);
    reduced_routes.push_back(
        {name,
         {block("M_r", "mixed", "reduced mass matrix, symmetric positive definite", d.M_r),
          block("f_r", "mixed", "reduced forces", d.f_r)}});
    if (forward) forward_routes.push_back({name, acceleration_blocks(motion_, "nu", solved(motion_, d))});
    if (split) split_routes.push_back({name, split_blocks(d)});
  }
  if (reduced)
    emit("reduced_dynamics", "Reduced dynamics, eq. (23): M_r nu_dot = f_r, by (66)-(68).", reduced_routes);
  if (split)
    emit("split_dynamics",
         "Forward dynamics by blocks, eqs. (4)-(5), of external and internal reduced velocities.",
         split_routes);
  if (!forward) return;
  const bool replaced = replace_by_articulated_bodies(force, forward_routes);
  const auto accurate = [&] {
    return replaced ? std::vector<Route>() : accurate_routes(motion_, "nu", nu_, r_a_dot_, r_a_ddot_, force);
  };
  emit("forward_dynamics", "Forward dynamics of the passive degrees of freedom: eq. (23) solved, then (18).",
       forward_routes, replaced ? "the mass matrix would lose the digits of its small bodies" : "", !replaced,
       accurate);
}

bool Deriver::replace_by_articulated_bodies(const std::vector<Expr>& force, std::vector<Route>& routes) {
  constexpr double poor = 1e-10, gain = 1e-3;
  const Partition& p = motion_partition_;
  if (routes.empty() || !p.active.empty() || motion_.k() != static_cast<int>(p.passive.size())) return false;
  std::vector<NodeId> parameters;
  for (const ParameterInfo& info : program_.parameters) parameters.push_back(info.node);
  const auto rounding = [&](const Route& r) {
    return rounding_of(tape_, roots_of(r), parameters, defaults_);
  };
  double least = std::numeric_limits<double>::infinity();
  for (const Route& r : routes) least = std::min(least, rounding(r));
  if (least < poor) return false;  // before anything else is derived, so that other models stay as they are
  const std::vector<Expr> none;
  const State<Expr> state =
      symbols_.moving(merged(p, motion_.reduction->velocities(none, nu_), none));  // nu are velocities
  if (!is_rigid_tree(mechanism_, state)) return false;
  std::vector<Expr> torque(static_cast<std::size_t>(mechanism_.coordinates), Expr(0));
  for (std::size_t i = 0; i < p.passive.size(); ++i) {
    if (p.passive[i] >= p.n) torque[static_cast<std::size_t>(p.passive[i] - p.n)] = force[i];
  }
  const std::vector<Expr> v_dot = picked(articulated_accelerations(mechanism_, state, torque), p.passive);
  Route articulated{"articulated bodies", {block("nu_dot", "mixed", "derivative of nu", v_dot)}};
  for (OutputBlock& b : split_passive(p, v_dot, "dot")) articulated.outputs.push_back(std::move(b));
  if (!(rounding(articulated) < gain * least)) return false;
  routes = {std::move(articulated)};
  return true;
}

std::vector<OutputBlock> Deriver::split_blocks(const ReducedDynamics& d) {
  const Matrix<Expr>& H = motion_.reduction->kernel().H;
  std::vector<int> external, internal;
  for (int c = 0; c < H.cols(); ++c) {
    bool shape = false;
    for (int i = motion_partition_.n; i < H.rows(); ++i) shape = shape || !H(i, c).is_zero();
    (shape ? internal : external).push_back(c);
  }
  if (external.empty() || internal.empty()) return {};
  const auto e = [&](const std::vector<int>& i, const std::vector<int>& j) { return d.M_r.block(i, j); };
  const Matrix<Expr> M_pr = e(internal, external);
  const std::vector<Expr> f = picked(d.f_r, external);
  const std::vector<Expr> Q = picked(d.f_r, internal);
  std::vector<std::vector<Expr>> sides = {Q};
  for (std::size_t j = 0; j < external.size(); ++j) {
    sides.emplace_back();
    for (int i = 0; i < M_pr.rows(); ++i) sides.back().push_back(M_pr(i, static_cast<int>(j)));
  }
  tape_.section("modified blocks");
  const auto solved = solve_symmetric(e(internal, internal), sides);  // m_pp,r^-1 (Q, M_p,r)
  Matrix<Expr> coupling(M_pr.rows(), M_pr.cols());
  for (int i = 0; i < M_pr.rows(); ++i) {
    for (int j = 0; j < M_pr.cols(); ++j)
      coupling(i, j) = solved[static_cast<std::size_t>(1 + j)][static_cast<std::size_t>(i)];
  }
  const Matrix<Expr> M_tilde = e(external, external) - M_pr.transposed() * coupling;
  std::vector<Expr> F_tilde = f;
  const std::vector<Expr> shift = M_pr.transposed() * solved[0];
  for (std::size_t i = 0; i < F_tilde.size(); ++i) F_tilde[i] -= shift[i];
  const std::vector<Expr> nu_e_dot = solve_symmetric(M_tilde, {F_tilde}).front();
  std::vector<Expr> Q_tilde = Q;
  const std::vector<Expr> reaction = M_pr * nu_e_dot;
  for (std::size_t i = 0; i < Q_tilde.size(); ++i) Q_tilde[i] -= reaction[i];
  return {block("M_tilde_r", "mixed", "modified external mass matrix of (4)", M_tilde),
          block("F_tilde_r", "mixed", "modified external forces of (4)", F_tilde),
          block("m_pp_r", "mixed", "internal mass matrix of (5)", e(internal, internal)),
          block("Q_tilde_p_r", "mixed", "modified internal forces of (5)", Q_tilde)};
}

void Deriver::derive_energies() {
  if (!wanted("energies")) return;
  const auto e = dynamics_.energies(symbols_.moving(full_velocity()));
  emit("energies",
       "Kinetic energy, potential of gravity (zero at the world's origin), elastic and other potential "
       "energy; power lost and power of applied forces.",
       {{"recursion",
         {block("kinetic", "J", "kinetic energy", std::vector{e.kinetic}),
          block("gravity", "J", "potential of gravity", std::vector{e.gravity}),
          block("elastic", "J", "springs, modes and the described potential", std::vector{e.elastic}),
          block("dissipated_power", "W", "velocities times the gradient of the dissipation function",
                std::vector{e.dissipated_power}),
          block("applied_power", "W", "of the described forces and wrenches",
                std::vector{e.applied_power})}}});
}

}  // namespace anholon
