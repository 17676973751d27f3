// SPDX-License-Identifier: GPL-2.0-or-later
//
// Shipped models against what textbooks say of them, in exact arithmetic: wheel speeds, turning circle,
// closure of a linkage. None of it uses the recursion or the kernel.
#include <gtest/gtest.h>

#include "contact/program_values.hpp"

namespace anholon::test::kinematics_test {
namespace {

constexpr double formula = 1e-30;  // 60 digits are carried; what is left is the rounding of the formulas

Exact decimal(const char* text) { return Exact::from_decimal(text); }

void expect_equal(const Values& got, const Values& want, const std::string& what,
                  double tolerance = formula) {
  ASSERT_EQ(got.size(), want.size()) << what;
  for (std::size_t i = 0; i < got.size(); ++i)
    EXPECT_LT(abs(got[i] - want[i]).to_double(), tolerance) << what << ", entry " << i;
}

TEST(DifferentialDrive, MovesByTheMeanAndTurnsByTheDifferenceOfItsWheels) {
  const WorkingDigits digits(60);
  const ProgramValues robot("differential_drive", {}, {"kinematics", "inverse_torques"});
  EXPECT_EQ(robot.derivation().reduction.ranks.m_locked, 3);
  const Exact R = decimal("0.1"), b = decimal("0.2"), left = decimal("3.7"), right = decimal("-1.2");
  Inputs in = {{"r_a_dot", {left, right}}, {"g", {decimal("1"), decimal("2"), decimal("0.4")}}};
  expect_equal(robot("kinematics", "eta", in),
               {R * (left + right) / Exact(2), Exact(0), R * (right - left) / (Exact(2) * b)}, "twist");
  // Straight on from rest: each motor moves half of the mass and its own wheel.
  const Exact alpha = decimal("2.5"), mass = decimal("12") + Exact(2) * decimal("0.8");
  in = {{"r_a_ddot", {alpha, alpha}}};
  const Exact tau = (mass * R * R / Exact(2) + decimal("0.004")) * alpha;
  expect_equal(robot("inverse_torques", "tau_a", in), {tau, tau}, "torques");
}

TEST(MecanumBase, HasTheWheelSpeedsOfTheTextbook) {
  const WorkingDigits digits(60);
  const ProgramValues base("mecanum_base", {}, {"kinematics", "compatibility"});
  EXPECT_EQ(base.derivation().reduction.ranks.m, 4);
  EXPECT_EQ(base.derivation().reduction.ranks.m_locked, 3);
  const Exact R = decimal("0.08"), k = decimal("0.25") + decimal("0.2");
  const Exact x = decimal("0.7"), y = decimal("-0.3"), turn = decimal("1.1");
  const Inputs in = {
      {"r_a_dot",
       {(x - y - k * turn) / R, (x + y + k * turn) / R, (x + y - k * turn) / R, (x - y + k * turn) / R}}};
  expect_equal(base("kinematics", "eta", in), {x, y, turn}, "twist");
  expect_equal(base("compatibility", "velocity_residual", in), {Exact(0)}, "condition on the wheels");
  Inputs skewed = in;
  skewed["r_a_dot"][0] = skewed["r_a_dot"][0] + Exact(1);
  EXPECT_GT(abs(base("compatibility", "velocity_residual", skewed)[0]).to_double(), 1e-3);
}

TEST(AckermannCar, TurnsAboutTheCentreInWhichAllAxlesMeet) {
  const WorkingDigits digits(60);
  const ProgramValues car("ackermann_car", {}, {"kinematics"});
  const ReductionReport& reduction = car.derivation().reduction;
  EXPECT_EQ(reduction.ranks.rows, 12);
  EXPECT_EQ(reduction.ranks.m, 9);
  EXPECT_EQ(reduction.ranks.m_locked, 9);  // three loadings are left open: two axles, and one diagonal
  const Exact L = decimal("2.6"), w = decimal("0.75"), R = decimal("0.3"), speed = decimal("8"), zero = 0;
  for (const char* angle : {"0.4", "-0.55", "0.001"}) {
    const Exact steer = decimal(angle);
    const Exact radius = L * cos(steer) / sin(steer);  // from the centre to the middle of the rear axle
    const Exact turn = speed / radius;
    const Inputs in = {{"nu", {speed}}, {"r_a", {steer}}, {"r_p", Values(4, Exact(0))}};
    expect_equal(car("kinematics", "eta", in), {speed, zero, zero, zero, zero, turn}, "twist");
    const auto rate = [&](const Exact& x, const Exact& y) {  // speed of the wheel's centre over its radius
      const Exact d = radius - y;
      return sqrt(x * x + d * d) * abs(turn) / R;
    };
    expect_equal(car("kinematics", "r_p_dot", in), {rate(zero, w), rate(zero, -w), rate(L, w), rate(L, -w)},
                 "spins");
  }
}

// The ends of the cranks are known, the tip is where two circles meet.
TEST(FiveBar, RodsFollowTheIntersectionOfTwoCircles) {
  const WorkingDigits digits(60);
  const ProgramValues linkage("five_bar", {}, {"kinematics", "position_conditions"});
  EXPECT_EQ(linkage.derivation().reduction.kernel.H.cols(), 0);
  const Exact b = decimal("0.15"), l_1 = decimal("0.25"), l_2 = decimal("0.4");
  /// (left_elbow, right_elbow) at angles of the cranks, tip up.
  const auto elbows = [&](const Exact& left, const Exact& right) -> Values {
    const Exact px = l_1 * cos(left) - b, py = l_1 * sin(left);
    const Exact qx = l_1 * cos(right) + b, qy = l_1 * sin(right);
    const Exact dx = (qx - px) / Exact(2), dy = (qy - py) / Exact(2);
    const Exact half = sqrt(dx * dx + dy * dy), height = sqrt(l_2 * l_2 - half * half);
    const Exact tx = px + dx - height * dy / half, ty = py + dy + height * dx / half;
    return {atan2(ty - py, tx - px) - left, atan2(ty - qy, tx - qx) - right};
  };
  const Exact left = decimal("2.1"), right = decimal("0.8"), h = decimal("1e-20");
  const Exact left_rate = decimal("1.3"), right_rate = decimal("-0.7");
  const Values at = elbows(left, right);
  const Inputs in = {{"r_a", {left, right}}, {"r_p", at}, {"r_a_dot", {left_rate, right_rate}}};
  expect_equal(linkage("position_conditions", "Phi", in), {Exact(0), Exact(0)}, "closure");
  const Values ahead = elbows(left + h * left_rate, right + h * right_rate);
  const Values behind = elbows(left - h * left_rate, right - h * right_rate);
  Values rates;
  for (std::size_t i = 0; i < 2; ++i) rates.push_back((ahead[i] - behind[i]) / (h + h));
  expect_equal(linkage("kinematics", "r_p_dot", in), rates, "rates of the elbows");  // error of order h^2
}

}  // namespace
}  // namespace anholon::test::kinematics_test
