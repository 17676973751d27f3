// SPDX-License-Identifier: MIT
//
// What an integrator takes in and hands back: the state, and how the integration ended.
#pragma once

#include <Eigen/Core>

namespace anholon::integrate {

/// State of motion: a pose in a Lie group and a vector of anything else that is integrated (internal
/// coordinates r_p, reduced velocities nu, imposed coordinates r_a, quadratures such as work).
template <class G>
struct State {
  using Real = typename G::Scalar;
  Real t = Real(0);                          ///< time [s]
  G g = G::identity();                       ///< pose of B_0 in the world
  Eigen::Matrix<Real, Eigen::Dynamic, 1> y;  ///< (n_y), any size, 0 included
};

/// Half a turn: steps that turn further are refused, since dexp^-1 has its pole at a whole turn.
template <class Real>
inline constexpr Real largest_turn_in_a_step = Real(3.1415926535897932385L);

enum class Status {
  ok,              ///< the end time was reached
  step_too_small,  ///< the tolerance asks for steps below the resolution of t: a singularity, or too tight a
                   ///< tolerance
  too_many_steps,  ///< the limit on attempted steps was reached
  non_finite,      ///< the field, or the state, is infinite or not a number
  turned_too_far,  ///< a fixed step turned the body by more than pi, beyond the chart that exp gives
};

/// For messages.
constexpr const char* name(Status status) noexcept {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::step_too_small:
      return "step too small";
    case Status::too_many_steps:
      return "too many steps";
    case Status::non_finite:
      return "non-finite value";
    case Status::turned_too_far:
      return "turned by more than pi in one step";
  }
  return "unknown";
}

/// How an integration ended. Whatever the status, the state is that of the last accepted step.
template <class Real>
struct Result {
  Status status = Status::ok;
  long accepted_steps = 0;
  long rejected_steps = 0;
  long evaluations = 0;      ///< calls of the field
  long jacobians = 0;        ///< calls of its derivative (rosenbrock.hpp only)
  Real next_step = Real(0);  ///< step [s] with which a continuation may start (adaptive only)

  explicit operator bool() const { return status == Status::ok; }
};

}  // namespace anholon::integrate
