// SPDX-License-Identifier: GPL-2.0-or-later
// Scenes that can be simulated but not measured: who measures says so, and takes no other fault for it.

#include <nlohmann/json.hpp>

#include "report/record.hpp"
#include "simulate/columns.hpp"
#include "simulate/path_conditioning.hpp"
#include "simulate/stiffness_ladder.hpp"
#include "simulate/written_scene.hpp"

namespace anholon::unfit_scenes_test {
namespace {

using testing::two_bodies;
using testing::written_scene;

const std::string phases = R"(duration = 1
contact_sets = { open = [], latched = ["latch"] }
phase = [{ contacts = "open" }, { start = 0.5, contacts = "latched" }]
initial = { coordinates = { r1 = 2.5 }, velocities = { V_X = 4, r1 = -5 } }
)";

nlohmann::ordered_json record_of(const std::string& lines) {
  return motion_record(written_scene(two_bodies, lines), [](const std::string&) {});
}

TEST(PathConditioning, RefusesASecondPhase) {
  try {
    path_conditioning(written_scene(two_bodies, phases));
    FAIL() << "two phases were accepted";
  } catch (const UnfitSceneError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("scene.toml:6:"), std::string::npos) << text;
    EXPECT_NE(text.find("error: conditioning is followed along the motion of one set of contacts; take a "
                        "scene of one phase"),
              std::string::npos)
        << text;
  }
}

TEST(MotionRecord, LeavesOutTheLadderOfSeveralPhases) {
  const nlohmann::ordered_json record = record_of(phases);
  EXPECT_EQ(record.at("run").at("status"), "ok");
  EXPECT_FALSE(record.contains("ladder"));
  EXPECT_NE(record.at("left_out").get<std::string>().find("take a scene of one phase"), std::string::npos);
}

TEST(MotionRecord, LeavesOutASceneWithoutDuration) {
  const nlohmann::ordered_json record = record_of("");
  EXPECT_FALSE(record.contains("run"));
  EXPECT_NE(record.at("left_out").get<std::string>().find("the scene has no duration"), std::string::npos);
}

TEST(MotionRecord, DoesNotLeaveOutASceneThatIsWrong) {
  EXPECT_THROW(record_of("duration = 1\nincompatible_motion = \"project\"\n"
                         "integrator = { method = \"rodas5p\", tolerance = 1e-9 }\n"),
               ModelError);
}

// The wheels of the cart turn apart: springs between them and the ground allow that, rigid contacts do not.
TEST(Stiffening, RefusesAMotionThatStopsWithRigidContacts) {
  const Scene scene = read_scene_text(
      "anholon = 1\nname = \"test\"\nmodel = \"mobile_pendulum.toml\"\nduration = 1\n"
      "contact_elasticity = { stiffness = 1e4, damping = 400 }\n"
      "motion = { r1 = \"sin(t)\", r2 = \"sin(t) + t^4\" }\n",
      testing::root + "/models/mobile_pendulum/test.scene.toml");
  try {
    stiffness_ladder(scene, {1});
    FAIL() << "the motion was accepted";
  } catch (const ModelError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("error: with rigid contacts the motion stops before its end: the imposed "),
              std::string::npos)
        << text;
  }
}

}  // namespace
}  // namespace anholon::unfit_scenes_test
