// SPDX-License-Identifier: MIT
//
// Runge-Kutta-Munthe-Kaas integration of
//
//   g_dot = g eta(t, g, y),     y_dot = f(t, g, y),     g in a Lie group, y a vector.
//
// On each step g = g_0 exp(theta), and the tableau is applied to the ordinary differential equation
//
//   theta_dot = dexp^-1_{-theta}(eta(t, g_0 exp(theta), y)),   theta(t_0) = 0;     y_dot = f            (1)
//
// with dexp^-1 in closed form, not truncated: the order is that of the tableau, whatever the group.
// Munthe-Kaas 1999, "High order Runge-Kutta methods on manifolds", Appl. Numer. Math. 29.
//
// A field is any callable
//
//   field(Real t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot)
//
// which writes every entry of eta (dim; body axes, linear part first) and of y_dot (n_y; it comes sized).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <utility>

#include "anholon/integrate/result.hpp"
#include "anholon/integrate/tableau.hpp"
#include "anholon/lie/lie_group.hpp"

namespace anholon::integrate {

/// The stages of one step; also the only memory an integration needs. Make one, use it for many integrations.
template <lie::LieGroup G, template <class> class TableauOf>
class RkmkStages {
 public:
  using Group = G;
  using Real = typename G::Scalar;
  using Tableau = TableauOf<Real>;
  using Tangent = typename G::Tangent;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  static constexpr int stages = Tableau::stages;
  /// Stages that only the continuous solution takes.
  static constexpr int dense_stages = [] {
    if constexpr (requires { Tableau::dense_stages; }) return Tableau::dense_stages;
    return 0;
  }();

  /// Allocates; nothing else here does.
  /// @param size_y  number of components of y
  explicit RkmkStages(Eigen::Index size_y)
      : y_begin_(size_y),
        y_end_(size_y),
        y_stage_(size_y),
        y_sum_(size_y),
        carry_(size_y),
        carry_end_(size_y) {
    for (Vector& rate : y_rate_) rate = Vector::Zero(size_y);
    carry_.setZero();
  }

  Eigen::Index size_y() const { return y_begin_.size(); }

  /// Starts an integration: evaluates the field at the state. False if the state or the field is not finite.
  template <class Field>
  bool start(Field&& field, const State<G>& state) {
    t_begin_ = state.t;
    g_begin_ = state.g;
    y_begin_ = state.y;
    carry_.setZero();
    evaluations_of_completion_ = 0;
    if (!state.g.is_finite() || !state.y.allFinite()) return false;
    return evaluate_first(field);
  }

  /// Evaluates the field after an Euler step h from the current state, into slot 1 of the rates.
  template <class Field>
  void probe(Field&& field, Real h) {
    y_stage_ = y_begin_ + h * y_rate_[0];
    field(t_begin_ + h, g_begin_ * G::exp(h * theta_rate_[0]), std::as_const(y_stage_), theta_rate_[1],
          y_rate_[1]);
  }

  /// Evaluates the remaining stages of a step h from the current state and forms its end point.
  /// The current state stays as it was, so that a rejected step may be tried again with another h.
  template <class Field>
  void advance(Field&& field, Real h) {
    h_ = h;
    largest_turn_ = Real(0);
    completed_ = false;
    for (int i = 1; i < stages; ++i) {
      sum_rates(Tableau::a[i]);
      theta_sum_ *= h;
      note_turn(theta_sum_);
      y_stage_ = y_begin_ + h * y_sum_;
      Tangent eta;
      field(t_begin_ + Tableau::c[i] * h, g_begin_ * G::exp(theta_sum_), std::as_const(y_stage_), eta,
            y_rate_[i]);
      theta_rate_[i] = G::dexp_inv(theta_sum_, eta);  // (1)
      if constexpr (Tableau::first_same_as_last) eta_end_ = eta;
    }
    if constexpr (!Tableau::first_same_as_last) {  // else the last stage has summed b already
      sum_rates(Tableau::b);
      theta_sum_ *= h;
      note_turn(theta_sum_);
    }
    g_end_ = g_begin_ * G::exp(theta_sum_);
    g_end_.normalize();  // removes rounding only: the order is not touched
    // Kahan's sum: the part of the increment that rounding took off y_end is given back on the next step.
    y_sum_ = h * y_sum_ - carry_;
    y_end_ = y_begin_ + y_sum_;
    carry_end_ = (y_end_ - y_begin_) - y_sum_;
  }

  /// Evaluates the stages of the continuous solution, unless they are there already; after advance().
  template <class Field>
  void complete(Field& field) requires(dense_stages > 0) {
    if (completed_) return;
    completed_ = true;
    evaluations_of_completion_ += dense_stages;
    for (int i = stages; i < stages + dense_stages; ++i) {
      sum_rates(Tableau::a_dense[i - stages]);
      theta_sum_ *= h_;
      y_stage_ = y_begin_ + h_ * y_sum_;
      Tangent eta;
      field(t_begin_ + Tableau::c[i] * h_, g_begin_ * G::exp(theta_sum_), std::as_const(y_stage_), eta,
            y_rate_[i]);
      theta_rate_[i] = G::dexp_inv(theta_sum_, eta);
    }
  }
  /// Calls of the field that the continuous solution has made since start().
  long evaluations_of_completion() const { return evaluations_of_completion_; }

  /// Makes the end point the current state and evaluates the first stage there, or reuses the last one where
  /// the tableau allows it. False if the field is not finite. A field that has `bool correct(Real t, G& g,
  /// Vector& y)` may move the state back onto conditions that the motion keeps; it returns whether it did.
  /// @param t_end  time of the end point, from the caller, who knows it without the rounding of a sum
  template <class Field>
  bool commit(Field&& field, Real t_end) {
    t_begin_ = t_end;
    g_begin_ = g_end_;
    y_begin_.swap(y_end_);
    carry_.swap(carry_end_);
    if constexpr (requires { field.correct(t_begin_, g_begin_, y_begin_); }) {
      if (field.correct(t_begin_, g_begin_, y_begin_)) {
        carry_.setZero();
        return evaluate_first(field);
      }
    }
    if constexpr (Tableau::first_same_as_last) {
      theta_rate_[0] = eta_end_;  // theta = 0 on the next step, where dexp^-1 is the identity
      y_rate_[0].swap(y_rate_[stages - 1]);
      return true;
    } else {
      return evaluate_first(field);
    }
  }

  /// Calls of the field that advance() and commit() make together.
  static constexpr int evaluations_per_step = Tableau::first_same_as_last ? stages - 1 : stages;

  bool end_is_finite() const { return g_end_.is_finite() && y_end_.allFinite(); }

  void copy_current_to(State<G>& state) const {
    state.t = t_begin_;
    state.g = g_begin_;
    state.y = y_begin_;
  }

  Real t_begin() const { return t_begin_; }
  Real h() const { return h_; }
  const G& g_begin() const { return g_begin_; }
  const G& g_end() const { return g_end_; }
  const Vector& y_begin() const { return y_begin_; }
  const Vector& y_end() const { return y_end_; }
  const Tangent& theta_rate(int i) const { return theta_rate_[i]; }  ///< (1) at stage i
  const Vector& y_rate(int i) const { return y_rate_[i]; }           ///< y_dot at stage i
  Real largest_turn() const {
    return largest_turn_;
  }  ///< largest angle of theta over the step's stages [rad]

  /// Room for one vector y that observers and error estimates may use between advance() and commit().
  Vector& scratch_y() { return y_stage_; }

 private:
  template <class Field>
  bool evaluate_first(Field&& field) {
    field(t_begin_, std::as_const(g_begin_), std::as_const(y_begin_), theta_rate_[0], y_rate_[0]);
    return theta_rate_[0].allFinite() && y_rate_[0].allFinite();
  }

  template <std::size_t n>
  void sum_rates(const std::array<Real, n>& weights) {
    theta_sum_.setZero();
    y_sum_.setZero();
    for (std::size_t j = 0; j < n; ++j) {
      if (weights[j] == Real(0)) continue;
      theta_sum_ += weights[j] * theta_rate_[j];
      y_sum_ += weights[j] * y_rate_[j];
    }
  }

  void note_turn(const Tangent& theta) {
    if constexpr (G::linear_dim < G::dim) {
      const Real turn = theta.template tail<G::dim - G::linear_dim>().norm();
      if (!(turn <= largest_turn_)) largest_turn_ = turn;
    }
  }

  Real t_begin_ = Real(0), h_ = Real(0), largest_turn_ = Real(0);
  bool completed_ = false;
  long evaluations_of_completion_ = 0;
  G g_begin_, g_end_;
  Tangent theta_sum_, eta_end_;
  std::array<Tangent, stages + dense_stages> theta_rate_;
  std::array<Vector, stages + dense_stages> y_rate_;
  Vector y_begin_, y_end_, y_stage_, y_sum_, carry_, carry_end_;
};

/// What makes steps of a size that is given: RkmkStages, Cf4Stages.
template <class Stages>
concept FixedStages = requires(Stages& stages) {
  typename Stages::Group;
  Stages::evaluations_per_step;
  { stages.end_is_finite() } -> std::convertible_to<bool>;
};

/// Integrates with `steps` equal steps from state.t to t_end (which may lie before it).
///
/// @param stages    workspace; its size_y() must be state.y.size()
/// @param field     see the head of this file
/// @param state     in: initial; out: at the last accepted step
/// @param steps     > 0
/// @param observer  called after each step as observer(Real t, const G& g, const Vector& y)
template <FixedStages Stages, class Field, class Observer>
Result<typename Stages::Real> integrate_fixed(Stages& stages, Field&& field,
                                              State<typename Stages::Group>& state,
                                              typename Stages::Real t_end, long steps, Observer&& observer) {
  using Real = typename Stages::Real;
  eigen_assert(stages.size_y() == state.y.size());
  eigen_assert(steps > 0);
  Result<Real> result;
  const Real t_begin = state.t;
  const Real h = (t_end - t_begin) / Real(steps);
  result.next_step = h;
  result.evaluations = 1;
  if (!stages.start(field, state)) {
    result.status = Status::non_finite;
    return result;
  }
  for (long step = 1; step <= steps; ++step) {
    stages.advance(field, h);
    result.evaluations += Stages::stages - 1;
    if (!stages.end_is_finite()) {
      result.status = Status::non_finite;
      break;
    }
    if (stages.largest_turn() > largest_turn_in_a_step<Real>) {
      result.status = Status::turned_too_far;
      break;
    }
    ++result.accepted_steps;
    const Real t = step == steps ? t_end : t_begin + Real(step) * h;  // not a running sum
    observer(t, stages.g_end(), stages.y_end());
    const bool finite = stages.commit(field, t);
    result.evaluations += Stages::evaluations_per_step - Stages::stages + 1;  // 0 or 1
    if (!finite) {
      result.status = Status::non_finite;
      break;
    }
  }
  stages.copy_current_to(state);
  return result;
}

/// The same without an observer.
template <FixedStages Stages, class Field>
Result<typename Stages::Real> integrate_fixed(Stages& stages, Field&& field,
                                              State<typename Stages::Group>& state,
                                              typename Stages::Real t_end, long steps) {
  return integrate_fixed(stages, field, state, t_end, steps, [](auto&&...) {});
}

/// RKMK4: the workspace of the classical method.
template <class G>
using Rkmk4 = RkmkStages<G, ClassicalRungeKutta4>;

}  // namespace anholon::integrate
