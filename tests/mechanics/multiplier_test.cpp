// SPDX-License-Identifier: GPL-2.0-or-later
//
// The derived program against the full equations of motion with multipliers, written from positions and
// contact points and solved in long double: accelerations, torques and multipliers of the robots that have no
// reference vectors.
#include <gtest/gtest.h>

#include "check/evaluate_program.hpp"
#include "mechanics/robots.hpp"

namespace anholon::multiplier_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

struct Case {
  const char* model;
  Robot robot;
};
void PrintTo(const Case& c, std::ostream* stream) { *stream << c.model; }

class Multipliers : public testing::TestWithParam<Case> {};

TEST_P(Multipliers, OfTheFullEquationsGiveTheMotionAndTorquesOfTheReducedOnes) {
  const std::string name = GetParam().model;
  expect_reduced_motion_of(read_model(fmt::format("{}/models/{}/{}.toml", ANHOLON_SOURCE_DIR, name, name)),
                           GetParam().robot);
}

INSTANTIATE_TEST_SUITE_P(Robots, Multipliers,
                         testing::Values(Case{"double_pendulum", double_pendulum()}, Case{"arm6", arm6()},
                                         Case{"free_chain", free_chain()},
                                         Case{"wheeled_snake3", wheeled_snake(3)},
                                         Case{"wheeled_snake5", wheeled_snake(5)}, Case{"trailer", trailer()},
                                         Case{"mobile_pendulum", mobile_pendulum()},
                                         Case{"mobile_pendulum_one_wheel", mobile_pendulum()}),
                         [](const auto& info) { return std::string(info.param.model); });

// Murray, Li & Sastry, A Mathematical Introduction to Robotic Manipulation (1994), example 4.3, with gravity
// added: relative angles from the downward vertical.
TEST(DoublePendulum, FollowsItsTextbookEquations) {
  const Model model = read_model(ANHOLON_SOURCE_DIR "/models/double_pendulum/double_pendulum.toml");
  const auto derivation = derive(model);
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const auto call = interpreting_caller<double>(derivation->program, parameters);
  const Real m1 = 1.4L, m2 = 0.9L, l1 = 0.6L, c1 = 0.28L, c2 = 0.22L, J1 = 0.045L, J2 = 0.018L, gamma = 9.81L;
  std::mt19937_64 rng(20130922);
  BlockErrors errors;
  for (int i = 0; i < 100; ++i) {
    EvaluationInput<double> input;
    input.state = rounded(random_position_and_velocity(model, rng));
    input.has_acceleration = input.has_torque = true;
    input.r_ddot = {std::uniform_real_distribution<double>(-5, 5)(rng), 0};
    input.tau = {std::uniform_real_distribution<double>(-5, 5)(rng), 0};
    const Evaluated<double> e = evaluate_program(model, *derivation, call, input);
    const Real q1 = input.state.r[0], q2 = input.state.r[1], u1 = input.state.r_dot[0],
               u2 = input.state.r_dot[1];
    const Real alpha = J1 + J2 + m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2), beta = m2 * l1 * c2,
               delta = J2 + m2 * c2 * c2;
    const Real M11 = alpha + 2 * beta * std::cos(q2), M12 = delta + beta * std::cos(q2), M22 = delta;
    const Real h1 = -beta * std::sin(q2) * (2 * u1 * u2 + u2 * u2) +
                    (m1 * c1 + m2 * l1) * gamma * std::sin(q1) + m2 * c2 * gamma * std::sin(q1 + q2);
    const Real h2 = beta * std::sin(q2) * u1 * u1 + m2 * c2 * gamma * std::sin(q1 + q2);
    const Real a1 = input.r_ddot[0];
    const Real a2 = (-h2 - M12 * a1) / M22;
    errors.add("M", {M11, M12, M12, M22}, e.M.entries());
    errors.add("Q", {-h1, -h2}, e.force);
    errors.add("second acceleration", {a2}, std::vector{e.acceleration[1]});
    errors.add("torque", {M11 * a1 + M12 * a2 + h1}, e.tau_a);
    const Real determinant = M11 * M22 - M12 * M12, tau = input.tau[0];
    errors.add("accelerations, torque given",
               {(M22 * (tau - h1) + M12 * h2) / determinant, (-M11 * h2 - M12 * (tau - h1)) / determinant},
               e.free_acceleration);
  }
  errors.expect_below(1e-13L);  // measured: worst 1.2e-15
}

}  // namespace
}  // namespace anholon::multiplier_test
