// SPDX-License-Identifier: GPL-2.0-or-later

// The batch of sines and cosines that generated headers carry, against long double and against CLN.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "number/exact.hpp"

namespace anholon::sines_cosines_test {
namespace {

namespace detail {
#include "../../templates/sines_cosines.inl"
}  // namespace detail

constexpr double bound = 0.9;  // ulp, as the template says; the worst seen in millions of draws is 0.83
constexpr int lanes = 8;

double ulp(double value) {
  const double x = std::fabs(value);
  return std::nextafter(x, std::numeric_limits<double>::infinity()) - x;
}

struct Worst {
  double ulps = 0, angle = 0;
  void note(double error, double x) {
    if (error > ulps) ulps = error, angle = x;
  }
};

/// Worst error over a list of angles. @param reference  (x, is_sine, computed) -> error in ulp
template <class Reference>
Worst worst_over(const std::vector<double>& angles, const Reference& reference) {
  Worst worst;
  for (std::size_t i = 0; i + lanes <= angles.size(); i += lanes) {
    double x[lanes], s[lanes], c[lanes];
    for (int j = 0; j < lanes; ++j) x[j] = angles[i + static_cast<std::size_t>(j)];
    detail::sines_cosines(x, s, c);
    for (int j = 0; j < lanes; ++j) {
      worst.note(reference(x[j], true, s[j]), x[j]);
      worst.note(reference(x[j], false, c[j]), x[j]);
    }
  }
  return worst;
}

double error_by_long_double(double x, bool is_sine, double got) {
  const long double exact =
      is_sine ? std::sin(static_cast<long double>(x)) : std::cos(static_cast<long double>(x));
  return static_cast<double>(std::fabs(got - exact)) / ulp(static_cast<double>(exact));
}

double error_by_cln(double x, bool is_sine, double got) {
  const Exact angle = Exact::from_double(x);
  const Exact exact = is_sine ? sin(angle) : cos(angle);
  return std::fabs((Exact::from_double(got) - exact).to_double()) / ulp(exact.to_double());
}

/// Sizes from 1e-12 to the end of the batch's range, both signs, and what joints are at most of the time.
std::vector<double> random_angles(int count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> exponent(std::log(1e-12), std::log(0x1p20));
  std::uniform_real_distribution<double> turn(-3.2, 3.2);
  std::vector<double> angles;
  for (int i = 0; i < count; ++i) {
    const double x = std::exp(exponent(random));
    angles.push_back(i % 3 == 0 ? turn(random) : i % 3 == 1 ? x : -x);
  }
  return angles;
}

/// The doubles next to multiples of pi/2 and of pi/4: nearly all digits cancel, or the polynomials end.
std::vector<double> hard_angles(int count, int step) {
  std::vector<double> angles;
  for (int k = 1; static_cast<int>(angles.size()) < count && k < (1 << 21); k += step) {
    const double x = (Exact::pi() * Exact(k) / Exact(4)).to_double();
    if (x < 0x1p20) angles.insert(angles.end(), {x, -x, std::nextafter(x, 0), std::nextafter(x, 1e9)});
  }
  return angles;
}

TEST(SinesCosines, StayWithinTheStatedBoundOfLongDouble) {
  const Worst worst = worst_over(random_angles(300000), error_by_long_double);
  EXPECT_LT(worst.ulps, bound) << "at " << worst.angle;
  EXPECT_GT(worst.ulps, 0.5);  // or nothing was measured
}

TEST(SinesCosines, StayWithinTheStatedBoundOfCln) {
  std::vector<double> angles = random_angles(600);
  for (const int step : {1, 1103}) {
    const std::vector<double> hard = hard_angles(1200, step);
    angles.insert(angles.end(), hard.begin(), hard.end());
  }
  const Worst worst = worst_over(angles, error_by_cln);
  EXPECT_LT(worst.ulps, bound) << "at " << worst.angle;
}

TEST(SinesCosines, AreThoseOfTheLibraryBeyondTheirRangeAndExactAtZero) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const double x[lanes] = {0.0, 0x1.000001p20, -1e22, 1e300, inf, -inf, nan, 0x1p-1060};
  double s[lanes], c[lanes];
  detail::sines_cosines(x, s, c);
  EXPECT_EQ(s[0], 0.0);
  EXPECT_EQ(c[0], 1.0);
  for (int i = 1; i < 4; ++i) {
    EXPECT_EQ(s[i], std::sin(x[i]));
    EXPECT_EQ(c[i], std::cos(x[i]));
  }
  for (int i = 4; i < 7; ++i) {
    EXPECT_TRUE(std::isnan(s[i]));
    EXPECT_TRUE(std::isnan(c[i]));
  }
  EXPECT_EQ(s[7], x[7]);
  EXPECT_EQ(c[7], 1.0);
}

TEST(SinesCosines, AreThoseOfTheLibraryForOtherScalars) {
  const float x[4] = {0.1F, -2.0F, 30.0F, 1e9F};
  float s[4], c[4];
  detail::sines_cosines(x, s, c);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(s[i], std::sin(x[i]));
    EXPECT_EQ(c[i], std::cos(x[i]));
  }
}

}  // namespace
}  // namespace anholon::sines_cosines_test
