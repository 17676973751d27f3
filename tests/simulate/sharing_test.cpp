// SPDX-License-Identifier: GPL-2.0-or-later
//
// How redundant contacts share a load: rules for lambda_stat, flags, and elastic contacts (remark 7), whose
// shares tend to a limit as they stiffen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulate/contact_forces.hpp"
#include "simulate/simulation.hpp"
#include "simulate/stiffness_ladder.hpp"

namespace anholon::sharing_test {
namespace {

const std::string root = ANHOLON_SOURCE_DIR;

std::size_t column_of(const SimulationResult& result, const std::string& name) {
  const auto at =
      std::ranges::find_if(result.columns, [&](const std::string& c) { return c.starts_with(name); });
  EXPECT_NE(at, result.columns.end()) << name;
  return static_cast<std::size_t>(at - result.columns.begin());
}

// Two wheels on an axle, loads of 100 and 300 N given, 80 N of side force to share, N s its two shares.
TEST(Sharing, EqualFrictionUtilisationLoadsEachContactByWhatItCarries) {
  SharingProblem problem;
  problem.lambda = Eigen::Vector4d(100, 300, 40, 40);
  problem.N = Eigen::Vector4d(0, 0, 1, -1);
  for (int i = 0; i < 2; ++i) {
    ContactMap map;
    map.normal = Eigen::MatrixXd::Zero(1, 4), map.tangential = Eigen::MatrixXd::Zero(2, 4);
    map.normal(0, i) = 1, map.tangential(1, 2 + i) = 1;
    map.friction = 0.5;
    problem.contacts.push_back(map);
  }
  const Eigen::VectorXd lambda = problem.lambda + problem.N * equal_friction_sharing()(problem);
  EXPECT_NEAR(lambda(2), 20, 1e-12);  // 20/(0.5*100) = 60/(0.5*300); rounding of numbers of order 100
  EXPECT_NEAR(lambda(3), 60, 1e-12);
  EXPECT_EQ(least_norm_sharing()(problem).norm(), 0);
}

TEST(Sharing, OfTheCarChangesItsContactForcesAndNothingElse) {
  Scene scene = read_scene(root + "/models/ackermann_car/bend.scene.toml");
  scene.sharing = LoadSharing::least_norm;
  const SimulationResult least = simulate_scene(scene);
  scene.sharing = LoadSharing::equal_friction_utilisation;
  const SimulationResult equal = simulate_scene(scene);
  ASSERT_TRUE(least.finished && equal.finished) << least.status << equal.status;
  ASSERT_EQ(least.rows.size(), equal.rows.size());
  double moved = 0, changed = 0, unbalanced = 0, uneven = 0;
  const std::vector<std::string> wheels = {"rear_left", "rear_right", "front_left", "front_right"};
  for (std::size_t i = 0; i < least.rows.size(); ++i) {
    const auto difference = [&](const std::string& name) {
      const std::size_t c = column_of(least, name);
      return equal.rows[i][c] - least.rows[i][c];
    };
    for (const char* name : {"p_X", "p_Y", "V_X", "Omega_Z", "rear_left_spin"})
      moved = std::max(moved, std::abs(difference(name)));
    double load = 0, load_change = 0;
    for (const std::string& wheel : wheels) {
      changed = std::max(changed, std::abs(difference(wheel + ".lateral")));
      load += equal.rows[i][column_of(equal, wheel + ".normal")];
      load_change += difference(wheel + ".normal");
    }
    unbalanced = std::max(unbalanced, std::abs(load_change) / load);
    EXPECT_NEAR(load, (1100 + 4 * 18) * 9.81, 1e-9 * load);  // the whole weight; the car stays level
    const auto use = [&](const std::string& wheel) {         // of one axle, side force over load
      return equal.rows[i][column_of(equal, wheel + ".lateral")] /
             equal.rows[i][column_of(equal, wheel + ".normal")];
    };
    uneven = std::max(uneven, std::abs(use("rear_left") - use("rear_right")));
  }
  EXPECT_EQ(moved, 0);
  EXPECT_GT(changed, 10);
  EXPECT_LT(unbalanced, 1e-12);
  EXPECT_LT(uneven, 1e-9);  // both rear wheels use the road alike
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_FALSE(equal.contacts[i].slips_at) << equal.contacts[i].contact;
    EXPECT_GT(equal.contacts[i].least_normal, 0);
  }
}

TEST(Sharing, FlagsTheWheelThatWouldLiftAndTheOneThatWouldSlip) {
  Scene scene = read_scene(root + "/models/ackermann_car/bend.scene.toml");
  for (auto& [index, velocity] : scene.initial.velocities) velocity = 24;  // m/s in a bend of 26 m: 2.2 g
  scene.duration = 3;
  std::erase_if(scene.output_times, [](double t) { return t > 3; });
  const SimulationResult result = simulate_scene(scene);
  ASSERT_TRUE(result.finished) << result.status;  // the model goes on; the flags say that a car would not
  bool lifts = false, slips = false;
  for (const ContactHistory& c : result.contacts) lifts = lifts || c.lifts_at, slips = slips || c.slips_at;
  EXPECT_TRUE(lifts);
  EXPECT_TRUE(slips);
}

// Remark 7: springs in the contacts determine lambda; as they stiffen, it tends to the least norm, that of
// equal springs.
class StiffeningLadder : public ::testing::TestWithParam<std::string> {};

TEST_P(StiffeningLadder, SharesOfElasticContactsTendToTheLeastNorm) {
  const Scene scene = read_scene(root + "/models/" + GetParam());
  const StiffnessLadder ladder = stiffness_ladder(scene, {1, 10, 100});
  ASSERT_EQ(ladder.steps.size(), 3U);
  for (std::size_t i = 0; i + 1 < ladder.steps.size(); ++i) {
    EXPECT_EQ(ladder.steps[i].status, "ok");
    EXPECT_LT(ladder.steps[i + 1].distance, 0.15 * ladder.steps[i].distance);  // 1/k: a tenth
  }
  EXPECT_LT(ladder.steps.back().distance, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Models, StiffeningLadder,
                         ::testing::Values("mobile_pendulum/elastic_contacts.scene.toml",
                                           "ackermann_car/elastic_contacts.scene.toml"),
                         [](const auto& info) { return info.param.substr(0, info.param.find('/')); });

}  // namespace
}  // namespace anholon::sharing_test
