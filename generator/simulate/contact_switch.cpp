// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/contact_switch.hpp"

#include <cmath>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "reduce/decompositions.hpp"

namespace anholon {
namespace {

constexpr double singular_pivot = 1e-10;  // relative: between rounding and pivots of regular configurations

/// All velocities (n + s) of a state.
Eigen::VectorXd velocities_of(const Model& model, const State<double>& state) {
  const auto components = free_components(model.group);
  Eigen::VectorXd v(static_cast<Eigen::Index>(components.size() + state.r_dot.size()));
  Eigen::Index next = 0;
  for (const int c : components) v(next++) = state.eta[c];
  for (const double rate : state.r_dot) v(next++) = rate;
  return v;
}

}  // namespace

VelocityJump velocity_jump(const Model& model, const Partition& partition, const State<double>& state) {
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), parameters);
  FreeDynamics<double> dynamics(mechanism);
  const std::vector<int>&p = partition.passive, &a = partition.active;
  const Matrix<double> all = dynamics.mass_matrix(state);
  const Eigen::MatrixXd M = to_eigen(all.block(p, p)), M_ap = to_eigen(all.block(a, p));
  const Matrix<double> rows = dynamics.constraints(state).first;
  std::vector<int> every(static_cast<std::size_t>(rows.rows()));
  for (std::size_t i = 0; i < every.size(); ++i) every[i] = static_cast<int>(i);
  const Eigen::MatrixXd A = to_eigen(rows.block(every, p)), B = to_eigen(rows.block(every, a));
  const Eigen::VectorXd v = velocities_of(model, state);
  const Eigen::VectorXd before = v(p), active = v(a);

  if (A.rows() == 0) return {before, {}, 0, 0, 0};  // nothing holds: nothing changes
  const auto solution =
      solve_constrained<double>(M, M * before, A, Eigen::VectorXd(B * active), singular_pivot);
  VelocityJump jump;
  jump.velocities = solution.acceleration;
  jump.impulses = solution.multipliers;
  const Eigen::VectorXd d = jump.velocities - before;
  jump.lost = 0.5 * d.dot(M * d);
  jump.work = (M_ap * d - B.transpose() * jump.impulses).dot(active);
  const double kinetic = 0.5 * v.dot(to_eigen(all) * v);
  jump.relative = jump.lost > 0 ? std::sqrt(jump.lost / std::max(kinetic, jump.lost)) : 0;
  return jump;
}

State<double> state_of(const SceneProgram& program, Runner<double>& run) {
  const Buffers<double>& b = run.b;
  const Partition& p = program.original;
  State<double> s;
  s.t = b.t[0];
  for (std::size_t i = 0; i < 9; ++i) s.R.m[i] = b.R[i];
  const auto components = free_components(program.model.group);
  if (program.model.group == GroupKind::SE2) s.p[0] = b.g[0], s.p[1] = b.g[1];
  for (std::size_t i = 0; i < b.p.size(); ++i) s.p[static_cast<int>(i)] = b.p[i];
  for (std::size_t i = 0; i < b.eta.size(); ++i) s.eta[components[i]] = b.eta[i];
  s.r.assign(program.model.coordinates.size(), 0), s.r_dot = s.r;
  const auto at = [&](int velocity) { return static_cast<std::size_t>(velocity - p.n); };
  for (std::size_t i = 0; i < b.r_p.size(); ++i) {
    const std::size_t c = at(p.passive[static_cast<std::size_t>(p.n) + i]);
    s.r[c] = b.r_p[i], s.r_dot[c] = b.r_p_dot[i];
  }
  std::size_t motion = 0, driven = 0;
  for (std::size_t i = 0; i < p.active.size(); ++i) {
    const bool is_driven = std::ranges::find(program.driven, p.active[i]) != program.driven.end();
    s.r[at(p.active[i])] = b.r_a[i];
    s.r_dot[at(p.active[i])] = is_driven ? b.r_d_dot[driven++] : b.r_a_dot[motion++];
  }
  return s;
}

void take_velocities(const SceneProgram& program, Runner<double>& run, const Eigen::VectorXd& passive) {
  const Eigen::Index n = program.reduced.n, s_p = program.original.s_p();
  for (Eigen::Index i = 0; i < passive.size(); ++i) {
    if (i < n) {
      run.b.eta[static_cast<std::size_t>(i)] = passive(i);
    } else if (i < n + s_p) {
      run.b.r_p_dot[static_cast<std::size_t>(i - n)] = passive(i);
    } else {
      run.b.r_d_dot[static_cast<std::size_t>(i - n - s_p)] = passive(i);
    }
  }
  if (run.reduced_velocities) run.reduced_velocities();
}

}  // namespace anholon
