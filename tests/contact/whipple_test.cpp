// SPDX-License-Identifier: GPL-2.0-or-later
//
// The bicycle with declared wheels against the benchmark of Meijaard, Papadopoulos, Ruina and Schwab (2007),
// whose equations were derived by hand and checked with other programs:
//   M q'' + v C1 q' + (g K0 + v^2 K2) q = 0,   q = (lean, steer).
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "contact/program_values.hpp"

namespace anholon::test::whipple_test {
namespace {

using Two = Eigen::Matrix<long double, 2, 2>;

long double long_double(const Exact& x) { return FromExact<long double>{}(x); }

/// Coefficients of the linearised program at a forward speed.
struct Linear {
  Two M, damping, stiffness;
};

Linear linearised(const ProgramValues& program, const Exact& v) {
  const Exact g_radius = Exact::from_decimal("0.3");
  const Inputs straight = {{"nu", {0, 0, -v / g_radius}}};  // forward is -y for axes with z down
  const Inputs lean = {{"R", {0, 0, 0, 0, 0, -1, 0, 1, 0}}};
  const Inputs steer = {{"r_p", {0, 1, 0}}};
  const auto column = [&](const Inputs& direction) {
    return program.derivative("reduced_dynamics", "f_r", straight, direction);
  };
  Linear linear;
  const Values M = program("reduced_dynamics", "M_r", straight);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) linear.M(i, j) = long_double(M[static_cast<std::size_t>(3 * i + j)]);
    const auto at = static_cast<std::size_t>(i);
    linear.stiffness(i, 0) = -long_double(column(lean)[at]);
    linear.stiffness(i, 1) = -long_double(column(steer)[at]);
    linear.damping(i, 0) = -long_double(column({{"nu", {1, 0, 0}}})[at]);
    linear.damping(i, 1) = -long_double(column({{"nu", {0, 1, 0}}})[at]);
  }
  return linear;
}

struct Whipple : ::testing::Test {
  ProgramValues program{"whipple_bicycle", {}, {"kinematics", "reduced_dynamics"}};
  const Two M = (Two() << 80.81722L, 2.31941332208709L, 2.31941332208709L, 0.29784188199686L).finished();
  const Two C1 = (Two() << 0, 33.86641391492494L, -0.85035641456978L, 1.68540397397560L).finished();
  const Two K0 = (Two() << -80.95L, -2.59951685249872L, -2.59951685249872L, -0.80329488458618L).finished();
  const Two K2 = (Two() << 0, 76.59734589573222L, 0, 2.65431523794604L).finished();
};

/// The published figures have 14 decimals.
constexpr long double published = 1e-12L;

TEST_F(Whipple, HasThreeFreedomsWithLeanSteerAndRearWheelAsVelocities) {
  EXPECT_EQ(program.derivation().reduction.kernel.free.size(), 3U);
  EXPECT_FALSE(program.derivation().reduction.kernel.content_divided);
  const Values M_r = program("reduced_dynamics", "M_r", {});
  EXPECT_EQ(M_r[2].to_double(), 0);  // upright, rolling is apart from lean and steer
  EXPECT_EQ(M_r[5].to_double(), 0);
}

TEST_F(Whipple, GivesTheCoefficientsOfTheBenchmark) {
  const Linear still = linearised(program, 0);
  const Linear one = linearised(program, 1);
  const Linear three = linearised(program, 3);
  EXPECT_LT((still.M - M).cwiseAbs().maxCoeff(), published);
  EXPECT_LT((still.stiffness - 9.81L * K0).cwiseAbs().maxCoeff(), 10 * published);  // times g
  EXPECT_LT(still.damping.cwiseAbs().maxCoeff(), published);
  EXPECT_LT((one.damping - C1).cwiseAbs().maxCoeff(), published);
  EXPECT_LT((one.stiffness - still.stiffness - K2).cwiseAbs().maxCoeff(), published);
  EXPECT_LT((three.damping - 3 * C1).cwiseAbs().maxCoeff(), 3 * published);
  EXPECT_LT((three.stiffness - still.stiffness - 9 * K2).cwiseAbs().maxCoeff(), 9 * published);
}

/// Roots of det(M s^2 + D s + K), long double.
std::vector<std::complex<long double>> eigenvalues(const Linear& x) {
  Eigen::Matrix<long double, 4, 4> A;
  A.setZero();
  A.topRightCorner<2, 2>().setIdentity();
  const Two inverse = x.M.inverse();
  A.bottomLeftCorner<2, 2>() = -inverse * x.stiffness;
  A.bottomRightCorner<2, 2>() = -inverse * x.damping;
  const Eigen::EigenSolver<Eigen::Matrix<long double, 4, 4>> solver(A, false);
  std::vector<std::complex<long double>> roots(solver.eigenvalues().begin(), solver.eigenvalues().end());
  std::ranges::sort(roots, [](const auto& a, const auto& b) {
    return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag());
  });
  return roots;
}

TEST_F(Whipple, GivesTheEigenvaluesOfTheBenchmark) {
  for (int speed = 0; speed <= 10; ++speed) {
    SCOPED_TRACE(speed);
    const long double v = speed;
    const auto got = eigenvalues(linearised(program, speed));
    const auto want = eigenvalues({M, v * C1, 9.81L * K0 + v * v * K2});
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(std::abs(got[i] - want[i]), 1e-11L) << got[i];
  }
}

/// The speed in [low, high] at which `stability` changes sign.
template <class Function>
double root(double low, double high, const Function& stability) {
  const bool rises = stability(high) > 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    ((stability(middle) > 0) == rises ? high : low) = middle;
  }
  return low;
}

TEST_F(Whipple, IsStableBetweenWeaveAndCapsizeSpeed) {
  const auto largest_real = [&](double v) {  // of all four
    long double most = -1e9L;
    for (const auto& s : eigenvalues(linearised(program, Exact::from_double(v))))
      most = std::max(most, s.real());
    return most;
  };
  EXPECT_NEAR(root(4, 4.6, largest_real), 4.29238253634111, 1e-11);
  EXPECT_NEAR(root(5.5, 6.5, largest_real), 6.02426201538837, 1e-11);
}

}  // namespace
}  // namespace anholon::test::whipple_test
