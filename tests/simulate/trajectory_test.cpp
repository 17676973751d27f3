// SPDX-License-Identifier: GPL-2.0-or-later
// Whole motions against the reference trajectories.

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "simulate/columns.hpp"

namespace anholon::trajectory_test {
namespace {

struct Case {
  std::string scene, reference;
};

class ReferenceTrajectory : public ::testing::TestWithParam<Case> {};

TEST_P(ReferenceTrajectory, EndsWhereTheReferenceEnds) {
  const SimulationResult result = simulate_scene(read_scene(testing::root + "/models/" + GetParam().scene));
  ASSERT_TRUE(result.finished) << result.status;
  const auto reference =
      nlohmann::json::parse(std::ifstream(testing::root + "/tests/reference/" + GetParam().reference));
  const auto& final = reference["trajectory"]["final"];
  const auto number = [](const nlohmann::json& j) { return std::stod(j.get<std::string>()); };
  // the scenes ask for 1e-12; the unstable roll of the bicycle loses three digits
  const double bound = 1e-9;
  const bool planar = reference["group"] == "SE(2)";
  EXPECT_NEAR(testing::column(result, planar ? "x" : "p_X"), number(final["g"]["p"][0]), bound);
  if (planar) {
    EXPECT_NEAR(testing::column(result, "y"), number(final["g"]["p"][1]), bound);
  }
  for (const char* kind : {"r_p", "eta"}) {
    for (std::size_t i = 0; i < final[kind].size(); ++i) {
      EXPECT_NEAR(testing::column(result, reference["coordinates"][kind][i].get<std::string>()),
                  number(final[kind][i]), bound);
    }
  }
  EXPECT_NEAR(testing::column(result, "kinetic") + testing::column(result, "potential"),
              number(final["total_energy"]), bound * 10);
  EXPECT_NEAR(testing::column(result, "work"), number(final["actuator_work_since_start"]), bound * 10);
  EXPECT_NEAR(testing::column(result, "dissipated"), number(final["dissipated_energy_since_start"]), bound);
  EXPECT_LT(result.energy_balance, 1e-9);
  EXPECT_LT(result.constraint_residual, 1e-14);  // a few roundings
}

INSTANTIATE_TEST_SUITE_P(
    Paper, ReferenceTrajectory,
    ::testing::Values(Case{"mobile_pendulum/swing.scene.toml", "A_mobile_pendulum.json"},
                      Case{"bicycle/weave.scene.toml", "B_bicycle.json"},
                      Case{"rigid_snakeboard/gait.scene.toml", "C_rigid_snakeboard.json"},
                      Case{"soft_snakeboard/gait.scene.toml", "C_soft_snakeboard.json"}),
    [](const auto& info) { return info.param.reference.substr(0, 1) + std::to_string(info.index); });

}  // namespace
}  // namespace anholon::trajectory_test
