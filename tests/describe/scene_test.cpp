// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/scene.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "describe/read_model.hpp"
#include "describe/specialise.hpp"
#include "tape/interpret.hpp"

namespace anholon::scene_test {
namespace {

const std::filesystem::path models = ANHOLON_SOURCE_DIR "/models";

/// A scene of the soft snake-board, given by its other lines.
Scene scene(const std::string& lines, const std::string& model = "soft_snakeboard") {
  return read_scene_text(fmt::format("anholon = 1\nname = \"test\"\nmodel = \"{}.toml\"\n{}", model, lines),
                         models / model / "test.scene.toml");
}

/// What reading gives, without the folder.
std::string error(const std::string& lines, const std::string& model = "soft_snakeboard") {
  try {
    scene(lines, model);
  } catch (const ModelError& e) {
    std::string text = e.what();
    const std::string prefix = (models / model / "").string();
    for (std::size_t at = 0; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
    return text;
  }
  return "no error";
}

/// Values of expressions at inputs given by name; the others are zero.
class Values {
 public:
  Values(const Model& model, const std::vector<std::pair<std::string, Exact>>& inputs) : model_(model) {
    const auto& names = model.tape->inputs();
    values_.assign(names.size(), Exact(0));
    for (std::size_t i = 0; i < model.parameters.size(); ++i) values_[i] = model.parameters[i].value;
    for (const auto& [name, value] : inputs) {
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == name) values_[i] = value;
      }
    }
  }
  Exact operator()(const Expr& x) const {
    return interpret<Exact>(*model_.tape, {x.id(*model_.tape)}, values_).front();
  }

 private:
  const Model& model_;
  std::vector<Exact> values_;
};

TEST(Scene, EveryShippedOneIsRead) {
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(models)) {
    if (!entry.path().string().ends_with(".scene.toml")) continue;
    SCOPED_TRACE(entry.path());
    const Scene s = read_scene(entry.path());
    EXPECT_TRUE(is_scene(entry.path()));
    EXPECT_FALSE(is_scene(s.model_file));
    EXPECT_EQ(entry.path().filename().string(), s.name + ".scene.toml");
    EXPECT_NO_THROW(specialise(s.model, s));
    ++count;
  }
  EXPECT_GE(count, 12);
}

TEST(Scene, MotionHasExactDerivatives) {
  const Scene s = scene("[motion]\nr1 = \"0.5*sin(2.5*t)\"\nr3 = \"t^3 + l/l\"\n");
  ASSERT_EQ(s.motion.size(), 2U);
  const Values at(s.model, {{"t", Exact(2)}});
  EXPECT_EQ(at(s.motion[1].r), Exact(9));
  EXPECT_EQ(at(s.motion[1].r_dot), Exact(12));
  EXPECT_EQ(at(s.motion[1].r_ddot), Exact(12));
  EXPECT_LT(abs(at(s.motion[0].r_ddot) + Exact::ratio(25, 8) * sin(Exact(5))), Exact::from_decimal("1e-100"));
}

TEST(Scene, OverridesParametersBeforeTheModelIsChecked) {
  EXPECT_EQ(scene("parameters = { l = 0.3 }\n").model.parameters[2].value, Exact::ratio(3, 10));
  EXPECT_TRUE(
      error("parameters = { L = \"-0.3\" }\n")
          .starts_with(
              "soft_snakeboard.toml:51:21: error: the length of the beam of body 'beam_3' is -0.3; it must"));
}

TEST(Scene, StartsAtItsInitialState) {
  const Scene s = read_scene(models / "bicycle" / "weave.scene.toml");
  const std::array<int, 9> upright = {0, 0, -1, 0, 1, 0, 1, 0, 0};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(s.initial.R[i], Exact(upright[i])) << i;
  EXPECT_EQ(s.initial.p[2], Exact::ratio(33, 100));
  ASSERT_EQ(s.initial.velocities.size(), 1U);
  EXPECT_EQ(s.initial.velocities[0].first, 4);
  const Scene soft = read_scene(models / "soft_snakeboard" / "gait.scene.toml");
  EXPECT_EQ(soft.initial.coordinates[0], (std::pair<int, Exact>(2, Exact::ratio(1, 50))));
  EXPECT_EQ(soft.initial.velocities[2], (std::pair<int, Exact>(9, Exact::ratio(1, 10))));
}

TEST(Scene, SpacesItsOutputs) {
  const std::string motion = "motion = { r1 = 0, r3 = 0 }\n";
  EXPECT_EQ(scene(motion + "duration = 1\noutput_step = 0.25\n").output_times,
            (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  EXPECT_EQ(scene(motion + "duration = 1\noutput_step = 0.4\n").output_times.back(), 1);
  EXPECT_EQ(scene(motion + "duration = 3\noutput_step = 0.1\n").output_times.size(), 31U);
}

TEST(Scene, ReadsMotionFromATable) {
  const std::filesystem::path file = models / "soft_snakeboard" / "test.scene.toml";
  const std::filesystem::path table =
      std::filesystem::temp_directory_path() / "anholon_motion_table_test.csv";
  std::ofstream(table) << "# gait\nt, r1, r3\n0, 0, 1\n 0.5 ,0.1,-1e-3\n\n1,0.2,0\n";
  const Scene s = scene(fmt::format("motion = {{ table = \"{}\", ends = \"clamped\" }}\n", table.string()));
  ASSERT_TRUE(s.motion_table);
  EXPECT_EQ(s.motion_table->times, (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(s.motion_table->rows[1], (std::vector<double>{0.1, -1e-3}));
  EXPECT_EQ(s.motion_table->ends, MotionTable::Ends::clamped);
  std::ofstream(table) << "t,r1\n0,0\n1\n2,x\n";
  const std::string text = error(fmt::format("motion = {{ table = \"{}\" }}\n", table.string()));
  EXPECT_NE(text.find(":3:1: error: the line has 1 numbers, the header 2 names; write one number a name"),
            text.npos);
  EXPECT_NE(text.find(":4:3: error: 'x' is not a number; write a finite decimal number"), text.npos);
  std::filesystem::remove(table);
}

TEST(Scene, SaysWhatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"durtion = 1\n", "5:1: error: unknown key 'durtion' in the scene; did you mean 'duration'?"},
      {"frozen = [\"mp\"]\n",
       "5:11: error: 'mp' is not a frozen parameter of the model; did you mean 'm_p'?"},
      {"frozen = [\"l\", \"l\"]\n", "5:16: error: 'l' is named twice; remove one"},
      {"frozen = \"some\"\n", "5:10: error: the list is a string; write an array of names, or \"all\""},
      {"parameters = { q = 1 }\n",
       "5:16: error: 'q' is not a parameter of the model; it has m_p, J_p, l, m_a, J_a, J_h, L, rhoA, EI and "
       "c_e"},
      {"parameters = { l = \"1/3\" }\n",
       "5:20: error: the value of parameter 'l' is not a decimal number; write for example 0.25 or 1e-3"},
      {"locked = { r2 = 0 }\n",
       "5:12: error: 'r2' is not an independent coordinate of the model; did you mean 'r1'?"},
      {"locked = { re3 = 0 }\n",
       "5:12: error: 're3' is a mode and cannot be locked; keep fewer modes: modes = { beam = 0 }"},
      {"locked = { r3 = \"l\" }\n",
       "5:17: error: the place of 'r3' has the unit m, but needs 1; check the expression and the units of "
       "its "
       "parameters"},
      {"modes = { beam_3 = 2 }\n",
       "5:20: error: 'beam_3' of the modes is 2; it needs to be an integer from 0 to 1"},
      {"modes = { hub = 0 }\n",
       "5:11: error: unknown key 'hub' in the modes; keys here are beam_3 and beam_4"},
      {"functions = [\"kinematics\", \"multiplier\"]\n",
       "5:28: error: there is no function 'multiplier'; did you mean 'multipliers'? choose from kinematics, "
       "reduced_velocities, constraints, free_dynamics, reduced_dynamics, split_dynamics, forward_dynamics, "
       "state_jacobian, "
       "inverse_torques, multipliers, compatibility, torque_driven_kinematics, torque_driven_velocities, "
       "torque_driven_dynamics, torque_driven_multipliers, position_conditions, energies and body_poses"},
      {"functions = [\"x\"]\n", "5:14: error: there is no function 'x'; choose from kinematics, "},
      {"functions = [\"energies\", \"energies\"]\n",
       "5:26: error: function 'energies' is named twice; remove one"},
      {"functions = [1]\n", "5:14: error: a function is a number; write its name"},
      {"gravity = 0\n", "5:11: error: 'gravity' of the scene is a number; it needs to be a boolean"},
      {"torque_driven = [\"re3\"]\n",
       "5:18: error: 're3' is not a torque-driven coordinate of the model; did you mean 'r3'?"},
      {"torque = { r1 = 0 }\n",
       "5:12: error: 'r1' is not torque-driven; name it in torque_driven, or write a force into the "
       "description"},
      {"motion = { re3 = \"sin(t)\" }\n",
       "5:12: error: 're3' is passive; only active coordinates move as told"},
      {"motion = { r1 = \"sin(tt)\" }\n", "5:22: error: 'tt' is not a known name; did you mean 't'?"},
      {"motion = { r1 = \"abs(t)\" }\n",
       "5:17: error: the motion of 'r1' has a kink; it needs two derivatives: do without abs and sign"},
      {"motion = { r1 = \"r3\" }\n",
       "5:18: error: 'r3' is a coordinate; only parameters and t may stand here"},
      {"motion = { table = \"none.csv\", r3 = \"t\" }\n",
       "5:20: error: there is no file 'none.csv'; name the table, relative to the "
       "scene\ntest.scene.toml:5:32: error: the motion has a "
       "table and 'r3'; write a column of the table for it, or expressions for all"},
      {"motion = { table = \"none.csv\" }\n",
       "5:20: error: there is no file 'none.csv'; name the table, relative to the scene"},
      {"initial = { coordinates = { r1 = 0 } }\n",
       "5:29: error: 'r1' starts where its motion starts; remove it, or name it in torque_driven"},
      {"initial = { velocities = { V_Z = 0 } }\n",
       "5:28: error: 'V_Z' is not a velocity that has a start; did you mean 'V_X'?"},
      {"duration = 0\n", "5:12: error: the duration is 0; it must be positive"},
      {"duration = 1\n",
       "1:1: error: the scene does not say how 'r1' moves; name it in motion, locked or torque_driven"},
      {"locked = { r1 = 0 }\nmotion = { r1 = 0 }\n",
       "1:1: error: 'r1' is driven in more than one way; keep it in one of locked, motion and torque_driven"},
      {"integrator = { method = \"euler\" }\n",
       "5:25: error: 'method' of the integrator is 'euler'; write one of dopri5, rkmk4, dopri8, rkmk8, cf4, "
       "rodas5p and auto"},
      {"integrator = { method = \"rkmk4\" }\n",
       "5:14: error: the method rkmk4 has no step; write step = 0.01, in s"},
      {"integrator = { method = \"cf4\", step = 0.1, tolerance = 1e-9 }\n",
       "5:56: error: the method cf4 has no tolerance; remove it; its step is fixed"},
      {"integrator = { method = \"dopri8\", step = 0.1 }\n",
       "5:42: error: the method dopri8 chooses its steps; remove the step"},
      {"duration = 1\noutput_times = [0, 2]\n",
       "6:20: error: the output time 2 is out of order; they increase from 0 to the duration"},
      {"duration = 1e9\noutput_step = 1e-9\n",
       "6:15: error: the scene asks for more than a million outputs; take a larger step"},
  };
  for (const auto& [lines, message] : cases)
    EXPECT_EQ(error("title = \"x\"\n" + lines).substr(0, message.size() + 16), "test.scene.toml:" + message)
        << lines;
  EXPECT_EQ(error("", "nowhere"),
            "test.scene.toml:3:9: error: there is no file 'nowhere.toml'; name the description, relative to "
            "the scene");
}

/// Everything that a scene does to expressions is a substitution: values before and after agree.
TEST(Specialise, KeepsValues) {
  const Scene s = scene(
      "frozen = [\"l\", \"EI\", \"J_h\"]\nlocked = { r3 = \"2*l\" }\nmodes = { beam_4 = 0 }\nparameters = { "
      "l = 0.4 }\n");
  const Model model = specialise(s.model, s);
  EXPECT_EQ(kept_coordinates(s.model, s), (std::vector<int>{0, -1, 1, -1}));
  ASSERT_EQ(model.coordinates.size(), 2U);
  EXPECT_EQ(model.coordinates[1].name, "re3");
  EXPECT_EQ(model.parameters.size(), 7U);
  EXPECT_EQ(model.tape->inputs()[0], "m_p");

  std::mt19937_64 rng(20130922);  // fixed: a failure must be repeatable
  for (int sample = 0; sample < 20; ++sample) {
    const auto number = [&] { return Exact::ratio(static_cast<long>(rng() % 2000) - 1000, 500); };
    std::vector<std::pair<std::string, Exact>> inputs = {
        {"r1", number()}, {"re3", number()}, {"r1_dot", number()}, {"re3_dot", number()}, {"V_X", number()}};
    const Values after(model, inputs);
    inputs.emplace_back("r3", Exact::ratio(4, 5));
    const Values before(s.model, inputs);
    EXPECT_LT(abs(before(s.model.potential) - after(model.potential)), Exact::from_decimal("1e-100"));
    EXPECT_EQ(before(s.model.dissipation), after(model.dissipation));
    for (std::size_t b = 0; b < model.bodies.size(); ++b) {
      const BodyDescription& old = s.model.bodies[b];
      const BodyDescription& body = model.bodies[b];
      EXPECT_EQ(before(old.mass), after(body.mass));
      EXPECT_EQ(before(old.joint.displacement), after(body.joint.displacement));
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(before(old.p[i]), after(body.p[i]));
      for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(before(old.inertia[i]), after(body.inertia[i]));
    }
  }
  EXPECT_EQ(model.bodies[4].modes.size(), 1U);
  EXPECT_EQ(model.bodies[4].modes[0].coordinate, 1);
  EXPECT_TRUE(model.bodies[5].modes.empty());
  EXPECT_TRUE(model.bodies[3].joint.coordinate.empty());
}

TEST(Specialise, FoldsEverythingThatIsFrozen) {
  const Scene s = scene("frozen = \"all\"\n");
  const Model model = specialise(s.model, s);
  EXPECT_TRUE(model.parameters.empty());
  for (const BodyDescription& body : model.bodies) {
    EXPECT_TRUE(model.tape->is_constant(body.mass.id(*model.tape)));
    EXPECT_TRUE(model.tape->is_constant(body.inertia[2].id(*model.tape)));
  }
}

TEST(Specialise, TakesGravityAway) {
  const Scene s = scene("gravity = false\n", "arm6");
  EXPECT_FALSE(s.model.gravity[2].is_zero());
  EXPECT_TRUE(specialise(s.model, s).gravity[2].is_zero());
}

TEST(Specialise, DropsRowsThatHoldByThemselves) {
  const std::filesystem::path model = std::filesystem::temp_directory_path() / "anholon_geared.toml";
  std::ofstream(model) << R"toml(
anholon = 1
name = "geared"
group = "fixed"
[[body]]
name = "base"
[[body]]
name = "a"
parent = "base"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r1", drive = "active" }
[[body]]
name = "b"
parent = "base"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r2" }
[[constraint]]
name = "gear"
row = "dot(r1) - 2*dot(r2)"
[[force]]
coordinate = "r2"
force = "-3*dot(r2)"
)toml";
  const Scene s = read_scene_text(
      fmt::format("anholon = 1\nname = \"s\"\nmodel = \"{}\"\nlocked = {{ r1 = 0, r2 = 0.5 }}\n",
                  model.string()),
      models / "s.toml");
  const Model cut = specialise(s.model, s);
  EXPECT_TRUE(cut.rows.empty());
  EXPECT_TRUE(cut.forces.empty());
  EXPECT_TRUE(cut.coordinates.empty());
  ASSERT_EQ(cut.notes.size(), 1U);
  EXPECT_EQ(cut.notes[0], "constraint 'gear' holds by itself in scene 's'");
  std::filesystem::remove(model);
}

TEST(Specialise, RefusesValuesThatLeaveTheModelUndefined) {
  const std::filesystem::path model = std::filesystem::temp_directory_path() / "anholon_undefined.toml";
  std::ofstream(model) << R"toml(
anholon = 1
name = "undefined"
group = "R1"
potential = "k/(p_X + l)"
[parameters]
k = { value = 1, unit = "J m" }
l = { value = 0, unit = "m" }
[[body]]
name = "base"
[[force]]
component = "V_X"
force = "k/l^2"
)toml";
  const Scene s = read_scene_text(
      fmt::format("anholon = 1\nname = \"s\"\nmodel = \"{}\"\nfrozen = \"all\"\n", model.string()),
      models / "s.toml");
  try {
    specialise(s.model, s);
    FAIL();
  } catch (const ModelError& e) {
    EXPECT_EQ(std::string(e.what()),
              "s.toml: error: frozen and locked values leave the model undefined: division by a constant "
              "zero; freeze "
              "other values, or fewer");
  }
  std::filesystem::remove(model);
}

}  // namespace
}  // namespace anholon::scene_test
