// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/kernel_core.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "algebra/lowering.hpp"
#include "algebra/prove.hpp"
#include "algebra/tape_samples.hpp"

namespace anholon::kernel_core_test {
namespace {

using test::entries;
using test::input;
using test::Matrix;
using test::text;

/// A H = 0, A J = -B and H of full rank in its free rows, at random points, to 60 digits.
void expect_kernel(const Tape& tape, const Matrix& A, const Matrix& B, const KernelCore& core) {
  std::mt19937_64 rng(20130922);
  const std::size_t columns = core.H.size();
  const std::size_t k = columns == 0 ? 0 : core.H[0].size();
  const std::size_t inputs = B.empty() ? 0 : B[0].size();
  for (int sample = 0; sample < 5; ++sample) {
    const auto point = test::random_point(tape, rng);
    const auto a = test::values(tape, entries(A), point);
    const auto b = test::values(tape, entries(B), point);
    const auto h = test::values(tape, entries(core.H), point);
    const auto j = test::values(tape, entries(core.J), point);
    for (std::size_t row = 0; row < A.size(); ++row) {
      for (std::size_t f = 0; f < k; ++f) {
        Exact sum = 0;
        for (std::size_t c = 0; c < columns; ++c) sum += a[row * columns + c] * h[c * k + f];
        EXPECT_TRUE(test::vanishes(sum)) << "row " << row << " of A H: " << sum.decimal(6);
      }
      for (std::size_t i = 0; i < inputs; ++i) {
        Exact sum = b[row * inputs + i];
        for (std::size_t c = 0; c < columns; ++c) sum += a[row * columns + c] * j[c * inputs + i];
        EXPECT_TRUE(test::vanishes(sum)) << "row " << row << " of A J + B: " << sum.decimal(6);
      }
    }
  }
}

std::size_t divisions(const Tape& tape, const Matrix& m) {
  std::size_t count = 0;
  for (const NodeId id : tape.reachable(entries(m))) count += tape.node(id).op == Op::div ? 1 : 0;
  return count;
}

TEST(KernelCore, OfTheRigidSnakeboardHasNoCommonFactor) {
  Tape tape;
  const Expr r = input(tape, "r1");
  const Expr l = input(tape, "l");
  const Expr c = cos(r);
  const Expr s = sin(r);
  const Matrix A = test::matrix(tape, {{-s, c, -(l * c)}, {s, c, l * c}});
  const Matrix B(2);
  for (const int free : {0, 2}) {
    const auto core = kernel_core(tape, A, B, {free});
    ASSERT_TRUE(core);
    expect_kernel(tape, A, B, *core);
    EXPECT_EQ(entries(core->H),
              entries(test::matrix(tape, free == 2 ? std::vector<std::vector<Expr>>{{-(l * c)}, {0}, {s}}
                                                   : std::vector<std::vector<Expr>>{{l * c}, {0}, {-s}})));
  }
  EXPECT_FALSE(kernel_core(tape, A, B, {1})) << "V_Y is zero, so it cannot be the free velocity";
}

TEST(KernelCore, OfTheSnakeboardKeepsItsDirectionWhereTheRankDrops) {
  Tape tape;
  const Expr r = input(tape, "r1");
  const Expr l = input(tape, "l");
  const Matrix A = test::matrix(tape, {{-sin(r), cos(r), -(l * cos(r))}, {sin(r), cos(r), l * cos(r)}});
  const auto core = kernel_core(tape, A, Matrix(2), {2});
  ASSERT_TRUE(core);
  const std::vector<double> point{std::numbers::pi / 2, 0.3};
  const auto h = interpret<double>(tape, entries(core->H), point);
  EXPECT_NEAR(h[0], 0, 1e-16);
  EXPECT_EQ(h[2], 1);
}

TEST(KernelCore, OfTheBicycleIsTheTiltVelocity) {
  Tape tape;
  const Expr r1 = input(tape, "r1");
  const Expr alpha = input(tape, "alpha");
  const Expr l2 = input(tape, "l2");
  const Expr l3 = input(tape, "l3");
  const Expr h = input(tape, "h");
  const Expr c1 = cos(r1), s1 = sin(r1), ca = cos(alpha), sa = sin(alpha);
  // Boyer & Belkhiri 2013, eqs. (46)-(47); columns V_X, V_Y, V_Z, Omega_X, Omega_Y, Omega_Z, r2_dot.
  const Matrix A = test::matrix(tape, {{1, 0, 0, 0, 0, 0, 0},
                                       {0, 1, 0, 0, 0, 0, 0},
                                       {0, 0, 1, -l3, 0, 0, 0},
                                       {0, -c1, -(ca * s1), -(l2 * ca * s1), 0, 0, h},
                                       {-(sa * s1), -(ca * s1), c1, l2 * c1, 0, l2 * sa * c1, 0},
                                       {0, 0, 0, 0, 0, 1, 0}});
  const Matrix B = test::matrix(tape, {{0, 0}, {0, -h}, {0, 0}, {h * sa * ca * s1, 0}, {0, 0}, {0, 0}});
  const auto core = kernel_core(tape, A, B, {4});
  ASSERT_TRUE(core);
  expect_kernel(tape, A, B, *core);
  EXPECT_EQ(entries(core->H), entries(test::matrix(tape, {{0}, {0}, {0}, {0}, {1}, {0}, {0}})));
  const Expr tan1 = s1 / c1;
  const Expr psi = h * ca * tan1 / (l2 + l3);   // (52)
  const Expr front = c1 + ca * ca * s1 * tan1;  // (53)
  const auto J = entries(core->J);
  const auto expected = entries(test::matrix(
      tape, {{0, 0}, {0, h}, {0, psi * l3}, {0, psi}, {0, 0}, {0, 0}, {-(sa * ca * s1), front}}));  // (54)
  for (std::size_t i = 0; i < J.size(); ++i)
    EXPECT_TRUE(test::provably_equal(tape, J[i], expected[i])) << text(tape, J[i]);
  EXPECT_EQ(divisions(tape, core->J), 2U) << "by cos r1 (l2 + l3) and by cos r1";
  EXPECT_LE(operation_weight(tape, J), 204U);
}

/// Axle of a planar chain of links of half length l, r[i] the joint between links i and i + 1, in the axes of
/// link 0: row over (V_X, V_Y, Omega_Z, r_dot).
struct Snake {
  Matrix A;
  Matrix joints;
};
Snake snake(Tape& tape, int links) {
  const Expr l = input(tape, "l");
  std::vector<Expr> r;
  for (int i = 1; i < links; ++i) r.push_back(input(tape, "r" + std::to_string(i)));
  std::vector<std::vector<Expr>> A, joints;
  for (int i = 0; i < links; ++i) {
    // Backwards from axle i: its lateral velocity is  n . (V at the centre of link i).
    Expr c = 1, s = 0, lateral_of_turn = 0;  // n = (-s, c)
    std::vector<Expr> by_joint(r.size(), 0);
    // Position of the axle from joint k, ..., from link 0's centre, along the links of angle phi_j.
    std::vector<Expr> cosine{1}, sine{0};
    for (int j = 0; j < i; ++j) {
      const auto u = static_cast<std::size_t>(j);
      cosine.push_back(cosine[u] * cos(r[u]) - sine[u] * sin(r[u]));
      sine.push_back(sine[u] * cos(r[u]) + cosine[u] * sin(r[u]));
    }
    c = cosine.back();
    s = sine.back();
    const auto cross = [&](int j) {  // n . (z x (along link j)) = cos(phi_i - phi_j)
      const auto u = static_cast<std::size_t>(j);
      return c * cosine[u] + s * sine[u];
    };
    for (int j = 0; j <= i; ++j) {
      const Expr arm = (j == 0 || j == i) ? (i == 0 ? Expr(0) : l) : Expr(2) * l;
      lateral_of_turn += arm * cross(j);
      for (int k = 0; k < j; ++k) by_joint[static_cast<std::size_t>(k)] += arm * cross(j);
    }
    A.push_back({-s, c, lateral_of_turn});
    joints.push_back(by_joint);
  }
  return {test::matrix(tape, A), test::matrix(tape, joints)};
}

TEST(KernelCore, OfTheWheeledSnakeIsEmptyAndItsMotionIsKinematic) {
  Tape tape;
  const Snake three = snake(tape, 3);
  const auto core = kernel_core(tape, three.A, three.joints, {});
  ASSERT_TRUE(core);
  EXPECT_EQ(core->H.size(), 3U);
  EXPECT_TRUE(core->H[0].empty());
  expect_kernel(tape, three.A, three.joints, *core);
  EXPECT_LE(divisions(tape, core->J), 1U);
}

TEST(KernelCore, OfTheSnakeWithFreeVelocitiesIsRegularEverywhere) {
  Tape tape;
  const Snake three = snake(tape, 3);
  Matrix A = three.A;
  for (std::size_t i = 0; i < 3; ++i) A[i].insert(A[i].end(), three.joints[i].begin(), three.joints[i].end());
  const auto core = kernel_core(tape, A, Matrix(3), {0, 2});
  ASSERT_TRUE(core);
  expect_kernel(tape, A, Matrix(3), *core);
  EXPECT_EQ(divisions(tape, core->H), 0U);
  const auto h = entries(core->H);
  EXPECT_EQ(h[0], tape.input_node(0)) << "V_X: the half length";
  EXPECT_TRUE(tape.is_one(h[5])) << "Omega_Z";
}

TEST(KernelCore, OfTheDifferentialDriveIsConstant) {
  Tape tape;
  const Expr w = input(tape, "w");  // half track
  const Expr R = input(tape, "R");
  // V_X, V_Y, Omega_Z, left and right wheel
  const Matrix A = test::matrix(tape, {{0, 1, 0, 0, 0}, {1, 0, -w, -R, 0}, {1, 0, w, 0, -R}});
  for (const auto& free : {std::vector{0, 2}, std::vector{3, 4}}) {
    const auto core = kernel_core(tape, A, Matrix(3), free);
    ASSERT_TRUE(core);
    expect_kernel(tape, A, Matrix(3), *core);
    EXPECT_EQ(divisions(tape, core->H), 0U);
  }
}

TEST(KernelCore, TakesOtherFunctionsAsSymbols) {
  Tape tape;
  const Expr a = input(tape, "a");
  const Expr b = input(tape, "b");
  const Expr root = sqrt(a * a + b * b);
  Expr many = 0;  // outgrows the bound of an entry
  for (int i = 0; i < 12; ++i) many += input(tape, "x" + std::to_string(i));
  const Expr square = many * many;
  const Matrix A = test::matrix(tape, {{root * a, root * b, root * a}, {square, exp(a), square * b / a}});
  const Matrix B = test::matrix(tape, {{atan2(a, b)}, {square}});
  const auto core = kernel_core(tape, A, B, {2});
  ASSERT_TRUE(core);
  expect_kernel(tape, A, B, *core);
}

TEST(KernelCore, OfNoConstraintIsEverything) {
  Tape tape;
  const auto core = kernel_core(tape, {}, {}, {0, 1});
  ASSERT_TRUE(core);
  EXPECT_EQ(entries(core->H), entries(test::matrix(tape, {{1, 0}, {0, 1}})));
}

TEST(KernelCore, GivesUpOnLargeDenseBlocksOnly) {
  Tape tape;
  const auto dense = [&](int rows, int columns) {
    std::vector<std::vector<Expr>> m;
    for (int i = 0; i < rows; ++i) {
      auto& row = m.emplace_back();
      for (int j = 0; j < columns; ++j) row.push_back(input(tape, "a" + std::to_string(10 * i + j)));
    }
    return test::matrix(tape, m);
  };
  const Matrix four = dense(4, 5);
  const auto core = kernel_core(tape, four, Matrix(4), {4});
  ASSERT_TRUE(core);
  expect_kernel(tape, four, Matrix(4), *core);
  EXPECT_FALSE(kernel_core(tape, dense(5, 6), Matrix(5), {5}));

  // Six rows that fall apart into 2 + 2 + 2.
  Matrix six(6, std::vector<NodeId>(7, tape.constant(0)));
  for (std::size_t block = 0; block < 3; ++block) {
    const Matrix m = dense(2, 3);
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t j = 0; j < 2; ++j) six[2 * block + i][2 * block + j] = m[i][j];
      six[2 * block + i][6] = m[i][2];
    }
  }
  const auto blocks = kernel_core(tape, six, Matrix(6), {6});
  ASSERT_TRUE(blocks);
  expect_kernel(tape, six, Matrix(6), *blocks);
}

}  // namespace
}  // namespace anholon::kernel_core_test
