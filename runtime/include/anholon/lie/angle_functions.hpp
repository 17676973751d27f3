// SPDX-License-Identifier: MIT
//
// The scalar functions of an angle that exp, log and dexp^-1 of the rotation groups are made of, each to a
// few units in the last place from 0 to pi and beyond. Written so that nothing cancels; where two forms are
// needed the switch sits at a large angle where both are good, never at a tiny one where neither is.
#pragma once

#include <cmath>
#include <limits>

namespace anholon::lie {

/// sin(x)/x. The quotient of two rounded numbers has no cancellation: only x = 0 itself is special.
template <class Real>
inline Real sinc(Real x) noexcept {
  using std::sin;
  return x == Real(0) ? Real(1) : sin(x) / x;
}

/// (1 - cos theta)/theta^2 = 1/2 sinc^2(theta/2), for every theta.
template <class Real>
inline Real one_minus_cos_over_square(Real theta) noexcept {
  const Real sinc_half = sinc(theta / 2);
  return sinc_half * sinc_half / 2;
}

/// (theta - sin theta)/theta^3 = (1 - sinc theta)/theta^2.
///
/// Up to pi/2 the alternating series sum_k (-1)^k theta^2k/(2k + 3)!, whose terms fall from the first on
/// (1/6, 0.021, 0.0012, ... at pi/2), so that it loses nothing. Beyond, the closed form: sinc theta <= 2/pi
/// there, so 1 - sinc theta >= 0.36 and loses less than 2 ulp. (The closed form alone loses a factor
/// 6/theta^2.)
///
/// @param square      theta^2
/// @param sinc_theta  sinc(theta), which the caller has anyway
template <class Real>
inline Real one_minus_sinc_over_square(Real square, Real sinc_theta) noexcept {
  constexpr Real quarter_turn_square = Real(2.4674011002723396547L);  // (pi/2)^2
  if (square > quarter_turn_square) return (Real(1) - sinc_theta) / square;
  // First term left out, at theta = pi/2 and relative to 1/6: terms = 7: 1e-8, 11: 2e-18, 13: 2e-23.
  constexpr int digits = std::numeric_limits<Real>::digits;
  constexpr int terms = digits <= 24 ? 7 : digits <= 53 ? 11 : 13;
  Real sum = Real(1);
  for (int k = terms - 1; k >= 1; --k) {
    sum = Real(1) - square / Real((2 * k + 2) * (2 * k + 3)) * sum;  // nested: ratio of successive terms
  }
  return sum / 6;
}

/// Coefficients of dexp^-1 on SO(3) and SE(3).
template <class Real>
struct DexpInvCoefficients {
  Real c;        ///< (1 - x cot x)/theta^2 with x = theta/2;  1/12 at 0
  Real c_slope;  ///< (1/theta) dc/dtheta;  1/360 at 0
};

/// c(theta) = (1 - x cot x)/(4 x^2) and c'(theta)/theta, with x = theta/2.
///
/// With y_k = j_k(x)/x^k and j_k the spherical Bessel functions, and r_k = y_k/y_0,
///
///   c = r_1/4,      c'/theta = (r_1^2 - r_2)/16,      since d y_k / d(x^2) = -y_{k+1}/2
///
/// For |theta| <= pi the ratios come from y_{k-1} = (2k + 1) y_k - x^2 y_{k+1} run downwards (Miller), which
/// is Lambert's continued fraction of tan x freed of its divisions: each subtraction takes off less than
/// x^2/3 of its first term at k = 1, less than x^2/15 at k = 2, and so on. r_1^2 - r_2 goes from 1/9 - 1/15
/// at 0 to 0.164 - 0.087 at pi: less than 2 bits are lost. Beyond pi, cot x < 0 and the closed form is a sum
/// of positive terms. The pole at theta = 2 pi is that of dexp^-1 itself.
///
/// @param square  theta^2, in [0, (2 pi)^2)
template <class Real>
inline DexpInvCoefficients<Real> dexp_inv_coefficients(Real square) noexcept {
  constexpr Real half_turn_square = Real(9.8696044010893586188L);  // pi^2
  const Real x_square = square / 4;
  Real r_1, r_2;
  if (square <= half_turn_square) {
    // Starting at k = depth leaves out, at theta = pi, a part of r_1 of about prod_k x^2/((2k - 1)(2k + 1)):
    // 8: 2e-11, 13: 5e-21, 15: 7e-26.
    constexpr int digits = std::numeric_limits<Real>::digits;
    constexpr int depth = digits <= 24 ? 8 : digits <= 53 ? 13 : 15;
    Real y_next = Real(0), y = Real(1);
    for (int k = depth; k >= 3; --k) {
      const Real y_previous = Real(2 * k + 1) * y - x_square * y_next;
      y_next = y;
      y = y_previous;
    }
    const Real y_2 = y;
    const Real y_1 = Real(5) * y_2 - x_square * y_next;
    const Real y_0 = Real(3) * y_1 - x_square * y_2;
    r_1 = y_1 / y_0;
    r_2 = y_2 / y_0;
  } else {
    using std::sqrt;
    using std::tan;
    const Real x = sqrt(x_square);
    r_1 = (Real(1) - x / tan(x)) / x_square;
    r_2 = (Real(3) * r_1 - Real(1)) / x_square;  // the recurrence at k = 1; 3 r_1 >= 1.2 here
  }
  return {r_1 / 4, (r_1 * r_1 - r_2) / 16};
}

}  // namespace anholon::lie
