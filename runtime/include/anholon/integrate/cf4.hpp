// SPDX-License-Identifier: MIT
//
// Commutator-free integration of order 4: products of exponentials of sums of velocities, no dexp^-1 and no
// chart. Celledoni, Marthinsen & Owren 2003, "Commutator-free Lie group methods", Future Generation Computer
// Systems 19, with the classical method's stages. With the velocities eta_i in the axes of the body,
//
//   eta_1 at g,   eta_2 at g exp(h eta_1/2),   eta_3 at g exp(h eta_2/2),
//   eta_4 at g exp(h eta_1/2) exp(h (eta_3 - eta_1/2)),
//   g_end = g exp(h/12 (3 eta_1 + 2 eta_2 + 2 eta_3 - eta_4))
//             exp(h/12 (-eta_1 + 2 eta_2 + 2 eta_3 + 3 eta_4))
//
// and y by Kutta's weights 1/6, 1/3, 1/3, 1/6. Five exponentials a step.
#pragma once

#include <array>
#include <utility>

#include "anholon/integrate/result.hpp"
#include "anholon/integrate/rkmk.hpp"
#include "anholon/lie/lie_group.hpp"

namespace anholon::integrate {

/// The stages of one step, for integrate_fixed().
template <lie::LieGroup G>
class Cf4Stages {
 public:
  using Group = G;
  using Real = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  static constexpr int stages = 4;
  static constexpr int evaluations_per_step = 4;

  /// Allocates; nothing else here does.
  /// @param size_y  number of components of y
  explicit Cf4Stages(Eigen::Index size_y)
      : y_begin_(size_y), y_end_(size_y), y_stage_(size_y), carry_(size_y), carry_end_(size_y) {
    for (Vector& rate : y_rate_) rate = Vector::Zero(size_y);
    carry_.setZero();
  }

  Eigen::Index size_y() const { return y_begin_.size(); }

  /// As RkmkStages::start().
  template <class Field>
  bool start(Field&& field, const State<G>& state) {
    t_begin_ = state.t, g_begin_ = state.g, y_begin_ = state.y;
    carry_.setZero();
    if (!state.g.is_finite() || !state.y.allFinite()) return false;
    return evaluate_first(field);
  }

  /// As RkmkStages::advance().
  template <class Field>
  void advance(Field&& field, Real h) {
    const Real half = h / 2;
    const G to_second = G::exp(half * eta_[0]);
    stage(field, 1, half, to_second);
    stage(field, 2, half, G::exp(half * eta_[1]));
    stage(field, 3, h, to_second * G::exp(h * eta_[2] - half * eta_[0]));
    const Tangent middle = 2 * (eta_[1] + eta_[2]);
    const G first = G::exp((h / 12) * (3 * eta_[0] + middle - eta_[3]));
    const G second = G::exp((h / 12) * (3 * eta_[3] + middle - eta_[0]));
    g_end_ = g_begin_ * (first * second);
    g_end_.normalize();  // removes rounding only
    // Kahan's sum, as in RkmkStages.
    y_stage_ = (h / 6) * (y_rate_[0] + 2 * (y_rate_[1] + y_rate_[2]) + y_rate_[3]) - carry_;
    y_end_ = y_begin_ + y_stage_;
    carry_end_ = (y_end_ - y_begin_) - y_stage_;
  }

  /// As RkmkStages::commit().
  template <class Field>
  bool commit(Field&& field, Real t_end) {
    t_begin_ = t_end, g_begin_ = g_end_;
    y_begin_.swap(y_end_);
    carry_.swap(carry_end_);
    if constexpr (requires { field.correct(t_begin_, g_begin_, y_begin_); }) {
      if (field.correct(t_begin_, g_begin_, y_begin_)) carry_.setZero();
    }
    return evaluate_first(field);
  }

  bool end_is_finite() const { return g_end_.is_finite() && y_end_.allFinite(); }
  /// exp reaches any turn and nothing here inverts it: no step turns too far for the method.
  Real largest_turn() const { return Real(0); }
  const G& g_end() const { return g_end_; }
  const Vector& y_end() const { return y_end_; }

  void copy_current_to(State<G>& state) const { state.t = t_begin_, state.g = g_begin_, state.y = y_begin_; }

 private:
  template <class Field>
  bool evaluate_first(Field&& field) {
    field(t_begin_, std::as_const(g_begin_), std::as_const(y_begin_), eta_[0], y_rate_[0]);
    return eta_[0].allFinite() && y_rate_[0].allFinite();
  }

  /// Stage i lies `step` after the one before it in y, at g_begin `delta`.
  template <class Field>
  void stage(Field&& field, int i, Real step, const G& delta) {
    y_stage_ = y_begin_ + step * y_rate_[i - 1];
    const G g = g_begin_ * delta;
    field(t_begin_ + step, g, std::as_const(y_stage_), eta_[i], y_rate_[i]);
  }

  Real t_begin_ = Real(0);
  G g_begin_, g_end_;
  std::array<Tangent, 4> eta_;
  std::array<Vector, 4> y_rate_;
  Vector y_begin_, y_end_, y_stage_, carry_, carry_end_;
};

}  // namespace anholon::integrate
