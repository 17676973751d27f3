// SPDX-License-Identifier: GPL-2.0-or-later
// A free body whose mass centre stays level: charts for a row that names a direction of the world, against
// the motion in closed form. The centre moves straight on, the body turns as Euler's equations say.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <sstream>

#include "anholon/charts.hpp"
#include "singular/exact_inputs.hpp"
#include "singular/wheeled_snake.hpp"

namespace anholon::level_test {
namespace {

using test::BothInputs;
using test::distance;

TEST(LevelBody, MovesStraightOnAndTurnsByEulersEquationsInEveryChart) {
  const Model model = read_model(std::string(ANHOLON_SOURCE_DIR) + "/tests/singular/level_body.toml");
  const auto derivation = derive(model);
  ASSERT_EQ(derivation->reduction.charts.size(), 3U);  // a sphere of directions, as for a body without spin
  EXPECT_FALSE(derivation->reduction.unserved.has_value());
  const auto generated = compiled_caller(derivation->program, test::rounded_parameters(model));
  Eigen::Matrix3d I = Eigen::Vector3d(0.02, 0.03, 0.025).asDiagonal();
  I(0, 1) = I(1, 0) = 0.002;
  const Eigen::Vector3d velocity(1.3, -0.8, 0), turn(0.7, -1.1, 2.3);  // of the centre, world; of the body
  int changes = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double small : {0.0, 1e-300, 1e-16, 1e-9, -1e-6, 1e-3, 0.1, 0.5, 1.0, -1.0}) {
      Eigen::Vector3d up(small, -small, small / 2);  // the vertical in body axes: near one of them
      up(axis) = 1;
      up.normalize();
      const Eigen::Matrix3d R =
          Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      SCOPED_TRACE(::testing::Message() << up.transpose());
      BothInputs in;
      std::vector<double> rotation;
      for (int i = 0; i < 9; ++i) rotation.push_back(R(i / 3, i % 3));
      in.set("R", rotation), in.set("p", {0.4, -2, 1});
      const Eigen::Vector3d v = R.transpose() * velocity;
      const std::vector<double> eta = {v(0), v(1), v(2), turn(0), turn(1), turn(2)};
      const Eigen::Vector3d straight = v.cross(turn), euler = I.inverse() * (I * turn).cross(turn);
      const std::vector<double> expected = {straight(0), straight(1), straight(2),
                                            euler(0),    euler(1),    euler(2)};
      const std::vector<double> quality = generated("chart_quality", in.rounded).at("quality");
      const double best = quality[best_chart(std::span<const double>(quality))];
      EXPECT_GT(best, 0.5);
      for (std::size_t chart = 0; chart < quality.size(); ++chart) {
        if (!(quality[chart] > 0.1 * best)) continue;  // hysteresis leaves a chart at a quarter
        ++changes;
        const std::string of = chart_prefix(chart);
        in.set("eta", eta);
        in.set("nu", generated(of + "reduced_velocities", in.rounded).at("nu"));
        EXPECT_LT(distance(generated(of + "kinematics", in.rounded).at("eta"), eta), 1e-14);
        // so close to the closed form in each chart that no change of chart jumps by 1e-12
        EXPECT_LT(distance(generated(of + "forward_dynamics", in.rounded).at("eta_dot"), expected), 1e-13);
      }
    }
  }
  EXPECT_GT(changes, 45);  // most attitudes have two charts of use
}

// The same body with a driven wheel. The functions torque_driven_* have charts of their own; in each they
// give the accelerations of the program that counts the wheel with the passive joints.
TEST(LevelBody, WithADrivenWheelHasChartsOfItsTorqueDrivenFunctions) {
  std::ifstream file(std::string(ANHOLON_SOURCE_DIR) + "/tests/singular/level_body.toml");
  std::ostringstream text;
  text << file.rdbuf() << R"(
[[body]]
name    = "wheel"
parent  = "body"
inertia = { mass = 0.3, about_com = { xx = 0.001, yy = 0.001, zz = 0.002 } }
joint   = { kind = "revolute", axis = [0, 0, 1], coordinate = "r1", drive = "active" }
)";
  const Model model = read_model_text(text.str(), "level_body.toml");
  DeriveRequest by_torque;
  by_torque.torque_driven = {"*"};
  const auto derivation = derive(model), witness = derive(model, by_torque);
  ASSERT_TRUE(derivation->torque_driven.has_value());
  ASSERT_EQ(derivation->torque_driven->charts.size(), 3U);
  const std::vector<Exact> parameters = test::rounded_parameters(model);
  const auto generated = compiled_caller(derivation->program, parameters),
             expected = compiled_caller(witness->program, parameters);
  const auto chart_at = chart_finder<double>(*witness);
  int compared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double small : {0.0, 1e-300, 1e-9, 1e-3, 0.3, -1.0}) {
      Eigen::Vector3d up(small, -small, small / 2);
      up(axis) = 1;
      const Eigen::Matrix3d R =
          Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      SCOPED_TRACE(::testing::Message() << up.transpose());
      BothInputs in;
      std::vector<double> rotation;
      for (int i = 0; i < 9; ++i) rotation.push_back(R(i / 3, i % 3));
      in.set("R", rotation), in.set("p", {0, 0, 0}), in.set("r_a", {0.4});
      const Eigen::Vector3d v = R.transpose() * Eigen::Vector3d(1.3, -0.8, 0);
      const std::vector<double> eta = {v(0), v(1), v(2), 0.7, -1.1, 2.3};
      in.set("eta", eta), in.set("r_a_dot", {5.0}), in.set("r_d_dot", {5.0}), in.set("tau_a", {0.2});
      const std::string best = chart_prefix(chart_at(in.rounded));
      in.set("nu", expected(best + "reduced_velocities", in.rounded).at("nu"));
      const auto want = expected(best + "forward_dynamics", in.rounded);
      const auto quality = generated("torque_driven_chart_quality", in.rounded).at("quality");
      for (std::size_t chart = 0; chart < quality.size(); ++chart) {
        if (!(quality[chart] > 0.05)) continue;  // of about 0.6 at best
        ++compared;
        const std::string of = chart_prefix(chart) + "torque_driven_";
        in.set("w", generated(of + "velocities", in.rounded).at("w"));
        EXPECT_LT(distance(generated(of + "kinematics", in.rounded).at("eta"), eta), 1e-14);
        const auto got = generated(of + "dynamics", in.rounded);
        EXPECT_LT(distance(got.at("eta_dot"), want.at("eta_dot")), 1e-12);  // the bound of a change of chart
        EXPECT_LT(distance(got.at("r_a_ddot"), want.at("r_d_ddot")), 1e-12);
      }
    }
  }
  EXPECT_GT(compared, 18);
}

}  // namespace
}  // namespace anholon::level_test
