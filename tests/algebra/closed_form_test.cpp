// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/closed_form.hpp"

#include <gtest/gtest.h>

#include "algebra/lowering.hpp"
#include "algebra/prove.hpp"
#include "algebra/tape_samples.hpp"

namespace anholon::closed_form_test {
namespace {

using test::input;
using test::text;

/// Kinetic energy of a planar body from the velocity of its centre, in world axes, as a naive derivation
/// writes it.
Expr planar_energy(const Expr& m, const Expr& I, const Expr& vx, const Expr& vy, const Expr& w) {
  return m * (vx * vx + vy * vy) + I * w * w;
}

struct Pendulum {
  NodeId energy;
  NodeId expected;
};
/// Mobile pendulum, Boyer & Belkhiri 2013, section VI.A: cart of velocity v, pendulum of length l at angle
/// r3.
Pendulum pendulum(Tape& tape) {
  const Expr m_c = input(tape, "m_c"), m = input(tape, "m"), l = input(tape, "l"), J = input(tape, "J");
  const Expr r3 = input(tape, "r3"), v = input(tape, "v"), w = input(tape, "w");
  const Expr vx = v + l * cos(r3) * w;
  const Expr vy = l * sin(r3) * w;
  const Expr twice = m_c * v * v + planar_energy(m, J, vx, vy, w);
  const Expr expected = (m_c + m) * v * v + Expr(2) * m * l * cos(r3) * v * w + (J + m * l * l) * w * w;
  return {twice.id(tape), expected.id(tape)};
}

/// Snake-board on its admissible motions: V = (-l c, 0, s) nu, axles and rotor.
struct Snakeboard {
  NodeId energy;
  NodeId expected;
};
Snakeboard snakeboard(Tape& tape) {
  const Expr m = input(tape, "m"), m_w = input(tape, "m_w"), l = input(tape, "l"), J = input(tape, "J"),
             J_w = input(tape, "J_w");
  const Expr r1 = input(tape, "r1"), nu = input(tape, "nu"), w1 = input(tape, "r1_dot");
  const Expr c = cos(r1), s = sin(r1);
  const Expr V_X = -(l * c) * nu, W = s * nu;
  Expr twice = planar_energy(m, J, V_X, 0, W);
  for (const int side : {-1, 1}) {  // axle at (side l, 0) turning with side r1
    const Expr vx = V_X, vy = Expr(side) * l * W;
    const Expr rate = W + Expr(-side) * w1;
    // in the axle's own axes, to have something to simplify
    const Expr ux = c * vx + Expr(-side) * s * vy;
    const Expr uy = -(Expr(-side) * s) * vx + c * vy;
    twice += planar_energy(m_w, J_w, ux, uy, rate);
  }
  const Expr expected =
      (m * l * l * c * c + J * s * s + Expr(2) * m_w * l * l + Expr(2) * J_w * s * s) * nu * nu +
      Expr(2) * J_w * w1 * w1;
  return {twice.id(tape), expected.id(tape)};
}

void expect_equal_values(const Tape& tape, NodeId a, NodeId b) {
  std::mt19937_64 rng(11);
  for (int sample = 0; sample < 5; ++sample) {
    const auto v = test::values(tape, {a, b}, test::random_point(tape, rng));
    EXPECT_TRUE(test::vanishes(v[0] - v[1])) << text(tape, a);
  }
}

TEST(ClosedForm, OfThePendulumsEnergyIsTheTextbooks) {
  Tape tape;
  const auto [energy, expected] = pendulum(tape);
  const auto form = closed_form(tape, {energy});
  ASSERT_TRUE(form);
  expect_equal_values(tape, form->front(), energy);
  EXPECT_TRUE(test::provably_equal(tape, form->front(), expected));
  EXPECT_LT(operation_weight(tape, *form), operation_weight(tape, {energy}));
  EXPECT_LE(operation_weight(tape, *form), operation_weight(tape, {expected})) << text(tape, form->front());
}

TEST(ClosedForm, OfTheSnakeboardsEnergyLosesTheAxlesAngles) {
  Tape tape;
  const auto [energy, expected] = snakeboard(tape);
  const auto form = closed_form(tape, {energy});
  ASSERT_TRUE(form);
  expect_equal_values(tape, form->front(), energy);
  EXPECT_TRUE(test::provably_equal(tape, form->front(), expected));
  EXPECT_LE(operation_weight(tape, *form), operation_weight(tape, {expected})) << text(tape, form->front());
}

TEST(ClosedForm, CancelsQuotients) {
  Tape tape;
  const Expr a = input(tape, "a"), b = input(tape, "b"), x = input(tape, "x");
  const Expr c = cos(x), s = sin(x);
  const auto form =
      closed_form(tape, {((a * a - b * b) / (a + b)).id(tape), ((Expr(1) - c * c) / s).id(tape),
                         ((c * c * c * s + s * s * s * c) / (c * a)).id(tape), (Expr(1) - s * s).id(tape)});
  ASSERT_TRUE(form);
  EXPECT_EQ((*form)[0], (a - b).id(tape));
  EXPECT_EQ((*form)[1], s.id(tape));
  EXPECT_EQ((*form)[2], (s / a).id(tape)) << text(tape, (*form)[2]);
  EXPECT_EQ((*form)[3], (c * c).id(tape)) << text(tape, (*form)[3]);
}

TEST(ClosedForm, DividesOnlyWhatIsNotDivisible) {
  Tape tape;
  const Expr a = input(tape, "a"), b = input(tape, "b"), x = input(tape, "x");
  const auto form = closed_form(tape, {((a * a * sin(x) + b * a * cos(x)) / (a * cos(x))).id(tape)});
  ASSERT_TRUE(form);
  EXPECT_EQ((*form)[0], ((a * sin(x)) / cos(x) + b).id(tape)) << text(tape, (*form)[0]);
}

TEST(ClosedForm, GivesUpBySize) {
  Tape tape;
  Expr sum = 0;
  for (int i = 0; i < 12; ++i) sum += input(tape, "x" + std::to_string(i));
  const Expr power = sum * sum * sum * sum;
  EXPECT_FALSE(closed_form(tape, {power.id(tape)}));
  EXPECT_FALSE(closed_form(tape, {sum.id(tape)}, {.nodes = 5}));
  EXPECT_TRUE(closed_form(tape, {sum.id(tape)}));
}

TEST(ClosedForm, LeavesPowersThatAreTooHigh) {
  Tape tape;
  Expr power = input(tape, "x");
  for (int doubled = 0; doubled < 17; ++doubled) power = power * power;
  EXPECT_FALSE(closed_form(tape, {(power + input(tape, "y")).id(tape)}));
}

TEST(ClosedForm, LeavesWhatDividesByAHiddenZero) {
  Tape tape;
  const Expr x = input(tape, "x");
  const Expr zero = cos(Expr(2) * x) - cos(x) * cos(x) + sin(x) * sin(x);
  EXPECT_FALSE(closed_form(tape, {(Expr(1) / zero).id(tape)}));
}

TEST(ProvablyEqual, SeesThroughAnglesAndQuotients) {
  Tape tape;
  const Expr a = input(tape, "a"), b = input(tape, "b"), x = input(tape, "x"), y = input(tape, "y");
  const auto equal = [&](const Expr& p, const Expr& q) {
    return test::provably_equal(tape, p.id(tape), q.id(tape));
  };
  EXPECT_TRUE(equal(sin(x + y) * sin(x - y), sin(x) * sin(x) - sin(y) * sin(y)));
  EXPECT_TRUE(equal(tan(Expr(2) * x), Expr(2) * tan(x) / (Expr(1) - tan(x) * tan(x))));
  EXPECT_TRUE(equal(a / (a + b) + b / (a + b), 1));
  EXPECT_TRUE(equal(sqrt((a + b) * (a + b)) * x, x * sqrt(a * a + Expr(2) * a * b + b * b)));
  EXPECT_FALSE(equal(sin(x), sin(y)));
  EXPECT_FALSE(equal(a / (a + b), b / (a + b)));
}

}  // namespace
}  // namespace anholon::closed_form_test
