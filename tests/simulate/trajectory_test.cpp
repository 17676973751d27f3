// SPDX-License-Identifier: GPL-2.0-or-later
// Whole motions: against the reference trajectories, against the conservation of energy, and along the
// tolerance.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "check/simulation.hpp"

namespace anholon {
namespace {

const std::string root = ANHOLON_SOURCE_DIR;

double column(const SimulationResult& result, const std::string& name) {
  for (std::size_t i = 0; i < result.columns.size(); ++i) {
    if (result.columns[i].starts_with(name + " [")) return result.rows.back()[i];
  }
  ADD_FAILURE() << "no column " << name;
  return NAN;
}

struct Case {
  std::string scene, reference;
};

class ReferenceTrajectory : public testing::TestWithParam<Case> {};

TEST_P(ReferenceTrajectory, EndsWhereTheReferenceEnds) {
  const SimulationResult result = simulate_scene(read_scene(root + "/models/" + GetParam().scene));
  ASSERT_TRUE(result.finished) << result.status;
  const auto reference =
      nlohmann::json::parse(std::ifstream(root + "/tests/reference/" + GetParam().reference));
  const auto& final = reference["trajectory"]["final"];
  const auto number = [](const nlohmann::json& j) { return std::stod(j.get<std::string>()); };
  // the scenes ask for 1e-12; the unstable roll of the bicycle loses three digits
  const double bound = 1e-9;
  const bool planar = reference["group"] == "SE(2)";
  EXPECT_NEAR(column(result, planar ? "x" : "p_X"), number(final["g"]["p"][0]), bound);
  if (planar) {
    EXPECT_NEAR(column(result, "y"), number(final["g"]["p"][1]), bound);
  }
  for (const char* kind : {"r_p", "eta"}) {
    for (std::size_t i = 0; i < final[kind].size(); ++i) {
      EXPECT_NEAR(column(result, reference["coordinates"][kind][i].get<std::string>()),
                  number(final[kind][i]), bound);
    }
  }
  EXPECT_NEAR(column(result, "kinetic") + column(result, "potential"), number(final["total_energy"]),
              bound * 10);
  EXPECT_NEAR(column(result, "work"), number(final["actuator_work_since_start"]), bound * 10);
  EXPECT_NEAR(column(result, "dissipated"), number(final["dissipated_energy_since_start"]), bound);
  EXPECT_LT(result.energy_balance, 1e-9);
  EXPECT_LT(result.constraint_residual, 1e-14);  // a few roundings
}

INSTANTIATE_TEST_SUITE_P(Paper, ReferenceTrajectory,
                         testing::Values(Case{"mobile_pendulum/swing.scene.toml", "A_mobile_pendulum.json"},
                                         Case{"bicycle/weave.scene.toml", "B_bicycle.json"},
                                         Case{"rigid_snakeboard/gait.scene.toml", "C_rigid_snakeboard.json"},
                                         Case{"soft_snakeboard/gait.scene.toml", "C_soft_snakeboard.json"}),
                         [](const auto& info) {
                           return info.param.reference.substr(0, 1) + std::to_string(info.index);
                         });

TEST(SoftSnakeboardGait, LosesEnergyInProportionToTheTolerance) {
  Scene scene = read_scene(root + "/models/soft_snakeboard/gait.scene.toml");
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    scene.integrator.tolerance = tolerance;
    const SimulationResult result = simulate_scene(scene);
    EXPECT_LT(result.energy_balance, 10 * tolerance) << tolerance;  // measured: 0.1 to 1 times the tolerance
  }
}

TEST(SoftSnakeboardGait, HalvingTheFixedStepDividesTheEnergyDefectBy16) {
  Scene scene = read_scene(root + "/models/soft_snakeboard/gait.scene.toml");
  scene.integrator.method = Integrator::Method::rkmk4;
  std::vector<double> defects;
  for (const double step : {4e-3, 2e-3, 1e-3, 5e-4}) {
    scene.integrator.step = step;
    defects.push_back(simulate_scene(scene).energy_balance);
  }
  const double slope = std::log2(defects.front() / defects.back()) / 3;
  EXPECT_NEAR(slope, 4, 0.6) << "the defect need not be smooth in the step; its order is 4 or 5";
}

}  // namespace
}  // namespace anholon
