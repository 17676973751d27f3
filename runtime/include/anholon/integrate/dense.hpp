// SPDX-License-Identifier: MIT
//
// The continuous solution inside a step, in the canonical coordinates of that step:
//
//   g(t_0 + s h) = g_0 exp( h sum_i b_i(s) theta_dot_i ),     y(t_0 + s h) = y_0 + h sum_i b_i(s) y_dot_i
//
// with the polynomials b_i(s) of the tableau. Its error within one step is one power of h below that of the
// solution itself, hence after many steps the same power. Hairer, Norsett & Wanner 1993, section II.6. It is
// C1 from step to step in y and in g.
#pragma once

#include "anholon/integrate/rkmk.hpp"
#include "anholon/integrate/tableau.hpp"

namespace anholon::integrate {

/// Stands for the field where the continuous solution takes no more evaluations.
struct NoField {};

/// A step just accepted, on which the solution may be evaluated; valid only during the observer's call.
template <class Stages, class Field>
class DenseStepOf {
 public:
  using Real = typename Stages::Real;
  using G = typename Stages::Group;
  using Tangent = typename G::Tangent;
  using Vector = typename Stages::Vector;

  /// @param stages  after advance(), before commit()     @param t_end  time of the end point [s]
  DenseStepOf(Stages& stages, Field& field, Real t_end) : stages_(stages), field_(field), t_end_(t_end) {}

  Real t_begin() const { return stages_.t_begin(); }
  Real t_end() const { return t_end_; }
  const G& g_end() const { return stages_.g_end(); }
  const Vector& y_end() const { return stages_.y_end(); }

  /// The state at t. No cost is paid on steps that are not evaluated; on the others the tableau may take a
  /// few stages more, once.
  /// @param[in]  t  from t_begin() to t_end()     @param[out]  g  pose     @param[out]  y  (n_y), sized by
  /// the caller
  void evaluate(Real t, G& g, Vector& y) const {
    if (t == t_end_) {
      g = g_end();
      y = y_end();
      return;
    }
    if constexpr (Stages::dense_stages > 0) stages_.complete(field_);
    const Real h = stages_.h();
    const auto weights = Stages::Tableau::weights((t - t_begin()) / h);
    Tangent theta = Tangent::Zero();
    y.setZero();
    for (int i = 0; i < static_cast<int>(weights.size()); ++i) {
      theta += weights[i] * stages_.theta_rate(i);
      y += weights[i] * stages_.y_rate(i);
    }
    theta *= h;
    y = stages_.y_begin() + h * y;
    g = stages_.g_begin() * G::exp(theta);
    g.normalize();
  }

 private:
  Stages& stages_;
  Field& field_;
  Real t_end_;
};

}  // namespace anholon::integrate
