// SPDX-License-Identifier: MIT
//
// A variational integrator for one free body, or any system on a Lie group whose kinetic energy is
// eta^T M eta / 2 with a constant M, under forces that depend on the pose (and time) alone. Not for bodies
// with joints, constraints or damping.
//
// The action of a step g_1 = g_0 exp(h xi) is h (xi^T M xi / 2) - h (V(g_0) + V(g_1))/2; its extremals are
//
//   D(-h xi)^T M xi = mu_0 + h/2 f(g_0)                                                            (1)
//   mu_1 = D(h xi)^T M xi + h/2 f(g_1),     D(theta) eta = dexp_inv(theta, eta)                    (2)
//
// with mu = M eta the momentum and f = -dV the wrench, both in the axes of the body. Marsden & West 2001,
// "Discrete mechanics and variational integrators", Acta Numerica 10; Bou-Rabee & Marsden 2009,
// "Hamilton-Pontryagin integrators on Lie groups", Found. Comput. Math. 9. As D(-theta) = D(theta) Ad(exp
// theta), the momentum in the axes of the world is kept to rounding where f has none about an axis; the
// method is symplectic and its own reverse, so that the energy does not drift: it swings within O(h^order).
// Order 2, or 4 by Suzuki's five steps of p, p, 1 - 4p, p, p with p = 1/(4 - 4^(1/3)).
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <limits>
#include <utility>

#include "anholon/integrate/decimal.hpp"
#include "anholon/integrate/result.hpp"
#include "anholon/integrate/rkmk.hpp"
#include "anholon/lie/lie_group.hpp"

namespace anholon::integrate {

/// One step, for integrate_fixed(). State::y is the momentum mu (dim), in the axes of the body. A field has
///
///   void inertia(Matrix& M) const                                   M (dim, dim), positive definite
///   void wrench(Real t, const G& g, Tangent& f) const               f (dim), in the axes of the body
///
/// and may have correct() as in rkmk.hpp.
template <lie::LieGroup G, int order = 4>
class VariationalStages {
  static_assert(order == 2 || order == 4);

 public:
  using Group = G;
  using Real = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Matrix = Eigen::Matrix<Real, G::dim, G::dim>;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  static constexpr int substeps = order == 2 ? 1 : 5;
  static constexpr int stages = substeps + 1;
  static constexpr int evaluations_per_step = substeps;  // of the wrench

  /// Allocates; nothing else here does.
  VariationalStages() : y_(static_cast<Eigen::Index>(G::dim)) {}

  Eigen::Index size_y() const { return y_.size(); }

  template <class Field>
  bool start(Field&& field, const State<G>& state) {
    t_ = state.t, g_ = state.g, mu_ = state.y;
    field.inertia(M_);
    field.wrench(t_, std::as_const(g_), f_);
    xi_ = M_.llt().solve(mu_);
    return g_.is_finite() && mu_.allFinite() && f_.allFinite() && xi_.allFinite();
  }

  template <class Field>
  void advance(Field&& field, Real h) {
    constexpr Real p = 0.414490771794375737142354062860761495711_decimal;  // 1/(4 - 4^(1/3))
    largest_turn_ = Real(0);
    g_end_ = g_, mu_end_ = mu_, f_end_ = f_;
    Real t = t_;
    for (int i = 0; i < substeps; ++i) {
      const Real part = substeps == 1 ? h : i == 2 ? h - 4 * (p * h) : p * h;
      t += part;
      substep(field, t, part);
    }
    y_ = mu_end_;
  }

  template <class Field>
  bool commit(Field&& field, Real t_end) {
    t_ = t_end, g_ = g_end_, mu_ = mu_end_, f_ = f_end_;
    if constexpr (requires { field.correct(t_, g_, y_); }) {
      if (field.correct(t_, g_, y_)) {
        mu_ = y_;
        field.wrench(t_, std::as_const(g_), f_);
      }
    }
    return f_.allFinite();
  }

  /// False also where (1) has no solution near the last one: the step is too long.
  bool end_is_finite() const { return g_end_.is_finite() && mu_end_.allFinite(); }
  Real largest_turn() const { return largest_turn_; }
  const G& g_end() const { return g_end_; }
  const Vector& y_end() const { return y_; }

  void copy_current_to(State<G>& state) const { state.t = t_, state.g = g_, state.y = mu_; }

 private:
  template <class Field>
  void substep(Field&& field, Real t, Real h) {
    const Tangent kicked = mu_end_ + (h / 2) * f_end_;
    if (!solve(kicked, h)) {
      mu_end_.setConstant(std::numeric_limits<Real>::quiet_NaN());
      return;
    }
    const Tangent theta = h * xi_;
    if constexpr (G::linear_dim < G::dim) {
      const Real turn = theta.template tail<G::dim - G::linear_dim>().norm();
      if (!(turn <= largest_turn_)) largest_turn_ = turn;
    }
    g_end_ = g_end_ * G::exp(theta);
    g_end_.normalize();
    // (2) with D(theta)^T M xi = Ad(exp theta)^T kicked: momentum is moved, not computed anew
    mu_end_ = G::exp(theta).adjoint().transpose() * kicked;
    field.wrench(t, std::as_const(g_end_), f_end_);
    mu_end_ += (h / 2) * f_end_;
  }

  /// D(theta)^T v
  static Tangent transposed(const Tangent& theta, const Tangent& v) {
    Tangent result;
    for (int i = 0; i < G::dim; ++i) result[i] = G::dexp_inv(theta, Tangent::Unit(i)).dot(v);
    return result;
  }

  /// (1) for xi by Newton's method from the last one, with the derivative of its part of first order in h:
  /// errors shrink by O(|h xi|^2) each time. Ends where they no longer do.
  bool solve(const Tangent& kicked, Real h) {
    Real last = std::numeric_limits<Real>::infinity();
    const Real small = 8 * std::numeric_limits<Real>::epsilon();
    for (int iteration = 0; iteration < 100; ++iteration) {
      const Tangent momentum = M_ * xi_;
      const Tangent defect = transposed(-h * xi_, momentum) - kicked;
      Matrix slope = M_;  // column i: M e_i - h/2 (ad_{e_i}^T M xi + ad_xi^T M e_i)
      for (int i = 0; i < G::dim; ++i) {
        for (int j = 0; j < G::dim; ++j) {
          slope(j, i) -= h / 2 *
                         (G::bracket(Tangent::Unit(i), Tangent::Unit(j)).dot(momentum) +
                          G::bracket(xi_, Tangent::Unit(j)).dot(M_.col(i)));
        }
      }
      const Tangent change = slope.partialPivLu().solve(defect);
      const Real size = change.norm();
      if (!(size < last)) return size <= 1000 * small * xi_.norm();
      xi_ -= change;
      if (size <= small * xi_.norm()) return true;
      last = size;
    }
    return false;
  }

  Real t_ = Real(0), largest_turn_ = Real(0);
  G g_, g_end_;
  Matrix M_;
  Tangent mu_, mu_end_, f_, f_end_, xi_;
  Vector y_;
};

}  // namespace anholon::integrate
