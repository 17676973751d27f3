// SPDX-License-Identifier: MIT
//
// Stiff integration on a Lie group: a Rosenbrock-Wanner method, linearly implicit and L-stable, for
//
//   g_dot = g eta(t, g, y),     y_dot = f(t, g, y),
//
// in the canonical coordinates of each step, g = g_0 exp(theta), where theta(t_0) = 0 and
//
//   theta_dot = dexp^-1_{-theta}(eta(t, g_0 exp(theta), y)) = eta + 1/2 [theta, eta] + ...               (1)
//
// (rkmk.hpp). What such a method needs of the field at the beginning of a step is its exact Jacobian in these
// coordinates. With F the derivative of (eta, y_dot) along twists of g in body axes and along y, that of (1)
// at theta = 0 is F with -1/2 ad_eta added to its block (theta, theta): nothing else of the group enters, and
// the order is that of the tableau. Fast components cost no steps, whether they decay or oscillate.
//
// A field is a callable as in rkmk.hpp that has also
//
//   field.jacobian(Real t, const G& g, const Vector& y, Matrix& F, Vector& F_t)
//
// which writes F (dim + n_y, dim + n_y; rows eta, y_dot; columns twist of g in body axes, y), every entry,
// and F_t (dim + n_y), the derivative by t alone. It is called right behind the field at the same state.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "anholon/integrate/result.hpp"
#include "anholon/integrate/rosenbrock_tableau.hpp"
#include "anholon/integrate/step_control.hpp"
#include "anholon/lie/lie_group.hpp"

namespace anholon::integrate {

/// The stages of one step; also the only memory an integration needs. Make one, use it for many integrations.
template <lie::LieGroup G, template <class> class TableauOf = Rodas5P>
class RosenbrockStages {
 public:
  using Real = typename G::Scalar;
  using Tableau = TableauOf<Real>;
  using Tangent = typename G::Tangent;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  static constexpr int stages = Tableau::stages;

  /// Allocates; nothing else here does.
  /// @param size_y  number of components of y
  explicit RosenbrockStages(Eigen::Index size_y)
      : y_begin_(size_y),
        y_end_(size_y),
        y_stage_(size_y),
        y_rate_(size_y),
        y_rate_begin_(size_y),
        carry_(size_y),
        carry_end_(size_y),
        sum_(G::dim + size_y),
        F_t_(G::dim + size_y),
        F_(G::dim + size_y, G::dim + size_y),
        W_(G::dim + size_y, G::dim + size_y),
        u_(G::dim + size_y, stages),
        factors_(G::dim + size_y) {
    carry_.setZero();
    u_.setZero();
  }

  Eigen::Index size_y() const { return y_begin_.size(); }

  /// Starts an integration: evaluates the field and its Jacobian at the state. False if the state or the
  /// field is not finite.
  template <class Field>
  bool start(Field&& field, const State<G>& state) {
    t_begin_ = state.t;
    g_begin_ = state.g;
    y_begin_ = state.y;
    carry_.setZero();
    if (!state.g.is_finite() || !state.y.allFinite()) return false;
    return evaluate_first(field);
  }

  /// Computes the stages of a step h from the current state and forms its end point. The current state stays
  /// as it was, so that a rejected step may be tried again with another h: with the same Jacobian, factored
  /// anew.
  template <class Field>
  void advance(Field&& field, Real h) {
    h_ = h;
    largest_turn_ = Real(0);
    W_ = -F_;
    W_.diagonal().array() += Real(1) / (Tableau::gamma * h);
    if (W_.rows() > 0) factors_.compute(W_);
    for (int i = 0; i < stages; ++i) {
      if (i > 0) {
        sum(Tableau::a[i], i);
        const Tangent theta = sum_.template head<G::dim>();
        note_turn(theta);
        y_stage_ = y_begin_ + sum_.tail(size_y());
        Tangent eta;
        field(t_begin_ + Tableau::alpha[i] * h, g_begin_ * G::exp(theta), std::as_const(y_stage_), eta,
              y_rate_);
        theta_rate_ = G::dexp_inv(theta, eta);  // (1)
      } else {
        theta_rate_ = eta_begin_;
        y_rate_ = y_rate_begin_;
      }
      sum(Tableau::c[i], i);
      sum_ = sum_ / h + (Tableau::gamma_sum[i] * h) * F_t_;
      sum_.template head<G::dim>() += theta_rate_;
      sum_.tail(size_y()) += y_rate_;
      if (W_.rows() > 0) u_.col(i) = factors_.solve(sum_);
    }
    sum(Tableau::b, stages);
    const Tangent theta = sum_.template head<G::dim>();
    note_turn(theta);
    g_end_ = g_begin_ * G::exp(theta);
    g_end_.normalize();  // removes rounding only: the order is not touched
    // Kahan's sum: the part of the increment that rounding took off y_end is given back on the next step.
    y_stage_ = sum_.tail(size_y()) - carry_;
    y_end_ = y_begin_ + y_stage_;
    carry_end_ = (y_end_ - y_begin_) - y_stage_;
  }

  /// Makes the end point the current state and evaluates the field and its Jacobian there. False if they are
  /// not finite. A field that has `bool correct(Real t, G& g, Vector& y)` may move the state back onto
  /// conditions that the motion keeps; it returns whether it did.
  /// @param t_end  time of the end point, from the caller, who knows it without the rounding of a sum
  template <class Field>
  bool commit(Field&& field, Real t_end) {
    t_begin_ = t_end;
    g_begin_ = g_end_;
    y_begin_.swap(y_end_);
    carry_.swap(carry_end_);
    if constexpr (requires { field.correct(t_begin_, g_begin_, y_begin_); }) {
      if (field.correct(t_begin_, g_begin_, y_begin_)) carry_.setZero();
    }
    return evaluate_first(field);
  }

  bool end_is_finite() const { return g_end_.is_finite() && y_end_.allFinite(); }

  void copy_current_to(State<G>& state) const {
    state.t = t_begin_;
    state.g = g_begin_;
    state.y = y_begin_;
  }

  /// sum_j weights_j u_j, for error estimates and continuous output.
  void combine(const std::array<Real, stages>& weights, Tangent& theta, Vector& y) const {
    theta.setZero();
    y.setZero();
    for (int j = 0; j < stages; ++j) {
      if (weights[j] == Real(0)) continue;
      theta += weights[j] * u_.col(j).template head<G::dim>();
      y += weights[j] * u_.col(j).tail(size_y());
    }
  }

  Real t_begin() const { return t_begin_; }
  Real h() const { return h_; }
  const G& g_begin() const { return g_begin_; }
  const G& g_end() const { return g_end_; }
  const Vector& y_begin() const { return y_begin_; }
  const Vector& y_end() const { return y_end_; }
  const Tangent& theta_rate_begin() const { return eta_begin_; }  ///< (1) at the current state
  const Vector& y_rate_begin() const { return y_rate_begin_; }    ///< y_dot there
  Real largest_turn() const {
    return largest_turn_;
  }  ///< largest angle of theta over the step's stages [rad]
  /// The Jacobian at the current state, in the canonical coordinates of a step (dim + n_y, dim + n_y).
  const Matrix& jacobian() const { return F_; }

  /// Second derivatives of (theta, y) at the current state, along the motion.
  void second_rates(Tangent& theta, Vector& y) {
    sum_.template head<G::dim>() = eta_begin_;
    sum_.tail(size_y()) = y_rate_begin_;
    theta = F_.template topRows<G::dim>() * sum_ + F_t_.template head<G::dim>();
    y.noalias() = F_.bottomRows(size_y()) * sum_;
    y += F_t_.tail(size_y());
  }

  /// Room for one vector y that observers and error estimates may use between advance() and commit().
  Vector& scratch_y() { return y_stage_; }

 private:
  template <class Field>
  bool evaluate_first(Field&& field) {
    field(t_begin_, std::as_const(g_begin_), std::as_const(y_begin_), eta_begin_, y_rate_begin_);
    field.jacobian(t_begin_, std::as_const(g_begin_), std::as_const(y_begin_), F_, F_t_);
    for (int j = 0; j < G::dim; ++j)  // d/dtheta_j of 1/2 [theta, eta]
      F_.col(j).template head<G::dim>() += G::bracket(Tangent::Unit(j), eta_begin_) / 2;
    return eta_begin_.allFinite() && y_rate_begin_.allFinite() && F_.allFinite() && F_t_.allFinite();
  }

  /// sum_ = sum over the first `count` stages.
  void sum(const std::array<Real, stages>& weights, int count) {
    sum_.setZero();
    for (int j = 0; j < count; ++j) {
      if (weights[j] != Real(0)) sum_ += weights[j] * u_.col(j);
    }
  }

  void note_turn(const Tangent& theta) {
    if constexpr (G::linear_dim < G::dim) {
      const Real turn = theta.template tail<G::dim - G::linear_dim>().norm();
      if (!(turn <= largest_turn_)) largest_turn_ = turn;
    }
  }

  Real t_begin_ = Real(0), h_ = Real(0), largest_turn_ = Real(0);
  G g_begin_, g_end_;
  Tangent eta_begin_, theta_rate_;
  Vector y_begin_, y_end_, y_stage_, y_rate_, y_rate_begin_, carry_, carry_end_, sum_, F_t_;
  Matrix F_, W_, u_;  // F_ with the term of (1); u_ (dim + n_y, stages)
  Eigen::PartialPivLU<Matrix> factors_;
};

/// A step just accepted, on which the solution may be evaluated; valid only during the observer's call.
template <class G, template <class> class TableauOf = Rodas5P>
class RosenbrockStep {
 public:
  using Stages = RosenbrockStages<G, TableauOf>;
  using Real = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Vector = typename Stages::Vector;

  /// @param stages  after advance(), before commit()     @param t_end  time of the end point [s]
  RosenbrockStep(const Stages& stages, Real t_end) : stages_(stages), t_end_(t_end) {}

  Real t_begin() const { return stages_.t_begin(); }
  Real t_end() const { return t_end_; }
  const G& g_end() const { return stages_.g_end(); }
  const Vector& y_end() const { return stages_.y_end(); }
  const Stages& stages() const { return stages_; }

  /// The state at t. No cost is paid on steps that are not evaluated.
  /// @param[in]  t  from t_begin() to t_end()     @param[out]  g  pose     @param[out]  y  (n_y), sized by
  /// the caller
  void evaluate(Real t, G& g, Vector& y) const {
    if (t == t_end_) {
      g = g_end();
      y = y_end();
      return;
    }
    // y(s) - y_0 = s ( sum b_j u_j + (1 - s) (d_1 + s (d_2 + s d_3)) ), a combination of the stages
    using Tableau = TableauOf<Real>;
    const Real s = (t - t_begin()) / stages_.h();
    std::array<Real, Tableau::stages> weights;
    for (int j = 0; j < Tableau::stages; ++j) {
      Real bubble = Real(0);
      for (int k = Tableau::dense_terms - 1; k >= 0; --k) bubble = Tableau::dense[k][j] + s * bubble;
      weights[j] = s * (Tableau::b[j] + (Real(1) - s) * bubble);
    }
    Tangent theta;
    stages_.combine(weights, theta, y);
    y += stages_.y_begin();
    g = stages_.g_begin() * G::exp(theta);
    g.normalize();
  }

 private:
  const Stages& stages_;
  Real t_end_;
};

namespace detail {

/// What step control has to know of the method.
template <class G, template <class> class TableauOf>
struct RosenbrockControl {
  using Real = typename G::Scalar;
  using Tableau = TableauOf<Real>;
  using Stages = RosenbrockStages<G, TableauOf>;
  static constexpr Real beta = Real(0);
  static constexpr Real alpha = Real(1) / Tableau::order;  // the error of a step goes with h^order
  static constexpr Real largest_factor = Real(6);
  static constexpr int evaluations_per_attempt = Tableau::stages - 1;
  static constexpr int evaluations_per_commit = 1;

  /// From the first and second derivatives of the solution, which are known here: an Euler step would leave
  /// the slow motion, and what it finds there says nothing about it.
  template <class Field>
  static Real first_step(Stages& stages, Field&&, const ErrorScale<G>& scale, Real,
                         const AdaptiveOptions<Real>& options, Result<Real>&) {
    using std::pow;
    const auto& y = stages.y_begin();
    const Real d_1 = scale(stages.theta_rate_begin(), stages.y_rate_begin(), y, y);
    typename G::Tangent theta;
    stages.second_rates(theta, stages.scratch_y());
    const Real d_2 = scale(theta, stages.scratch_y(), y, y);
    const Real steepest = std::isfinite(d_2) ? std::max(d_1, d_2) : d_1;
    const Real wished = steepest <= Real(1e-15L) ? Real(1e-6L) : pow(Real(0.01L) / steepest, alpha);
    return std::min(wished, options.max_step);
  }

  static Real error(Stages& stages, const ErrorScale<G>& scale) {
    typename G::Tangent theta;
    stages.combine(Tableau::error, theta, stages.scratch_y());
    return scale(theta, stages.scratch_y(), stages.y_begin(), stages.y_end());
  }

  static RosenbrockStep<G, TableauOf> step(const Stages& stages, Real t_end) { return {stages, t_end}; }
};

}  // namespace detail

/// Integrates from state.t to t_end (which may lie before it) within the tolerances of `options`.
///
/// @param stages    workspace; its size_y() must be state.y.size()
/// @param field     see the head of this file
/// @param state     in: initial; out: at the last accepted step
/// @param observer  called after each accepted step as observer(const RosenbrockStep<G>&)
template <class G, template <class> class TableauOf, class Field, class Observer>
Result<typename G::Scalar> integrate_adaptive(RosenbrockStages<G, TableauOf>& stages, Field&& field,
                                              State<G>& state, typename G::Scalar t_end,
                                              const AdaptiveOptions<typename G::Scalar>& options,
                                              Observer&& observer) {
  auto result = detail::control_steps<detail::RosenbrockControl<G, TableauOf>>(stages, field, state, t_end,
                                                                               options, observer);
  result.jacobians = 1 + result.accepted_steps;
  return result;
}

/// The same without an observer.
template <class G, template <class> class TableauOf, class Field>
Result<typename G::Scalar> integrate_adaptive(RosenbrockStages<G, TableauOf>& stages, Field&& field,
                                              State<G>& state, typename G::Scalar t_end,
                                              const AdaptiveOptions<typename G::Scalar>& options) {
  return integrate_adaptive(stages, field, state, t_end, options, [](const RosenbrockStep<G, TableauOf>&) {});
}

}  // namespace anholon::integrate
