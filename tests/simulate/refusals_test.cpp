// SPDX-License-Identifier: GPL-2.0-or-later
// What cannot be simulated is refused with its place, the fact and a way out.

#include "simulate/columns.hpp"
#include "simulate/work_precision.hpp"

namespace anholon::refusals_test {
namespace {

/// What simulating a scene of the soft snake-board says, without the folder.
std::string refusal(const std::string& lines) {
  const std::string folder = testing::root + "/models/soft_snakeboard/";
  try {
    simulate_scene(read_scene_text("anholon = 1\nname = \"test\"\nmodel = \"soft_snakeboard.toml\"\n" + lines,
                                   folder + "test.scene.toml"));
  } catch (const ModelError& error) {
    const std::string text = error.what();
    return text.starts_with(folder) ? text.substr(folder.size()) : text;
  }
  return "none";
}

const std::string motion = "motion = { r1 = \"sin(t)\", r3 = \"cos(t)\" }\n";

TEST(Simulation, RefusesASceneWithoutDuration) {
  EXPECT_EQ(
      refusal(motion),
      "test.scene.toml:1:1: error: the scene has no duration; write how long it lasts, in s: duration = 5");
}

TEST(Simulation, RefusesASceneWithoutMotion) {
  EXPECT_TRUE(refusal("duration = 1")
                  .starts_with("test.scene.toml:1:1: error: the scene does not say how 'r1' moves; "
                               "name it in motion, locked or torque_driven"));
}

TEST(Simulation, StartsAtRestWithoutAnInitialState) {
  EXPECT_EQ(refusal(motion + "duration = 0.01"), "none");
}

TEST(Simulation, RefusesVelocitiesThatTheConstraintsDoNotAllow) {
  EXPECT_EQ(refusal(motion + "duration = 1\ninitial = { velocities = { V_X = 0.5, V_Y = 1 } }"),
            "test.scene.toml:6:11: error: the initial velocities violate constraint "
            "'no_lateral_slip_rear_axle' by 1; "
            "leave velocities out that the constraints determine, or make the motion compatible at t = 0");
}

TEST(Simulation, RefusesADescription) {
  const std::string file = testing::root + "/models/soft_snakeboard/soft_snakeboard.toml";
  try {
    read_scene(file);
    FAIL() << "no error";
  } catch (const ModelError& error) {
    EXPECT_EQ(error.what(),
              file +
                  ":1:1: error: the file describes a robot, not a scene; write a scene beside it that "
                  "begins with anholon = 1, a name and model = \"soft_snakeboard.toml\"");
  }
}

}  // namespace
}  // namespace anholon::refusals_test
