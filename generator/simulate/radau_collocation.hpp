// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Collocation at Radau's right points, order 2s - 1, L-stable, by Newton's method: the witness for motions
// that are too fast for gauss_collocation.hpp, whose fixed-point iteration needs steps below their time
// constants. Nodes and matrix are computed here; coefficients of the runtime's stiff method have no part in
// it. Hairer & Wanner 1996, "Solving Ordinary Differential Equations II", IV.5 and IV.8.

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "simulate/gauss_collocation.hpp"

namespace anholon {

/// Nodes c in (0, 1], the last one 1, and matrix a of s-stage Radau collocation; its last row are the
/// weights.
template <class S, int s>
struct RadauTableau {
  std::array<S, s> c;
  std::array<std::array<S, s>, s> a;

  RadauTableau() {
    constexpr S pi = S(3.14159265358979323846264338327950288L);
    for (int i = 0; i < s; ++i) {  // roots of P_s - P_(s-1) by Newton's method
      S x = i == s - 1 ? S(1) : std::cos(S(2 * (s - 1 - i)) * pi / S(2 * s - 1));
      for (int iteration = 0; iteration < 100 && i < s - 1; ++iteration) {
        S p_0 = 1, p_1 = x, slope_0 = 0, slope_1 = 1;
        for (int n = 1; n < s; ++n) {
          const S p_2 = (S(2 * n + 1) * x * p_1 - S(n) * p_0) / S(n + 1);
          const S slope_2 = (S(2 * n + 1) * (p_1 + x * slope_1) - S(n) * slope_0) / S(n + 1);
          p_0 = p_1, p_1 = p_2, slope_0 = slope_1, slope_1 = slope_2;
        }
        const S step = (p_1 - p_0) / (slope_1 - slope_0);
        x -= step;
        if (std::abs(step) <= std::numeric_limits<S>::epsilon()) break;
      }
      c[i] = (1 + x) / 2;
    }
    const GaussTableau<S, s> gauss;  // integrates the Lagrange polynomials, of degree s - 1, exactly
    for (int i = 0; i < s; ++i) {
      for (int j = 0; j < s; ++j) {
        a[i][j] = 0;
        for (int k = 0; k < s; ++k) {
          S lagrange = 1;
          for (int m = 0; m < s; ++m) {
            if (m != j) lagrange *= (c[i] * gauss.c[k] - c[m]) / (c[j] - c[m]);
          }
          a[i][j] += c[i] * gauss.b[k] * lagrange;
        }
      }
    }
  }
};

/// Integrates with equal steps from state.t to t_end.
/// @param field  as for the stiff integrator of the runtime, rosenbrock.hpp
/// @return false where the iteration did not converge or a value is not finite; the state is then of no use
template <int s, class G, class Field>
bool integrate_radau(Field&& field, integrate::State<G>& state, typename G::Scalar t_end, long steps) {
  using S = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
  static const RadauTableau<S, s> tableau;
  constexpr int most_iterations = 40;
  const auto n = state.y.size(), size = n + G::dim;
  const S t_begin = state.t, h = (t_end - t_begin) / S(steps);
  Vector z = Vector::Zero(s * size), rate(s * size), y_rate(n), F_t(size), carry = Vector::Zero(n);
  Matrix F(size, size), newton(s * size, s * size);
  Eigen::PartialPivLU<Matrix> factors(s * size);
  Tangent eta;
  for (long step = 0; step < steps; ++step) {
    const S t = t_begin + S(step) * h;
    field(t, state.g, state.y, eta, y_rate);
    field.jacobian(t, state.g, state.y, F, F_t);
    for (int j = 0; j < G::dim; ++j)
      F.col(j).template head<G::dim>() += G::bracket(Tangent::Unit(j), eta) / 2;
    newton.setIdentity();
    for (int i = 0; i < s; ++i) {
      for (int j = 0; j < s; ++j) newton.block(i * size, j * size, size, size) -= h * tableau.a[i][j] * F;
    }
    factors.compute(newton);
    for (int i = 0; i < s; ++i) {
      z.segment(i * size, G::dim) = tableau.c[i] * h * eta;
      z.segment(i * size + G::dim, n) = tableau.c[i] * h * y_rate;
    }
    S last_change = std::numeric_limits<S>::infinity();
    for (int iteration = 0;; ++iteration) {
      for (int i = 0; i < s; ++i) {
        const Tangent theta = z.segment(i * size, G::dim);
        const Vector y = state.y + z.segment(i * size + G::dim, n);
        field(t + tableau.c[i] * h, state.g * G::exp(theta), y, eta, y_rate);
        rate.segment(i * size, G::dim) = G::dexp_inv(theta, eta);
        rate.segment(i * size + G::dim, n) = y_rate;
      }
      if (!rate.allFinite()) return false;
      Vector residual = -z;
      for (int i = 0; i < s; ++i) {
        for (int j = 0; j < s; ++j)
          residual.segment(i * size, size) += h * tableau.a[i][j] * rate.segment(j * size, size);
      }
      const Vector change = factors.solve(residual);
      z += change;
      // each component against its own size in the step: to rounding, or as far as rounding lets it
      S largest = 0;
      for (Eigen::Index k = 0; k < size; ++k) {
        S moved = 0, own = std::numeric_limits<S>::min();
        for (int i = 0; i < s; ++i) {
          moved = std::max(moved, std::abs(change(i * size + k)));
          own = std::max(own, std::abs(z(i * size + k)));
        }
        if (k >= G::dim) own = std::max(own, std::abs(state.y(k - G::dim)) / S(steps));
        largest = std::max(largest, moved / own);
      }
      if (largest <= 10 * std::numeric_limits<S>::epsilon()) break;
      if (iteration > 3 && largest >= last_change && largest < S(1e-6L)) break;
      if (iteration == most_iterations || !std::isfinite(largest)) return false;
      last_change = largest;
    }
    const Tangent theta = z.segment((s - 1) * size, G::dim);
    const Vector increment = z.tail(n) - carry;  // Kahan's sum
    state.g = state.g * G::exp(theta);
    state.g.normalize();
    const Vector y_end = state.y + increment;
    carry = (y_end - state.y) - increment;
    state.y = y_end;
    if constexpr (requires { field.correct(t, state.g, state.y); }) {
      if (field.correct(t_begin + S(step + 1) * h, state.g, state.y)) carry.setZero();
    }
  }
  state.t = t_end;
  return true;
}

}  // namespace anholon
