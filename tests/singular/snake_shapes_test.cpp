// SPDX-License-Identifier: GPL-2.0-or-later
// The wheeled snake at shapes where its axles are parallel or meet in one point. With passive or
// torque-driven joints that is nothing special, and no digit is lost; with driven joints no finite motion
// exists there, unless the rates of the joints are compatible.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "check/evaluate_recursion.hpp"
#include "describe/mechanise.hpp"
#include "simulate/simulation.hpp"
#include "singular/exact_inputs.hpp"
#include "singular/wheeled_snake.hpp"

namespace anholon::snake_shapes_test {
namespace {

using test::BothInputs;
using test::distance;

struct Drives {
  std::string joint_1, joint_2;
};

class SnakeShape : public ::testing::TestWithParam<Drives> {};

// Straight, arcs, and what is a little off them.
TEST_P(SnakeShape, KeepsAllDigits) {
  const Model model = test::wheeled_snake(GetParam().joint_1, GetParam().joint_2);
  DeriveRequest request;
  request.torque_driven = {"*"};
  const auto derivation = derive(model, request);
  const std::vector<Exact> parameters = test::rounded_parameters(model);
  const auto generated = compiled_caller(derivation->program, parameters);
  const auto exact = interpreting_caller<Exact>(derivation->program, parameters);
  EXPECT_TRUE(derivation->reduction.ranks.drops.empty());
  const WorkingDigits precision(50);
  const Mechanism<Exact> mechanism = mechanise<Exact>(describe_mechanism(model), parameters);
  const Partition partition = partition_of(model);
  for (const double bend : {0.0, 0.5, -1.3, std::numbers::pi / 2}) {
    for (const double offset : {0.0, 1e-14, 1e-9, -1e-5, 1e-2}) {
      SCOPED_TRACE(::testing::Message() << bend << " + " << offset);
      BothInputs in;
      const double r_1 = bend, r_2 = bend + offset;
      in.set("g", {0.1, -0.2, 0.3});
      std::vector<double> r_p, r_a;
      (GetParam().joint_1 == "active" ? r_a : r_p).push_back(r_1);
      (GetParam().joint_2 == "active" ? r_a : r_p).push_back(r_2);
      in.set("r_p", r_p), in.set("r_a", r_a);
      in.set("nu", {0.7, -1.1});
      const std::vector<double> torques(r_a.size(), 0.3);
      in.set("tau_a", torques), in.set("tau_d", torques);
      const auto got = generated("forward_dynamics", in.rounded);
      const auto want = exact("forward_dynamics", in.exact);
      for (const auto& [name, values] : want)  // the default bound of the project
        EXPECT_LT(distance(got.at(name), values), 1e-13) << name;

      // the same from the recursion, whose kernel is that of this one state
      EvaluationInput<Exact> input;
      const auto velocities = exact("kinematics", in.exact);
      input.state.R = AxisRotation<Exact>{2, cos(in.exact["g"][2]), sin(in.exact["g"][2])}.matrix();
      input.state.eta = {{velocities.at("eta")[0], velocities.at("eta")[1], 0},
                         {0, 0, velocities.at("eta")[2]}};
      input.state.r = {Exact::from_double(r_1), Exact::from_double(r_2)};
      std::size_t passive = 0, driven = 0;
      for (const std::string& drive : {GetParam().joint_1, GetParam().joint_2})
        input.state.r_dot.push_back(drive == "active" ? velocities.at("r_d_dot")[driven++]
                                                      : velocities.at("r_p_dot")[passive++]);
      input.r_ddot = {0, 0};
      for (const std::string& drive : {GetParam().joint_1, GetParam().joint_2})
        input.tau.push_back(drive == "active" ? Exact::from_double(0.3) : Exact(0));
      input.has_torque = true;
      input.has_acceleration = partition.s_a() == 0;
      const Evaluated<Exact> witness =
          evaluate_recursion(mechanism, partition, input, Exact::from_decimal("1e-30"));
      const std::vector<Exact> eta_dot(witness.free_acceleration.begin(),
                                       witness.free_acceleration.begin() + 3);
      EXPECT_LT(distance(got.at("eta_dot"), eta_dot), 1e-13);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Drives, SnakeShape,
                         ::testing::Values(Drives{"passive", "passive"}, Drives{"active", "passive"},
                                           Drives{"active", "active"}),
                         [](const auto& info) { return info.param.joint_1 + "_" + info.param.joint_2; });

SimulationResult simulated(const std::string& model, const std::string& lines) {
  const std::string folder = test::models_folder() + model + "/";
  return simulate_scene(read_scene_text(
      "anholon = 1\nname = \"test\"\nmodel = \"" + model + ".toml\"\n" + lines, folder + "test.scene.toml"));
}

// r1 - r2 passes zero at t = 1: the axles meet in one point, and r1_dot, r2_dot ask for more than they allow.
TEST(DrivenSnake, StopsWhereNoFiniteMotionExists) {
  const std::string motion =
      "motion = { r1 = \"0.5 + 0.3*(t - 1)\", r2 = \"0.5 - 0.2*(t - 1)\" }\nduration = 2\n";
  for (const std::string integrator : {"integrator = { method = \"dopri5\", tolerance = 1e-9 }",
                                       "integrator = { method = \"rkmk4\", step = 0.03 }"}) {
    const SimulationResult result = simulated("wheeled_snake3", motion + integrator);
    EXPECT_FALSE(result.finished);
    EXPECT_TRUE(result.status.starts_with("no finite motion goes through t = 1 s, r1 = 0.5"))
        << result.status;
    EXPECT_NE(result.status.find("falls from 3 to 2"), std::string::npos) << result.status;
    for (const char* row : {"link_1", "link_2", "link_3"})
      EXPECT_NE(result.status.find(row), std::string::npos) << result.status;
    EXPECT_LT(result.rows.back()[0], 1.1);  // it does stop
  }
}

// At the straight shape r2_dot = -r1_dot is compatible: then Omega_Z = -r1_dot/2 and all wheels roll.
TEST(DrivenSnake, PassesWhereItsRatesAreCompatible) {
  const std::string motion =
      "motion = { r1 = \"0.4*sin(t + 0.7)\", r2 = \"-0.4*sin(t + 0.7)\" }\nduration = 4\n";
  for (const std::string integrator : {"integrator = { method = \"dopri5\", tolerance = 1e-9 }",
                                       "integrator = { method = \"rkmk4\", step = 0.03 }"}) {
    const SimulationResult result = simulated("wheeled_snake3", motion + integrator);
    EXPECT_TRUE(result.finished) << result.status;
  }
}

// The snake-board passes r1 = pi/2, where (A, B_p) loses rank and every motion of the axles is compatible.
TEST(Snakeboard, IsNotTakenForOneThatCannotPass) {
  const SimulationResult result =
      simulate_scene(read_scene(test::models_folder() + "rigid_snakeboard/right_angle.scene.toml"));
  EXPECT_TRUE(result.finished) << result.status;
}

}  // namespace
}  // namespace anholon::snake_shapes_test
