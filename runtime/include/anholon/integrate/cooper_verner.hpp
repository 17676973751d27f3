// SPDX-License-Identifier: MIT
//
// An explicit method of order 8 with a fixed step, for smooth motions that are wanted to many digits.
#pragma once

#include <array>

#include "anholon/integrate/decimal.hpp"
#include "anholon/integrate/rkmk.hpp"

namespace anholon::integrate {

/// Cooper & Verner 1972, "Some explicit Runge-Kutta methods of high order", SIAM J. Numer. Anal. 9: eleven
/// stages, order 8, the least number that order 8 allows. Every coefficient is a + b sqrt(21) with rational
/// a, b.
template <class Real>
struct CooperVerner8 {
  static constexpr int stages = 11;
  static constexpr int order = 8;
  static constexpr bool first_same_as_last = false;

  static constexpr Real root = 4.58257569495584000658804719372800848898_decimal;  // sqrt(21)
  /// (a + b sqrt(21))/d
  static constexpr Real q(int a, int b, int d) { return (Real(a) + Real(b) * root) / Real(d); }
  static constexpr Real half = Real(1) / 2;

  static constexpr std::array<Real, stages> c = {
      0, half, half, q(7, 1, 14), q(7, 1, 14), half, q(7, -1, 14), q(7, -1, 14), half, q(7, 1, 14), 1};
  static constexpr std::array<std::array<Real, stages>, stages> a = {{
      {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
      {half, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
      {half / 2, half / 2, 0, 0, 0, 0, 0, 0, 0, 0, 0},
      {q(1, 0, 7), q(-7, -3, 98), q(21, 5, 49), 0, 0, 0, 0, 0, 0, 0, 0},
      {q(11, 1, 84), 0, q(18, 4, 63), q(21, -1, 252), 0, 0, 0, 0, 0, 0, 0},
      {q(5, 1, 48), 0, q(9, 1, 36), q(-231, 14, 360), q(63, -7, 80), 0, 0, 0, 0, 0, 0},
      {q(10, -1, 42), 0, q(-432, 92, 315), q(633, -145, 90), q(-504, 115, 70), q(63, -13, 35), 0, 0, 0, 0, 0},
      {q(1, 0, 14), 0, 0, 0, q(14, -3, 126), q(13, -3, 63), q(1, 0, 9), 0, 0, 0, 0},
      {q(1, 0, 32), 0, 0, 0, q(91, -21, 576), q(11, 0, 72), q(-385, -75, 1152), q(63, 13, 128), 0, 0, 0},
      {q(1, 0, 14), 0, 0, 0, q(1, 0, 9), q(-733, -147, 2205), q(515, 111, 504), q(-51, -11, 56),
       q(132, 28, 245), 0, 0},
      {0, 0, 0, 0, q(-42, 7, 18), q(-18, 28, 45), q(-273, -53, 72), q(301, 53, 72), q(28, -28, 45),
       q(49, -7, 18), 0},
  }};
  static constexpr std::array<Real, stages> b = {
      q(1, 0, 20), 0, 0, 0, 0, 0, 0, q(49, 0, 180), q(16, 0, 45), q(49, 0, 180), q(1, 0, 20)};
};

/// RKMK8: the workspace of Cooper & Verner's method for integrate_fixed().
template <class G>
using Rkmk8 = RkmkStages<G, CooperVerner8>;

}  // namespace anholon::integrate
