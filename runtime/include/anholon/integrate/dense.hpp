// SPDX-License-Identifier: MIT
//
// The continuous solution of Dormand-Prince inside a step, in the canonical coordinates of that step:
//
//   g(t_0 + s h) = g_0 exp( h sum_i b_i(s) theta_dot_i ),     y(t_0 + s h) = y_0 + h sum_i b_i(s) y_dot_i
//
//   b_i(s) = s^2 (3 - 2s) b_i + s (1 - s)^2 [i = 1] - s^2 (1 - s) [i = 7] + s^2 (1 - s)^2 d_i
//
// that is the cubic Hermite polynomial of the step's ends and a quartic bubble that lifts it to order 4:
// its error within one step is O(h^5), hence after many steps the same power as that of the solution itself.
// Hairer, Norsett & Wanner 1993, section II.6 (there with rcont1..5). It is C1 from step to step in y and in
// g.
#pragma once

#include <Eigen/Core>
#include <array>

#include "anholon/integrate/rkmk.hpp"
#include "anholon/integrate/tableau.hpp"

namespace anholon::integrate {

/// A step just accepted, on which the solution may be evaluated; valid only during the observer's call.
template <class G>
class DenseStep {
 public:
  using Real = typename G::Scalar;
  using Stages = RkmkStages<G, DormandPrince54>;
  using Tangent = typename G::Tangent;
  using Vector = typename Stages::Vector;

  /// @param stages  after advance(), before commit()     @param t_end  time of the end point [s]
  DenseStep(const Stages& stages, Real t_end) : stages_(stages), t_end_(t_end) {}

  Real t_begin() const { return stages_.t_begin(); }
  Real t_end() const { return t_end_; }
  const G& g_end() const { return stages_.g_end(); }
  const Vector& y_end() const { return stages_.y_end(); }

  /// The state at t. No cost is paid on steps that are not evaluated.
  /// @param[in]  t  from t_begin() to t_end()     @param[out]  g  pose     @param[out]  y  (n_y), sized by
  /// the caller
  void evaluate(Real t, G& g, Vector& y) const {
    if (t == t_end_) {
      g = g_end();
      y = y_end();
      return;
    }
    using Tableau = DormandPrince54<Real>;
    const Real h = stages_.h();
    const Real s = (t - t_begin()) / h, u = Real(1) - s;
    const Real ends = s * s * (Real(3) - 2 * s), bubble = s * s * u * u;
    Tangent theta = Tangent::Zero();
    y.setZero();
    for (int i = 0; i < Tableau::stages; ++i) {
      Real weight = ends * Tableau::b[i] + bubble * Tableau::bubble[i];
      if (i == 0) weight += s * u * u;
      if (i == Tableau::stages - 1) weight -= s * s * u;
      theta += weight * stages_.theta_rate(i);
      y += weight * stages_.y_rate(i);
    }
    theta *= h;
    y = stages_.y_begin() + h * y;
    g = stages_.g_begin() * G::exp(theta);
    g.normalize();
  }

 private:
  const Stages& stages_;
  Real t_end_;
};

}  // namespace anholon::integrate
