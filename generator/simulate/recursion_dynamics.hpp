// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The same motion without generated dynamics: full passive velocities as the state, accelerations by the
// numeric recursion and the numeric reduction at every step. Slower, and independent of kernel basis and
// optimiser.

#include <Eigen/Core>
#include <vector>

#include "anholon/free_dynamics.hpp"
#include "anholon/integrate/result.hpp"
#include "simulate/runner.hpp"

namespace anholon {

/// y = (r_p, r_d, then all passive velocities: eta, r_p_dot, r_d_dot).
class RecursionDynamics {
 public:
  /// @param run  for imposed motions and torques, and to translate nu into velocities
  RecursionDynamics(const SceneProgram& program, Runner<double>& run);

  /// The state that a state (r_p, r_d, nu) means.
  template <class G>
  integrate::State<G> expanded(const integrate::State<G>& reduced) {
    if (run_.kinematics) run_.kinematics();
    integrate::State<G> state{reduced.t, reduced.g, Eigen::VectorXd::Zero(shape_ + passive_)};
    state.y.head(shape_) = reduced.y.head(shape_);
    state.y.tail(passive_) = velocities_of_buffers();
    return state;
  }

  /// Back to (r_p, r_d, nu).
  template <class G>
  integrate::State<G> reduced(const integrate::State<G>& state) {
    integrate::State<G> result{state.t, state.g, Eigen::VectorXd::Zero(run_.size())};
    for (Eigen::Index i = 0; i < passive_; ++i) set_velocity(i, state.y(shape_ + i));
    run_.impose(state.t);
    result.y.head(shape_) = state.y.head(shape_);
    run_.set(state.g, result.y);
    if (run_.reduced_velocities) run_.reduced_velocities();
    for (std::size_t i = 0; i < run_.b.nu.size(); ++i)
      result.y(shape_ + static_cast<Eigen::Index>(i)) = run_.b.nu[i];
    return result;
  }

  /// The field of an integrator.
  template <class G, class Vector, class Tangent>
  void operator()(double t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) {
    run_.impose(t);
    reduced_y_.head(shape_) = y.head(shape_);
    for (Eigen::Index i = 0; i < passive_; ++i) set_velocity(i, y(shape_ + i));
    if (run_.imposed_torque && run_.reduced_velocities)
      run_.reduced_velocities();  // torques may depend on velocities
    for (std::size_t i = 0; i < run_.b.nu.size(); ++i)
      reduced_y_(shape_ + static_cast<Eigen::Index>(i)) = run_.b.nu[i];
    run_.set(g, reduced_y_);
    State<double> state;
    const auto R = g.R();
    const auto p = g.p();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) state.R(i, j) = R(i, j);
      state.p[i] = p(i);
    }
    state.t = t;
    rates(state, y, y_dot);
    eta.setZero();
    for (int i = 0; i < program_.reduced.n; ++i) eta(i) = y(shape_ + i);
  }

 private:
  [[nodiscard]] Eigen::VectorXd velocities_of_buffers() const;
  void set_velocity(Eigen::Index passive, double rate);
  /// @param state  pose and time; imposed motions and torques come from the buffers
  void rates(State<double>& state, const Eigen::VectorXd& y, Eigen::VectorXd& y_dot);

  const SceneProgram& program_;
  Runner<double>& run_;
  Mechanism<double> mechanism_;
  FreeDynamics<double> dynamics_;
  Eigen::Index shape_, passive_;  // sizes of (r_p, r_d) and of the passive velocities
  Eigen::VectorXd reduced_y_;
};

}  // namespace anholon
