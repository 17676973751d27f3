// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Collocation at Gauss points, order twice the number of stages, on a Lie group in the canonical coordinates
// of each step. An implicit method with coefficients of its own: a witness for the explicit pairs of the
// runtime, in any scalar. Hairer, Norsett & Wanner 1993, II.7; Iserles, Munthe-Kaas, Norsett & Zanna 2000,
// "Lie-group methods", for the chart.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "anholon/integrate/result.hpp"

namespace anholon {

/// Nodes c in (0, 1), weights b and matrix a of s-stage Gauss collocation.
template <class S, int s>
struct GaussTableau {
  std::array<S, s> c, b;
  std::array<std::array<S, s>, s> a;

  GaussTableau() {
    constexpr S pi = S(3.14159265358979323846264338327950288L);
    for (int i = 0; i < s; ++i) {  // roots of the Legendre polynomial P_s by Newton's method
      S x = std::cos(pi * (S(s - i) - S(0.25L)) / (S(s) + S(0.5L)));
      S slope = 0;
      for (int iteration = 0; iteration < 100; ++iteration) {
        S p_0 = 1, p_1 = x;
        for (int n = 1; n < s; ++n) {
          const S p_2 = (S(2 * n + 1) * x * p_1 - S(n) * p_0) / S(n + 1);
          p_0 = p_1, p_1 = p_2;
        }
        slope = S(s) * (x * p_1 - p_0) / (x * x - 1);
        const S step = p_1 / slope;
        x -= step;
        if (std::abs(step) <= std::numeric_limits<S>::epsilon()) break;
      }
      c[i] = (1 + x) / 2;
      b[i] = 1 / ((1 - x * x) * slope * slope);
    }
    // a_ij is the integral of the Lagrange polynomial l_j from 0 to c_i, of degree s - 1: the rule itself is
    // exact
    for (int i = 0; i < s; ++i) {
      for (int j = 0; j < s; ++j) {
        a[i][j] = 0;
        for (int k = 0; k < s; ++k) a[i][j] += c[i] * b[k] * lagrange(j, c[i] * c[k]);
      }
    }
  }

 private:
  [[nodiscard]] S lagrange(int j, S x) const {
    S product = 1;
    for (int k = 0; k < s; ++k) {
      if (k != j) product *= (x - c[k]) / (c[j] - c[k]);
    }
    return product;
  }
};

/// Integrates with equal steps from state.t to t_end. The stages are found by fixed-point iteration, which
/// converges where a step is short against the fastest time constant.
/// @param field  as for the integrators of the runtime, rkmk.hpp
/// @return false where the iteration did not converge or a value is not finite; the state is then of no use
template <int s, class G, class Field>
bool integrate_gauss(Field&& field, integrate::State<G>& state, typename G::Scalar t_end, long steps) {
  using S = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
  static const GaussTableau<S, s> tableau;
  const S t_begin = state.t, h = (t_end - t_begin) / S(steps);
  const auto size = state.y.size();
  constexpr S converged = 4 * std::numeric_limits<S>::epsilon();
  constexpr int most_iterations = 200;
  std::array<Tangent, s> theta_rate;
  std::array<Vector, s> y_rate;
  Tangent eta;
  Vector rate = Vector::Zero(size), carry = Vector::Zero(size);
  field(t_begin, state.g, state.y, eta, rate);
  for (int i = 0; i < s; ++i) theta_rate[i] = eta, y_rate[i] = rate;

  for (long step = 0; step < steps; ++step) {
    S last_change = std::numeric_limits<S>::infinity();
    bool done = false;
    for (int iteration = 0; iteration < most_iterations && !done; ++iteration) {
      S change = 0, largest = std::numeric_limits<S>::min();
      std::array<Tangent, s> new_theta_rate;
      std::array<Vector, s> new_y_rate;
      for (int i = 0; i < s; ++i) {
        Tangent theta = Tangent::Zero();
        Vector y = state.y;
        for (int j = 0; j < s; ++j)
          theta += h * tableau.a[i][j] * theta_rate[j], y += h * tableau.a[i][j] * y_rate[j];
        field(t_begin + (S(step) + tableau.c[i]) * h, state.g * G::exp(theta), y, eta, rate);
        new_theta_rate[i] = G::dexp_inv(theta, eta);
        new_y_rate[i] = rate;
        for (int k = 0; k < G::dim; ++k) {
          change = std::max(change, std::abs(new_theta_rate[i][k] - theta_rate[i][k]));
          largest = std::max(largest, std::abs(new_theta_rate[i][k]));
        }
        for (Eigen::Index k = 0; k < size; ++k) {
          change = std::max(change, std::abs(rate[k] - y_rate[i][k]));
          largest = std::max(largest, std::abs(rate[k]));
        }
        if (!rate.allFinite() || !theta_rate[i].allFinite()) return false;
      }
      theta_rate = new_theta_rate, y_rate = new_y_rate;
      // to rounding, or as far as rounding lets it
      done = change <= converged * largest || (change >= last_change && change <= 1000 * converged * largest);
      last_change = change;
    }
    if (!done) return false;
    Tangent theta = Tangent::Zero();
    Vector increment = -carry;  // Kahan's sum
    for (int i = 0; i < s; ++i)
      theta += h * tableau.b[i] * theta_rate[i], increment += h * tableau.b[i] * y_rate[i];
    state.g = state.g * G::exp(theta);
    state.g.normalize();
    const Vector y_end = state.y + increment;
    carry = (y_end - state.y) - increment;
    state.y = y_end;
    if constexpr (requires { field.correct(t_begin, state.g, state.y); }) {
      if (field.correct(t_begin + S(step + 1) * h, state.g, state.y)) carry.setZero();
    }
  }
  state.t = t_end;
  return true;
}

}  // namespace anholon
