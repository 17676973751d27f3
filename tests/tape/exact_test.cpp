// SPDX-License-Identifier: GPL-2.0-or-later
// Exact numbers: reading, rounding, printing, and the digits of their functions.

#include "number/exact.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "emit/random_program.hpp"

namespace anholon::exact_test {
namespace {

TEST(Exact, ReadsDecimalsExactly) {
  EXPECT_EQ(Exact::from_decimal("0.1"), Exact::ratio(1, 10));
  EXPECT_EQ(Exact::from_decimal("-12.50e-1"), Exact::ratio(-5, 4));
  EXPECT_EQ(Exact::from_decimal("+3"), Exact(3));
  EXPECT_EQ(Exact::from_decimal(".5"), Exact::ratio(1, 2));
  EXPECT_EQ(Exact::from_decimal("1E3"), Exact(1000));
  EXPECT_EQ(Exact::from_decimal("-0"), Exact(0));
  EXPECT_TRUE(Exact::from_decimal("9.81").is_rational());
}

TEST(Exact, RefusesWhatIsNoDecimal) {
  for (const char* text : {"", ".", "-", "1e", "1e+", "e5", "1.2.3", "1 2", "0x10", "nan", "inf", "1f", "--1",
                           "1e99999", "1e999999999999999999999", "1_000", "1/3"}) {
    EXPECT_THROW((void)Exact::from_decimal(text), std::invalid_argument) << text;
  }
}

TEST(Exact, RoundsToTheNearestDouble) {
  for (const char* text :
       {"0.1", "1e-320", "4.9e-324", "1.7976931348623157e308", "123456789.123456789",
        "2.2250738585072011e-308", "-9007199254740993", "0.333333333333333333333333333333333333333"}) {
    EXPECT_EQ(Exact::from_decimal(text).to_double(), std::strtod(text, nullptr)) << text;
  }
}

TEST(Exact, TakesEveryDoubleThereAndBack) {
  test::Dice dice(1);
  for (int i = 0; i < 2000; ++i) {
    const auto bits = static_cast<std::uint64_t>(dice.below(std::numeric_limits<std::size_t>::max()));
    const auto x = std::bit_cast<double>(bits);
    if (!std::isfinite(x)) continue;
    EXPECT_EQ(Exact::from_double(x).to_double(), x);
  }
  for (const double x :
       {0.0, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(), -1.0 / 3}) {
    EXPECT_EQ(Exact::from_double(x).to_double(), x);
  }
  EXPECT_THROW((void)Exact::from_double(std::numeric_limits<double>::infinity()), std::domain_error);
}

TEST(Exact, PrintsTheShortestTextOfSoManyDigits) {
  EXPECT_EQ(Exact(0).decimal(21), "0");
  EXPECT_EQ(Exact(-15).decimal(21), "-15");
  EXPECT_EQ(Exact(100).decimal(21), "100");
  EXPECT_EQ(Exact(123456).decimal(3), "123000");
  EXPECT_EQ(Exact::ratio(1, 3).decimal(5), "0.33333");
  EXPECT_EQ(Exact::ratio(2, 3).decimal(5), "0.66667");
  EXPECT_EQ(Exact::from_decimal("9.9996").decimal(4), "10");
  EXPECT_EQ(Exact::from_decimal("0.00099996").decimal(4), "0.001");
  EXPECT_EQ(Exact::from_decimal("1.5e-7").decimal(21), "1.5e-7");
  EXPECT_EQ(Exact::from_decimal("-1e-300").decimal(21), "-1e-300");
  EXPECT_EQ(Exact::from_decimal("6.02214076e23").decimal(21), "6.02214076e23");
  EXPECT_EQ(Exact::pi().decimal(21), "3.14159265358979323846");
}

TEST(Exact, TextOfTwentyOneDigitsGivesTheLongDoubleBack) {
  test::Dice dice(2);
  for (int i = 0; i < 300; ++i) {
    const long double x =
        static_cast<long double>(dice.uniform(-5, 5)) / 3 + static_cast<long double>(dice.uniform(0, 1e-17));
    const auto high = static_cast<double>(x);
    const Exact exact = Exact::from_double(high) +
                        Exact::from_double(static_cast<double>(x - static_cast<long double>(high)));
    EXPECT_EQ(std::strtold(exact.decimal(21).c_str(), nullptr), x);
  }
}

TEST(Exact, HasOneKeyPerValue) {
  EXPECT_EQ(Exact::from_decimal("0.50").key(), Exact::ratio(1, 2).key());
  EXPECT_NE(Exact(1).key(), Exact(-1).key());
  EXPECT_NE(Exact::ratio(1, 3).key(), Exact::from_decimal("0.333333333333333333333").key());
}

TEST(Exact, FindsRationalRootsAndAngles) {
  EXPECT_EQ(sqrt(Exact::ratio(9, 4)), Exact::ratio(3, 2));
  EXPECT_TRUE(sqrt(Exact::ratio(9, 4)).is_rational());
  EXPECT_EQ(sin(Exact::pi() / Exact(6)), Exact::ratio(1, 2));
  EXPECT_TRUE(cos(Exact::pi() / Exact(2)).is_zero());
  EXPECT_EQ(cos(Exact::pi()), Exact(-1));
}

TEST(Exact, KeepsTheDigitsOfSmallAngles) {
  for (const unsigned digits : {50U, 128U}) {
    const WorkingDigits scope(digits);
    for (const char* text : {"1e-20", "1e-40", "1e-45", "1e-120"}) {
      const Exact x = Exact::from_decimal(text);
      EXPECT_LE(abs(sin(x) - x), x * x) << text;
    }
    // the double nearest pi/2: its cosine is small and not zero
    const Exact near = Exact::from_double(1.5707963267948966);
    EXPECT_EQ(cos(near).to_double(), 6.123233995736766e-17);
  }
}

TEST(Exact, KnowsItsFunctionsToTheWorkingDigits) {
  const Exact third = Exact::ratio(1, 3);
  const Exact tiny = Exact::from_decimal("1e-115");
  EXPECT_LE(abs(sin(third) * sin(third) + cos(third) * cos(third) - Exact(1)), tiny);
  EXPECT_LE(abs(asin(sin(third)) - third), tiny);
  EXPECT_LE(abs(acos(cos(third)) - third), tiny);
  EXPECT_LE(abs(log(exp(third)) - third), tiny);
  EXPECT_LE(abs(tan(third) * cos(third) - sin(third)), tiny);
  EXPECT_LE(abs(tanh(third) - (exp(third) - exp(-third)) / (exp(third) + exp(-third))), tiny);
  EXPECT_LE(abs(atan2(Exact(1), Exact(-1)) - Exact::pi() * Exact::ratio(3, 4)), tiny);
  EXPECT_LE(abs(sqrt(Exact(2)) * sqrt(Exact(2)) - Exact(2)), tiny);
  EXPECT_EQ(sign(-third), Exact(-1));
}

TEST(Exact, RefusesWhatHasNoRealValue) {
  EXPECT_THROW((void)sqrt(Exact(-1)), std::domain_error);
  EXPECT_THROW((void)log(Exact(0)), std::domain_error);
  EXPECT_THROW((void)asin(Exact(2)), std::domain_error);
  EXPECT_THROW((void)(Exact(1) / Exact(0)), std::domain_error);
  EXPECT_THROW((void)exp(Exact(100000000)), std::domain_error);
}

TEST(Exact, StaysBoundedWhenRationalsGrow) {
  Exact x = Exact::ratio(355, 113);
  for (int i = 0; i < 2000; ++i)
    x = x * Exact::ratio(355, 113) / Exact::ratio(22, 7) + Exact::ratio(1, 1000003);
  EXPECT_FALSE(x.is_rational());
  EXPECT_TRUE(std::isfinite(x.to_double()));
}

TEST(WorkingDigits, AreRestoredAtTheEndOfTheirScope) {
  const unsigned before = WorkingDigits::current();
  {
    const WorkingDigits scope(300);
    const Exact tiny = Exact::from_decimal("1e-290");
    EXPECT_LE(abs(sqrt(Exact(2)) * sqrt(Exact(2)) - Exact(2)), tiny);
  }
  EXPECT_EQ(WorkingDigits::current(), before);
}

TEST(Exact, KeepsTheDigitsOfSmallHyperbolicTangents) {
  const WorkingDigits scope(40);
  const Exact x = Exact::from_decimal("1e-30");  // tanh x = x - x^3/3
  EXPECT_LE(abs(tanh(x) - x), Exact::from_decimal("1e-68"));
}

TEST(Exact, IsTheOneZeroHoweverItCame) {
  const Exact zero = sqrt(Exact(2)) - sqrt(Exact(2));
  EXPECT_TRUE(zero.is_rational());
  EXPECT_EQ(zero.key(), Exact(0).key());
}

TEST(WorkingDigits, AreNeverSoFewThatSinesAreRoundedToRationals) {
  const WorkingDigits scope(15);
  const Exact x = Exact::pi() / Exact(6) + Exact::from_decimal("1e-20");
  EXPECT_GT(sin(x), Exact::ratio(1, 2));
}

}  // namespace
}  // namespace anholon::exact_test
