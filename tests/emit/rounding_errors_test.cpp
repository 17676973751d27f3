// SPDX-License-Identifier: GPL-2.0-or-later
// Rounding errors as generated headers compute them, against rational arithmetic.

#include "tape/rounding_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "emit/random_program.hpp"
#include "number/exact.hpp"

namespace anholon::rounding_errors_test {
namespace {

namespace detail {
template <class Real>
constexpr Real constant(long double value) {
  return static_cast<Real>(value);
}
#include "../../templates/rounding_errors.inl"
}  // namespace detail

/// A number with all digits of Real, as a double holds it, of a size between 2^-range and 2^range.
template <class Real>
Real draw(test::Dice& dice, int range) {
  const auto digits = static_cast<Real>(dice.uniform(-1, 1));
  return std::ldexp(digits, static_cast<int>(dice.below(static_cast<std::size_t>(2 * range))) - range);
}

Exact exact(double x) { return Exact::from_double(x); }

template <class Real>
class RoundingErrorsOf : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(RoundingErrorsOf, Reals);

TYPED_TEST(RoundingErrorsOf, SumsAndProductsAreExact) {
  using Real = TypeParam;
  test::Dice dice(3);
  for (int i = 0; i < 2000; ++i) {
    const Real a = draw<Real>(dice, 20), b = draw<Real>(dice, 20);
    const Real sum = a + b, product = a * b;
    EXPECT_EQ(exact(sum) + exact(detail::sum_error(a, b)), exact(a) + exact(b)) << a << " + " << b;
    EXPECT_EQ(exact(product) + exact(detail::product_error(a, b)), exact(a) * exact(b)) << a << " * " << b;
  }
}

TYPED_TEST(RoundingErrorsOf, QuotientsAreRightToTheLastDigitsOfTheError) {
  using Real = TypeParam;
  test::Dice dice(4);
  const auto eps = static_cast<double>(std::numeric_limits<Real>::epsilon());
  for (int i = 0; i < 2000; ++i) {
    const Real a = draw<Real>(dice, 20), b = draw<Real>(dice, 20), quotient = a / b;
    if (b == Real(0)) continue;
    const Exact left = exact(a) / exact(b) - exact(quotient) - exact(detail::quotient_error(a, b));
    // the remainder is exact; its quotient is rounded once, at half an ulp of half an ulp of a / b
    EXPECT_LE(std::abs(left.to_double()), eps * eps * static_cast<double>(std::abs(quotient)))
        << a << " / " << b;
  }
}

TEST(RoundingErrors, OfGeneratedCodeAreThoseOfTheInterpreter) {
  test::Dice dice(5);
  for (int i = 0; i < 2000; ++i) {
    const auto a = draw<double>(dice, 100), b = draw<double>(dice, 100);
    EXPECT_EQ(detail::sum_error(a, b), sum_error(a, b));
    EXPECT_EQ(detail::product_error(a, b), product_error(a, b)) << "halves of digits against a fused product";
    EXPECT_EQ(detail::quotient_error(a, b), quotient_error(a, b));
  }
  EXPECT_EQ(sum_error(Exact(1), Exact::ratio(1, 3)), Exact(0)) << "exact numbers lose nothing";
}

TEST(RoundingErrors, OfALongDoubleLeaveItsSquare) {
  const long double a = 1.0L / 3, b = 1.0L / 7, eps = std::numeric_limits<long double>::epsilon();
  // (1/3 rounded)(1/7 rounded) from its two parts, against the exact one by differences of small numbers
  const long double c = a * 3 - 1, d = b * 7 - 1;  // exact: what rounding did to 1/3 and 1/7
  const long double left = (a * b + detail::product_error(a, b)) * 21 - 1 - c - d;
  EXPECT_LE(std::abs(left), 30 * eps) << "a b is 1/21 (1 + c)(1 + d)";
}

}  // namespace
}  // namespace anholon::rounding_errors_test
