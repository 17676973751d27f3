// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The functions of a scene, bound to one set of buffers, and the field of its reduced dynamics.

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "simulate/bound_call.hpp"
#include "simulate/buffers.hpp"
#include "simulate/scene_program.hpp"
#include "simulate/table_motion.hpp"

namespace anholon {

/// y = (r_p, r_d, nu), then work and dissipated energy where y has room for them.
template <class S>
class Runner {
 public:
  template <class Code>
  Runner(const Scene& scene, const SceneProgram& program, const Code& code)
      : program_(program), k_(program.derivation->reduction.kernel.H.cols()) {
    const std::size_t active = program.reduced.active.size();
    b.t.resize(1), b.g.resize(3), b.R.resize(9), b.p.resize(positions(program.model.group));
    b.r_p.resize(static_cast<std::size_t>(program.original.s_p())),
        b.r_a.resize(program.original.active.size());
    for (auto* v : {&b.r_a_dot, &b.r_a_ddot, &b.r_m, &b.r_m_dot, &b.r_m_ddot}) v->resize(active);
    b.nu.resize(static_cast<std::size_t>(k_)), b.nu_dot.resize(static_cast<std::size_t>(k_));
    b.eta.resize(static_cast<std::size_t>(program.original.n)), b.r_p_dot.resize(b.r_p.size());
    b.r_d_dot.resize(program.driven.size()), b.torque.resize(program.driven.size()),
        b.tau_d.resize(program.driven.size());
    b.dissipated_power.resize(1), b.applied_power.resize(1), b.kinetic.resize(1), b.gravity.resize(1),
        b.elastic.resize(1);
    for (std::size_t i = 0; i < program.original.active.size(); ++i) {
      const bool driven =
          std::ranges::find(program.driven, program.original.active[i]) != program.driven.end();
      (driven ? driven_at_ : motion_at_).push_back(i);
    }
    imposed = bound(code, "imposed", b), imposed_torque = bound(code, "imposed_torque", b),
    rates = bound(code, "rates", b), kinematics = bound(code, "kinematics", b),
    torques = bound(code, "inverse_torques", b);
    multipliers = bound(code, "multipliers", b), constraints = bound(code, "constraints", b),
    energies = bound(code, "energies", b);
    reduced_velocities = bound(code, "reduced_velocities", b),
    compatibility = bound(code, "compatibility", b);
    position_conditions = bound(code, "position_conditions", b);
    if (scene.motion_table) table_.emplace(scene, program);
  }

  /// Imposed motion at t.
  void impose(S t) {
    b.t[0] = t;
    if (imposed) imposed();
    if (table_) (*table_)(t, b);
    for (std::size_t i = 0; i < motion_at_.size(); ++i)
      b.r_a[motion_at_[i]] = b.r_m[i], b.r_a_dot[i] = b.r_m_dot[i], b.r_a_ddot[i] = b.r_m_ddot[i];
  }

  /// Pose, shape and reduced velocities, and the torques that follow from them. Needs impose().
  template <class G, class Vector>
  void set(const G& g, const Vector& y) {
    const auto R = g.R();
    const auto p = g.p();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) b.R[static_cast<std::size_t>(3 * i + j)] = R(i, j);
    }
    for (std::size_t i = 0; i < b.p.size(); ++i) b.p[i] = p(static_cast<Eigen::Index>(i));
    if constexpr (requires { g.theta(); }) b.g[0] = g.x(), b.g[1] = g.y(), b.g[2] = g.theta();
    Eigen::Index next = 0;
    for (S& x : b.r_p) x = y(next++);
    for (const std::size_t i : driven_at_) b.r_a[i] = y(next++);
    for (S& x : b.nu) x = y(next++);
    if (!imposed_torque) return;
    imposed_torque();
    std::vector<S>& tau = motion_at_.empty() ? b.tau_a : b.tau_d;
    for (std::size_t i = 0; i < driven_at_.size(); ++i) tau[i] = b.torque[i];
  }

  /// Torque-driven coordinates, in the order of y.
  [[nodiscard]] std::vector<S> driven_coordinates() const {
    std::vector<S> r_d;
    for (const std::size_t i : driven_at_) r_d.push_back(b.r_a[i]);
    return r_d;
  }

  /// Size of y without quadratures.
  [[nodiscard]] int size() const { return static_cast<int>(b.r_p.size() + driven_at_.size()) + k_; }

  template <class G, class Vector, class Tangent>
  void field(S t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) {
    ++evaluations;
    impose(t);
    set(g, y);
    if (rates) rates();
    eta.setZero();  // translations are those of space, of which a group may leave fewer
    for (std::size_t i = 0; i < b.eta.size(); ++i) eta(static_cast<Eigen::Index>(i)) = b.eta[i];
    Eigen::Index next = 0;
    for (const S& x : b.r_p_dot) y_dot(next++) = x;
    for (const S& x : b.r_d_dot) y_dot(next++) = x;
    for (const S& x : b.nu_dot) y_dot(next++) = x;
    if (y.size() == next) return;
    if (energies) energies();
    y_dot(next++) = power() + b.applied_power[0];
    y_dot(next) = b.dissipated_power[0];
  }

  /// The field as a function object, for integration in groups of the same scalar.
  template <class G>
  auto field_of() {
    return
        [this](S t, const G& g, const auto& y, auto& eta, auto& y_dot) { this->field(t, g, y, eta, y_dot); };
  }

  /// Power of imposed and computed torques, after rates().
  S power() {
    S sum = S(0);
    if (torques) {
      torques();
      for (std::size_t i = 0; i < b.r_a_dot.size(); ++i) sum += b.tau_a[i] * b.r_a_dot[i];
    }
    for (std::size_t i = 0; i < b.r_d_dot.size(); ++i) sum += b.torque[i] * b.r_d_dot[i];
    return sum;
  }

  Buffers<S> b;
  Call imposed, imposed_torque, rates, kinematics, torques, multipliers, constraints, energies,
      reduced_velocities, compatibility, position_conditions;
  long evaluations = 0;

 private:
  /// Components of the position that a program takes: those that the group leaves free, none of a planar
  /// pose.
  static std::size_t positions(GroupKind group) {
    const auto components = free_components(group);
    return group == GroupKind::SE2
               ? 0
               : static_cast<std::size_t>(std::ranges::count_if(components, [](int c) { return c < 3; }));
  }

  const SceneProgram& program_;
  int k_;
  std::vector<std::size_t> motion_at_, driven_at_;  // positions in r_a
  std::optional<TableMotion<S>> table_;
};

}  // namespace anholon
