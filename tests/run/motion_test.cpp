// SPDX-License-Identifier: GPL-2.0-or-later
//
// Imposed motion from a table, and the monitors.
#include "anholon/motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "anholon/monitors.hpp"

namespace anholon::testing::motion_test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using Motion = TabulatedMotion<double>;

struct Sample {
  VectorXd r, r_dot, r_ddot;
};
Sample at(const Motion& motion, double t) {
  Sample sample{VectorXd(motion.size()), VectorXd(motion.size()), VectorXd(motion.size())};
  motion.evaluate(t, sample.r, sample.r_dot, sample.r_ddot);
  return sample;
}

const std::vector<double> uneven_times = {-1, -0.4, 0.3, 0.5, 1.4, 2};

TEST(TabulatedMotion, ClampedSplineReproducesACubic) {
  const auto cubic = [](double t) { return 2 - t + 3 * t * t - 0.5 * t * t * t; };
  const auto slope = [](double t) { return -1 + 6 * t - 1.5 * t * t; };
  MatrixXd values(6, 2), slopes(2, 2);
  for (int i = 0; i < 6; ++i) values.row(i) << cubic(uneven_times[i]), -2 * cubic(uneven_times[i]);
  slopes << slope(-1), -2 * slope(-1), slope(2), -2 * slope(2);
  const Motion motion(uneven_times, values, SplineEnds::clamped, slopes);
  for (double t = -1; t <= 2; t += 0.01) {
    SCOPED_TRACE(::testing::Message() << "t " << t);
    const Sample sample = at(motion, t);
    EXPECT_LT((sample.r - cubic(t) * Vector2d(1, -2)).norm(), 2e-14);          // values up to 16
    EXPECT_LT((sample.r_dot - slope(t) * Vector2d(1, -2)).norm(), 1e-12);      // values/h with h = 0.2
    EXPECT_LT((sample.r_ddot - (6 - 3 * t) * Vector2d(1, -2)).norm(), 1e-11);  // values/h^2
  }
}

TEST(TabulatedMotion, PassesThroughItsTableTwiceDifferentiably) {
  MatrixXd values(6, 1);
  values << 1, -2, 0.5, 3, 2, 1;  // also closes, for the periodic one
  MatrixXd slopes(2, 1);
  slopes << 0.7, -3;
  for (const SplineEnds ends : {SplineEnds::natural, SplineEnds::clamped, SplineEnds::periodic}) {
    SCOPED_TRACE(::testing::Message() << "ends " << static_cast<int>(ends));
    const Motion motion(uneven_times, values, ends, slopes);
    for (int i = 0; i < 6; ++i) {
      const double t = uneven_times[i], small = 1e-9;
      EXPECT_NEAR(at(motion, t).r[0], values(i, 0), 1e-14);
      const Sample before = at(motion, t - small), after = at(motion, t + small);
      EXPECT_NEAR(before.r[0], after.r[0], 1e-7);                       // slopes up to 50
      EXPECT_NEAR(before.r_dot[0], after.r_dot[0], 1e-6);               // second derivatives up to 300
      if (ends == SplineEnds::clamped && (i == 0 || i == 5)) continue;  // straight on beyond
      EXPECT_NEAR(before.r_ddot[0], after.r_ddot[0], 1e-5);             // third derivatives up to 3000
    }
    // the derivatives are those of the value
    for (double t = -0.95; t < 2; t += 0.1) {
      const double h = 1e-4;
      const Sample before = at(motion, t - h), here = at(motion, t), after = at(motion, t + h);
      EXPECT_NEAR((after.r[0] - before.r[0]) / (2 * h), here.r_dot[0], 1e-4);          // h^2 r''' + kinks h^2
      EXPECT_NEAR((after.r_dot[0] - before.r_dot[0]) / (2 * h), here.r_ddot[0], 0.3);  // h r''' at a knot
    }
  }
}

TEST(TabulatedMotion, EndsAsAsked) {
  MatrixXd values(6, 1), slopes(2, 1);
  values << 1, -2, 0.5, 3, 2, 1;
  slopes << 0.7, -3;
  const Motion natural(uneven_times, values);
  EXPECT_NEAR(at(natural, -1).r_ddot[0], 0, 1e-13);
  EXPECT_NEAR(at(natural, 2).r_ddot[0], 0, 1e-13);
  EXPECT_NEAR(at(natural, 3).r[0], 1 + at(natural, 2).r_dot[0], 1e-13);  // straight on
  EXPECT_EQ(at(natural, 3).r_ddot[0], 0);
  const Motion clamped(uneven_times, values, SplineEnds::clamped, slopes);
  EXPECT_NEAR(at(clamped, -1).r_dot[0], 0.7, 1e-13);
  EXPECT_NEAR(at(clamped, 2).r_dot[0], -3, 1e-13);
  EXPECT_NEAR(at(clamped, -2).r[0], 1 - 0.7, 1e-13);
  const Motion periodic(uneven_times, values, SplineEnds::periodic);
  for (double t = -1; t < 2; t += 0.1) {
    EXPECT_NEAR(at(periodic, t).r[0], at(periodic, t + 9).r[0], 1e-13);  // slope 20, rounding of t + 9
    EXPECT_NEAR(at(periodic, t).r_ddot[0], at(periodic, t - 6).r_ddot[0], 1e-11);
  }
}

TEST(TabulatedMotion, PeriodicSplineOfASineErrsWithTheFourthPowerOfTheInterval) {
  std::vector<double> errors, accelerations;
  for (int n : {16, 32, 64}) {
    std::vector<double> times;
    MatrixXd values(n + 1, 1);
    for (int i = 0; i <= n; ++i) {
      times.push_back(2 * M_PI * i / n);
      values(i, 0) = std::sin(2 * M_PI * i / n);
    }
    const Motion motion(times, values, SplineEnds::periodic);
    double worst = 0, worst_acceleration = 0;
    for (int i = 0; i < 1000; ++i) {
      const double t = 0.05 * i;
      worst = std::max(worst, std::abs(at(motion, t).r[0] - std::sin(t)));
      worst_acceleration = std::max(worst_acceleration, std::abs(at(motion, t).r_ddot[0] + std::sin(t)));
    }
    errors.push_back(worst);
    accelerations.push_back(worst_acceleration);
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[2]) / 2, 4, 0.1);
  EXPECT_NEAR(std::log2(accelerations[0] / accelerations[2]) / 2, 2, 0.1);
}

TEST(TabulatedMotion, NaturalSplineOfTwoRowsIsALine) {
  MatrixXd values(2, 1);
  values << 1, 4;
  const Motion motion({0, 2}, values);
  EXPECT_DOUBLE_EQ(at(motion, 0.5).r[0], 1.75);
  EXPECT_DOUBLE_EQ(at(motion, 0.5).r_dot[0], 1.5);
}

TEST(TabulatedMotion, RefusesATableThatIsNoFunctionOfTime) {
  const MatrixXd values = MatrixXd::Ones(4, 1);
  const auto message = [&](const std::vector<double>& times, const MatrixXd& rows,
                           SplineEnds ends) -> std::string {
    try {
      Motion(times, rows, ends);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({0, 1, 1, 2}, values, SplineEnds::natural),
            "motion table: times must increase, but that of row 2 does not exceed the one before");
  EXPECT_EQ(message({0, 1, 2}, values, SplineEnds::natural),
            "motion table: expected as many times as rows, found 3 times and 4 rows");
  EXPECT_EQ(message({0}, values.topRows(1), SplineEnds::natural),
            "motion table: expected at least 2 rows, found 1");
  EXPECT_EQ(message({0, 1, 2, 3}, values, SplineEnds::clamped),
            "motion table: clamped ends need 2 x 1 finite slopes, found 0 x 0");
  MatrixXd open = values;
  open(3, 0) = 2;
  EXPECT_EQ(message({0, 1, 2, 3}, open, SplineEnds::periodic),
            "motion table: periodic ends need the last row equal to the first, but column 0 differs");
  open(3, 0) = std::nan("");
  EXPECT_EQ(message({0, 1, 2, 3}, open, SplineEnds::natural),
            "motion table: row 3 has a value that is not finite");
}

TEST(OrthonormalityDefect, IsTwiceAStretch) {
  const double stretch = 1e-6;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix();
  EXPECT_LT(orthonormality_defect(turn), 2e-15);  // rounding of 9 entries
  const Eigen::Matrix3d stretched = turn * Eigen::Vector3d(1 + stretch, 1, 1).asDiagonal();
  EXPECT_NEAR(orthonormality_defect(stretched), 2 * stretch, 2e-12);  // plus stretch^2
}

TEST(EnergyBalance, CountsWhatCameInAndWhatWentOut) {
  EnergyBalance<double> balance(10, 2);
  EXPECT_DOUBLE_EQ(balance.observe(12.5, 3, 0.5), 0);
  EXPECT_DOUBLE_EQ(balance.observe(12, 3, 0.5), -0.25);
  EXPECT_NEAR(balance.observe(10.1), 0.05, 1e-15);  // rounding of 10.1
  EXPECT_DOUBLE_EQ(balance.largest(), 0.25);
  balance.observe(std::nan(""));
  balance.observe(10);
  EXPECT_TRUE(std::isnan(balance.largest()));  // never hides a failure
}

TEST(ConstraintResidual, IsTheWorstRow) {
  MatrixXd A(2, 3);
  A << 1, 2, -3,  //
      4, 0, 1;
  const Eigen::Vector3d v(1, 1, 1.5);
  EXPECT_DOUBLE_EQ(constraint_residual(A, v), 5.5);
  EXPECT_DOUBLE_EQ(relative_constraint_residual(A, v), 5.5 / 7.5);
  A(0, 0) = std::nan("");  // of the first row, behind which a sound one stands
  EXPECT_TRUE(std::isnan(constraint_residual(A, v)));
  EXPECT_EQ(constraint_residual(MatrixXd(0, 3), v), 0);
  EXPECT_EQ(relative_constraint_residual(MatrixXd(0, 3), v), 0);
}

}  // namespace
}  // namespace anholon::testing::motion_test
