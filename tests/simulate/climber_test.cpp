// SPDX-License-Identifier: GPL-2.0-or-later
//
// The pendular climber: energy between the grips, what a grip takes, and that it climbs.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include "simulate/columns.hpp"

namespace anholon::climber_test {
namespace {

using testing::column_index;
using testing::scene_of;

/// Rows of one phase: between the switches, where the time of a row repeats.
using Rows = std::vector<std::vector<double>>;
std::vector<Rows> phases(const SimulationResult& result) {
  std::vector<Rows> parts(1);
  for (const auto& row : result.rows) {
    if (!parts.back().empty() && row[0] - parts.back().back()[0] < 1e-9) parts.emplace_back();
    parts.back().push_back(row);
  }
  return parts;
}

TEST(Climber, KeepsItsEnergyBetweenTheGripsWhileTheMotorIsLocked) {
  const SimulationResult result = simulate_scene(scene_of("climber/swing"));
  ASSERT_TRUE(result.finished) << result.status;
  const std::size_t kinetic = column_index(result, "kinetic"), potential = column_index(result, "potential");
  const std::vector<Rows> parts = phases(result);
  ASSERT_EQ(parts.size(), 4U);
  ASSERT_EQ(result.switches.size(), 3U);
  double before = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto energy = [&](const std::vector<double>& row) { return row[kinetic] + row[potential]; };
    const double start = energy(parts[i].front());
    double largest = 0;
    for (const auto& row : parts[i]) largest = std::max(largest, row[kinetic]);
    for (const auto& row : parts[i]) EXPECT_NEAR(energy(row), start, 1e-10 * largest) << "t = " << row[0];
    if (i > 0) {  // the loss that the summary reports; 1e-10 of the energies again
      EXPECT_NEAR(before - start, result.switches[i - 1].lost, 1e-10 * largest);
      EXPECT_GT(result.switches[i - 1].lost, 1e-4);
    }
    before = energy(parts[i].back());
  }
  EXPECT_LT(result.energy_balance, 1e-10);
}

// With a tail that does not bend and a locked motor the robot is one rigid body that changes its hinge: its
// moment of momentum about the hand that grips stays.
TEST(Climber, LosesAtAGripWhatARigidPendulumLoses) {
  std::ostringstream file;
  file << std::ifstream(testing::root + "/models/climber/swing.scene.toml").rdbuf();
  std::string text = file.str();
  text.insert(text.find("locked "), "modes = { tail = 0 }\n");
  const Scene scene = read_scene_text(text, testing::root + "/models/climber/swing.scene.toml");
  const SimulationResult result = simulate_scene(scene);
  ASSERT_TRUE(result.finished) << result.status;
  const auto value = [&](const char* name) {
    const auto found = std::ranges::find(scene.model.parameters, name, &Parameter::name);
    EXPECT_NE(found, scene.model.parameters.end()) << name;
    return found->value.to_double();
  };
  // masses on the axis of symmetry at (0, -y), from the middle of the hands
  const double a = value("a"), d = value("d"), L = value("L"), rod = value("rhoA") * L;
  struct Part {
    double mass, y, J;
  };
  double mass = 0, about_middle = 0;
  for (const Part& p :
       {Part{value("m_b"), value("h_b"), value("J_b")}, Part{rod, d + L / 2, rod * L * L / 12},
        Part{value("m_t"), d + L, value("J_t")}, Part{0, 0, value("J_m")}})
    mass += p.mass, about_middle += p.J + p.mass * p.y * p.y;
  const double about_hand = about_middle + mass * a * a;
  // The velocity of the mass centre when the body turns about one hand, and its moment about the other: the
  // two hands are a to either side of the axis, (c - h) . (c - h') = y_c^2 - a^2.
  const double about_other = about_middle - mass * a * a;
  const std::size_t Omega = column_index(result, "Omega_Z");
  const std::vector<Rows> parts = phases(result);
  ASSERT_EQ(parts.size(), 4U);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const double before = parts[i - 1].back()[Omega], after = about_other / about_hand * before;
    EXPECT_NEAR(parts[i].front()[Omega], after, 1e-12 * std::abs(before));  // rounding of a 2 x 2 solution
    EXPECT_NEAR(result.switches[i - 1].lost, about_hand * (before * before - after * after) / 2,
                1e-12 * about_hand * before * before);
    EXPECT_GT(std::abs(before), 0.1);
  }
}

TEST(Climber, ClimbsTenCentimetresAtEachStep) {
  const SimulationResult result = simulate_scene(scene_of("climber/climb"));
  ASSERT_TRUE(result.finished) << result.status;
  ASSERT_EQ(result.switches.size(), 9U);
  EXPECT_LT(result.energy_balance, 1e-10);
  EXPECT_LT(result.position_residual, 1e-12);  // m; the hand stays where it gripped
  const std::size_t y = column_index(result, "y"), theta = column_index(result, "theta");
  const std::vector<Rows> parts = phases(result);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    EXPECT_GT(result.switches[i - 1].lost, 1e-4) << "grip " << i;  // J
    const double rise = parts[i].back()[y] - parts[i].front()[y];
    EXPECT_GT(rise, 0.1) << "step " << i;
    if (i < 5) continue;  // the first steps settle
    EXPECT_NEAR(parts[i].back()[theta], -parts[i - 1].back()[theta], 0.02) << "step " << i;  // rad
  }
}

}  // namespace
}  // namespace anholon::climber_test
