// SPDX-License-Identifier: GPL-2.0-or-later
// The balance of energy along whole motions follows the tolerance, whatever the size of the robot, and the
// step.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "simulate/columns.hpp"

namespace anholon::energy_test {
namespace {

using testing::scene_of;

TEST(SoftSnakeboardGait, BalancesItsEnergyToANinthDigitByDefault) {
  Scene scene = scene_of("soft_snakeboard/gait");
  scene.integrator = Integrator();
  EXPECT_EQ(scene.integrator.tolerance, 1e-9);
  const SimulationResult result = simulate_scene(scene);
  ASSERT_TRUE(result.finished);
  EXPECT_LT(result.energy_balance, 1e-9);
}

TEST(SoftSnakeboardGait, LosesEnergyInProportionToTheTolerance) {
  Scene scene = scene_of("soft_snakeboard/gait");
  double least = INFINITY, most = 0;
  for (int exponent = -4; exponent >= -13; --exponent) {
    scene.integrator.tolerance = std::pow(10.0, exponent);
    const SimulationResult result = simulate_scene(scene);
    ASSERT_TRUE(result.finished);
    const double ratio = result.energy_balance / scene.integrator.tolerance;
    least = std::min(least, ratio), most = std::max(most, ratio);
  }
  EXPECT_LT(most / least, 10);
  EXPECT_LT(most, 10);
}

/// Final values of the columns that are states: poses, coordinates, velocities.
std::vector<double> final_state(const SimulationResult& result) {
  const std::size_t nu = testing::column_index(result, "nu_1");
  return {result.rows.back().begin() + 1, result.rows.back().begin() + static_cast<std::ptrdiff_t>(nu)};
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(SoftSnakeboardGait, HalvingTheFixedStepDividesErrorAndEnergyDefectBy16) {
  Scene scene = scene_of("soft_snakeboard/gait");
  scene.integrator.method = Integrator::Method::rkmk4;
  std::vector<double> defects;
  std::vector<std::vector<double>> states;
  for (const double step : {4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4}) {
    scene.integrator.step = step;
    const SimulationResult result = simulate_scene(scene);
    ASSERT_TRUE(result.finished);
    defects.push_back(result.energy_balance);
    states.push_back(final_state(result));
  }
  for (std::size_t i = 0; i + 2 < states.size(); ++i) {
    const double slope =
        std::log2(distance(states[i], states[i + 1]) / distance(states[i + 1], states[i + 2]));
    EXPECT_NEAR(slope, 4, 0.1) << i;
  }
  const double slope = std::log2(defects.front() / defects.back()) / 4;
  EXPECT_NEAR(slope, 4, 0.1);
}

/// Masses, stiffness and damping by one factor: the same motion, with other forces and energies.
Scene with_masses_by(double factor) {
  Scene scene = scene_of("soft_snakeboard/gait");
  std::string parameters = "parameters = {";
  for (const Parameter& p : scene.model.parameters) {
    const bool is_length = p.unit == "m";
    if (!is_length)
      parameters += " " + p.name + " = " + std::to_string(p.value.to_double()) + "e" +
                    std::to_string(static_cast<int>(std::log10(factor))) + ",";
  }
  parameters.back() = '}';
  return read_scene_text(
      "anholon = 1\nname = \"light\"\nmodel = \"soft_snakeboard.toml\"\n" + parameters +
          "\nmotion = { r1 = \"0.5*sin(2.5*t)\", r3 = \"0.7*cos(2.5*t)\" }\n"
          "initial = { coordinates = { re3 = 0.02 }, velocities = { V_X = 0.5, re3 = 0, re4 = 0.1 } }\n"
          "duration = 3\noutput_step = 1\n",
      testing::root + "/models/soft_snakeboard/light.scene.toml");
}

// Foreshortening, stations and damping on 10 s of a free hub with flexible arrays, and on an arm whose
// flexible link carries another: every force comes from one kinetic energy.
TEST(FlexibleRobots, BalanceTheirEnergyToANinthDigit) {
  for (const char* name :
       {"flexible_spacecraft/slew", "two_link_flexible_arm/reach", "rotating_beam/spin_up"}) {
    const SimulationResult result = simulate_scene(scene_of(name));
    ASSERT_TRUE(result.finished) << name;
    EXPECT_LT(result.energy_balance, 1e-9) << name;
  }
}

// Nothing drives it and nothing damps it: T + V itself stays, while the beam bends in both planes on a hub
// that tumbles.
TEST(FreeHub, KeepsItsEnergyWithAStiffenedBeam) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "free_hub";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "hub.toml") << R"(anholon = 1
name = "hub"
group = "SE3"
[[body]]
name = "hub"
inertia = { mass = 2, com = [0.02, 0, 0.01], about_com = { xx = 0.08, yy = 0.06, zz = 0.1 } }
[[body]]
name = "boom"
parent = "hub"
pose = { translation = [0.1, 0, 0] }
joint = { kind = "fixed" }
[body.beam]
length = 1
mass_per_length = 0.5
bending_stiffness = [6, 4]
modes = 2
planes = ["y", "z"]
deformation = "stiffened"
range = [-0.1, 0.1]
)";
  const SimulationResult result = simulate_scene(read_scene_text(
      R"(anholon = 1
name = "tumble"
model = "hub.toml"
initial = { coordinates = { boom_e1 = 0.04, boom_e3 = -0.03 }, velocities = { V_X = 0.2, Omega_X = 1, Omega_Y = 0.6, Omega_Z = 2.5, boom_e2 = 0.1 } }
duration = 10
output_step = 0.05
integrator = { method = "dopri5", tolerance = 1e-11 }
)",
      folder / "tumble.scene.toml"));
  ASSERT_TRUE(result.finished) << result.status;
  const std::size_t kinetic = testing::column_index(result, "kinetic"),
                    potential = testing::column_index(result, "potential");
  const double energy = result.rows.front()[kinetic] + result.rows.front()[potential];
  double bent = 0;
  for (const auto& row : result.rows) {
    EXPECT_NEAR(row[kinetic] + row[potential], energy, 1e-9 * energy) << "t = " << row[0];
    bent = std::max(bent, row[potential]);
  }
  EXPECT_GT(bent, 0.01 * energy);  // J; it does bend
}

// Eight axles leave seven joints two freedoms; torques push them towards a wave.
TEST(AcmSnake, BalancesItsEnergyWhileItsWheelsRoll) {
  const Scene scene = scene_of("acm_snake/wave");
  EXPECT_EQ(scene.model.rows.size(), 8U);
  const SimulationResult result = simulate_scene(scene);
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_LT(result.energy_balance, 1e-8);  // of the tolerance 1e-9
  EXPECT_LT(result.constraint_residual, 1e-13);
}

TEST(Tolerance, MeansTheSameForARobotAMillionTimesLighter) {
  const SimulationResult heavy = simulate_scene(with_masses_by(1)),
                         light = simulate_scene(with_masses_by(1e-6));
  ASSERT_TRUE(heavy.finished && light.finished);
  EXPECT_NEAR(light.largest_energy / heavy.largest_energy, 1e-6, 1e-12);
  EXPECT_LE(std::abs(heavy.steps - light.steps), 1);  // but for roundings, the same steps
  EXPECT_LT(light.energy_balance, 1e-9);
  EXPECT_LT(distance(final_state(heavy), final_state(light)),
            1e-11);  // a hundredth of what the tolerance allows
}

TEST(Tolerance, HoldsForEnergiesOfThousandthsOfAJoule) {
  const SimulationResult result = simulate_scene(scene_of("wheeled_snake3/serpent"));
  ASSERT_TRUE(result.finished);
  EXPECT_LT(result.largest_energy, 0.01);
  EXPECT_LT(result.energy_balance, 1e-8);  // of the default tolerance, 1e-9
}

}  // namespace
}  // namespace anholon::energy_test
