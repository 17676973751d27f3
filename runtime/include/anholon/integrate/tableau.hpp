// SPDX-License-Identifier: MIT
//
// Explicit Runge-Kutta tableaux as data. Coefficients are quotients of integers, rounded once in Real.
//
//   k_i = f(t + c_i h, y + h sum_{j<i} a_ij k_j),     y_1 = y + h sum_i b_i k_i
//
// `first_same_as_last` tells that the last stage is evaluated at the end point (a_sj = b_j, c_s = 1), so that
// it serves as the first stage of the next step.
#pragma once

#include <array>

namespace anholon::integrate {

/// Kutta 1901: four stages, order 4.
template <class Real>
struct ClassicalRungeKutta4 {
  static constexpr int stages = 4;
  static constexpr int order = 4;
  static constexpr bool first_same_as_last = false;

  static constexpr Real half = Real(1) / 2;
  static constexpr std::array<Real, stages> c = {0, half, half, 1};
  static constexpr std::array<std::array<Real, stages>, stages> a = {{
      {0, 0, 0, 0},
      {half, 0, 0, 0},
      {0, half, 0, 0},
      {0, 0, 1, 0},
  }};
  static constexpr std::array<Real, stages> b = {Real(1) / 6, Real(1) / 3, Real(1) / 3, Real(1) / 6};
};

/// Dormand & Prince 1980, RK5(4)7M: order 5 with an embedded solution of order 4.
/// Printed in Hairer, Norsett & Wanner 1993, "Solving Ordinary Differential Equations I", Table II.5.2.
template <class Real>
struct DormandPrince54 {
  static constexpr int stages = 7;
  static constexpr int order = 5;
  static constexpr bool first_same_as_last = true;

  // Step control by the error of this step and, a little, of the last: DOPRI5's constants.
  static constexpr Real integral_weight = Real(0.04L);
  static constexpr Real largest_factor = 10;

  static constexpr Real q(long long numerator, long long denominator) {
    return Real(numerator) / Real(denominator);
  }
  static constexpr std::array<Real, stages> c = {0, q(1, 5), q(3, 10), q(4, 5), q(8, 9), 1, 1};
  static constexpr std::array<std::array<Real, stages>, stages> a = {{
      {0, 0, 0, 0, 0, 0, 0},
      {q(1, 5), 0, 0, 0, 0, 0, 0},
      {q(3, 40), q(9, 40), 0, 0, 0, 0, 0},
      {q(44, 45), q(-56, 15), q(32, 9), 0, 0, 0, 0},
      {q(19372, 6561), q(-25360, 2187), q(64448, 6561), q(-212, 729), 0, 0, 0},
      {q(9017, 3168), q(-355, 33), q(46732, 5247), q(49, 176), q(-5103, 18656), 0, 0},
      {q(35, 384), 0, q(500, 1113), q(125, 192), q(-2187, 6784), q(11, 84), 0},
  }};
  static constexpr std::array<Real, stages> b = a[6];

  /// b - b^, with b^ the embedded solution of order 4.
  static constexpr std::array<Real, stages> error = {
      q(71, 57600), 0, q(-71, 16695), q(71, 1920), q(-17253, 339200), q(22, 525), q(-1, 40)};

  /// Weights of the rates in the continuous solution, of order 4: at t + s h it is the start plus h times
  /// their sum,
  ///
  ///   b_i(s) = s^2 (3 - 2s) b_i + s (1 - s)^2 [i = 1] - s^2 (1 - s) [i = 7] + s^2 (1 - s)^2 d_i
  ///
  /// that is the cubic Hermite polynomial of the step's ends and a quartic bubble that lifts it to order 4.
  static constexpr std::array<Real, stages> weights(Real s) {
    const Real u = Real(1) - s;
    const Real ends = s * s * (Real(3) - 2 * s), shape = s * s * u * u;
    std::array<Real, stages> sum{};
    for (int i = 0; i < stages; ++i) sum[i] = ends * b[i] + shape * bubble[i];
    sum[0] += s * u * u;
    sum[stages - 1] -= s * s * u;
    return sum;
  }

  /// Coefficients d_i of the quartic bubble; their sum is 0. Shampine's, as in Hairer, Norsett & Wanner 1993,
  /// section II.6 and their code DOPRI5.
  static constexpr std::array<Real, stages> bubble = {
      q(-12715105075, 11282082432),  0,
      q(87487479700, 32700410799),   q(-10690763975, 1880347072),
      q(701980252875, 199316789632), q(-1453857185, 822651844),
      q(69997945, 29380423)};
};

}  // namespace anholon::integrate
