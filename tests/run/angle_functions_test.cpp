// SPDX-License-Identifier: GPL-2.0-or-later
//
// The scalar functions under exp, log and dexp^-1, against long double: closed forms where these are safe,
// power series elsewhere.
#include "anholon/lie/angle_functions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "run/lie_samples.hpp"

namespace anholon::testing::angle_functions_test {
namespace {

/// c = sum_k |B_2k|/(2k)! theta^(2k - 2) = 2 sum_k zeta(2k)/(2 pi)^2k theta^(2k - 2), and (1/theta)
/// dc/dtheta.
struct Reference {
  long double c = 0, c_slope = 0;
};
Reference dexp_inv_reference(long double theta) {
  const long double two_pi_square = 39.478417604357434475338L;
  Reference reference;
  long double power = 1 / two_pi_square;  // theta^(2k - 2)/(2 pi)^2k
  long double slope_power = power / two_pi_square;
  for (int k = 1; k <= 80; ++k) {  // ratio at pi: 1/4
    long double zeta = 0;
    for (int n = 40; n >= 1; --n) zeta += std::pow(static_cast<long double>(n), -2.0L * k);
    if (k == 1) zeta = two_pi_square / 24;
    if (k == 2) zeta = two_pi_square * two_pi_square / 1440;
    if (k > 2 && k < 12) {  // rest of the sum, n > 40, by Euler and Maclaurin
      const long double n = 40.5L, s = 2.0L * k;
      zeta += std::pow(n, 1 - s) / (s - 1) - s / 24 * std::pow(n, -s - 1) +
              7.0L / 5760 * s * (s + 1) * (s + 2) * std::pow(n, -s - 3) -
              31.0L / 967680 * s * (s + 1) * (s + 2) * (s + 3) * (s + 4) * std::pow(n, -s - 5);
    }
    reference.c += 2 * zeta * power;
    if (k >= 2) {
      reference.c_slope += 2 * zeta * (2 * k - 2) * slope_power;
      slope_power *= theta * theta / two_pi_square;
    }
    power *= theta * theta / two_pi_square;
  }
  return reference;
}

template <class Real>
class AngleFunctions : public ::testing::Test {
 protected:
  static constexpr long double ulp = std::numeric_limits<Real>::epsilon();
  static long double relative_error(Real value, long double expected) {
    return std::abs(static_cast<long double>(value) - expected) / std::abs(expected);
  }
};
using Reals = ::testing::Types<float, double, long double>;
TYPED_TEST_SUITE(AngleFunctions, Reals);

TYPED_TEST(AngleFunctions, DexpInvCoefficientsHoldToAFewUlpUpToPi) {
  for (const TypeParam angle : angles_up_to(TypeParam(3.1415926L))) {
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    const TypeParam square = angle * angle;
    const auto [c, c_slope] = lie::dexp_inv_coefficients(square);
    const Reference expected = dexp_inv_reference(std::sqrt(static_cast<long double>(square)));
    EXPECT_LT(this->relative_error(c, expected.c), 4 * this->ulp);  // subtractions lose 1 bit at most
    EXPECT_LT(this->relative_error(c_slope, expected.c_slope), 16 * this->ulp);  // 2 bits more
  }
}

TYPED_TEST(AngleFunctions, DexpInvCoefficientsAreContinuousAtPiAndHoldBeyond) {
  for (const TypeParam angle :
       {TypeParam(3.1415927L), TypeParam(3.5L), TypeParam(4), TypeParam(5), TypeParam(6)}) {
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    const TypeParam square = angle * angle;
    const auto [c, c_slope] = lie::dexp_inv_coefficients(square);
    const long double theta = std::sqrt(static_cast<long double>(square)), x = theta / 2;
    const long double expected = (1 - x / std::tan(x)) / (theta * theta);
    const long double sine = std::sin(x);
    // (1/theta) d/dtheta of the line above
    const long double expected_slope =
        ((x / (sine * sine) - 1 / std::tan(x)) / (2 * theta) - 2 * expected) / (theta * theta);
    // cot x at 6 rad amplifies the rounding of x by x/sin^2(x)/cot(x) = 20
    EXPECT_LT(this->relative_error(c, expected), 24 * this->ulp);
    EXPECT_LT(this->relative_error(c_slope, expected_slope), 96 * this->ulp);
  }
}

TYPED_TEST(AngleFunctions, OneMinusSincHoldsToAFewUlpUpToTwoTurns) {
  for (const TypeParam angle : angles_up_to(TypeParam(12))) {
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    const long double square = static_cast<long double>(angle) * static_cast<long double>(angle);
    long double term = 1.0L / 6, expected = 0;  // terms up to 5 at 6 rad: 2 digits lost of long double's 19
    for (int k = 0; k < 40; ++k) {
      expected += term;
      term *= -square / ((2 * k + 4) * (2 * k + 5));
    }
    const TypeParam value = lie::one_minus_sinc_over_square(TypeParam(angle * angle), lie::sinc(angle));
    const long double reference_error = angle > TypeParam(2) ? 1e-17L : 0;
    EXPECT_LT(this->relative_error(value, expected), 5 * this->ulp + reference_error);
  }
}

TYPED_TEST(AngleFunctions, OneMinusCosHoldsToAFewUlpWithoutASwitch) {
  for (const TypeParam angle : angles_up_to(TypeParam(6))) {
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    const long double s = angle == 0 ? 1.0L : std::sin(static_cast<long double>(angle) / 2) / (angle / 2.0L);
    // sin x near x = 3 amplifies by x cot x = 21; below pi/2 the bound is 4 ulp
    const long double ulps = angle > TypeParam(3.2L) ? 48 : 4;
    EXPECT_LT(this->relative_error(lie::one_minus_cos_over_square(angle), s * s / 2), ulps * this->ulp);
  }
}

}  // namespace
}  // namespace anholon::testing::angle_functions_test
