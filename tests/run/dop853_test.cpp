// SPDX-License-Identifier: GPL-2.0-or-later
//
// DOP853 with step control: accuracy follows the tolerance, dense output meets it and is paid for once.
#include "anholon/integrate/dop853.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "run/lie_samples.hpp"
#include "run/manufactured_motion.hpp"

namespace anholon::testing::dop853_test {
namespace {

using Eigen::VectorXd;
using integrate::AdaptiveOptions;
using integrate::Dop853;
using integrate::State;
using lie::SE3;

template <class Real>
AdaptiveOptions<Real> tolerance(long double value) {
  AdaptiveOptions<Real> options;
  options.rtol = options.atol = Real(value);
  return options;
}

TEST(Dop853, ErrorIsProportionalToTheTolerance) {
  const ManufacturedMotion<SE3<double>> motion;
  Dop853<SE3<double>> stages(decltype(motion)::size_y);
  std::vector<double> errors;
  for (int exponent = -3; exponent >= -12; --exponent) {
    SCOPED_TRACE(::testing::Message() << "tolerance 1e" << exponent);
    const double allowed = std::pow(10.0, exponent);
    State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
    const auto result = integrate_adaptive(stages, motion, state, 2.0, tolerance<double>(allowed));
    ASSERT_TRUE(result);
    errors.push_back(motion.error(2, state.g, state.y));
    // 4 to 40 steps, each with an error below what the estimate of order 7 says
    EXPECT_LT(errors.back(), 5 * allowed);
  }
  const double slope = std::log10(errors.front() / errors.back()) / 9;
  EXPECT_NEAR(slope, 1, 0.1);  // measured 0.99
}

TEST(Dop853, EvaluatesTwelveTimesAStepAndThreeMoreWhereOutputIsWanted) {
  const ManufacturedMotion<SE3<double>> motion;
  Dop853<SE3<double>> stages(decltype(motion)::size_y);
  State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
  const auto plain = integrate_adaptive(stages, motion, state, 2.0, tolerance<double>(1e-8));
  EXPECT_EQ(plain.evaluations, motion.evaluations);
  // one at the start, one to choose the first step
  EXPECT_EQ(plain.evaluations, 2 + 12 * (plain.accepted_steps + plain.rejected_steps));

  motion.evaluations = 0;
  state = {0, motion.pose(0), motion.y(0)};
  const std::vector<double> times = {0.001, 0.002, 0.003, 2};  // three in the first step, one at the end
  const auto result = integrate_adaptive_at(stages, motion, state, times, tolerance<double>(1e-8),
                                            [](double, const auto&, const VectorXd&) {});
  EXPECT_EQ(result.evaluations, plain.evaluations + 3);
  EXPECT_EQ(result.evaluations, motion.evaluations);
}

TEST(Dop853, ReportsTheStateAtTheTimesWithinTheTolerance) {
  const ManufacturedMotion<SE3<double>> motion;
  Dop853<SE3<double>> stages(decltype(motion)::size_y);
  std::vector<double> times, seen;
  for (int i = 0; i <= 1000; ++i) times.push_back(0.002 * i);
  State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
  double worst = 0;
  const auto result = integrate_adaptive_at(stages, motion, state, times, tolerance<double>(1e-9),
                                            [&](double t, const auto& g, const VectorXd& y) {
                                              seen.push_back(t);
                                              worst = std::max(worst, motion.error(t, g, y));
                                            });
  EXPECT_TRUE(result);
  EXPECT_EQ(seen, times);
  EXPECT_LT(result.accepted_steps, 60);  // the times do not shorten the steps
  EXPECT_LT(worst, 1e-8);                // measured 1.4e-9
}

TEST(Dop853, WorksInFloatAndLongDouble) {
  {
    const ManufacturedMotion<SE3<float>> motion;
    Dop853<SE3<float>> stages(decltype(motion)::size_y);
    State<SE3<float>> state{0, motion.pose(0), motion.y(0)};
    ASSERT_TRUE(integrate_adaptive(stages, motion, state, 1.0f, tolerance<float>(1e-4L)));
    EXPECT_LT(motion.error(1, state.g, state.y), 1e-3f);
  }
  {
    const ManufacturedMotion<SE3<long double>> motion;
    Dop853<SE3<long double>> stages(decltype(motion)::size_y);
    State<SE3<long double>> state{0, motion.pose(0), motion.y(0)};
    ASSERT_TRUE(integrate_adaptive(stages, motion, state, 1.0L, tolerance<long double>(1e-17L)));
    EXPECT_LT(motion.error(1, state.g, state.y), 1e-16L);
  }
}

}  // namespace
}  // namespace anholon::testing::dop853_test
