// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/read_model.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "describe/mechanise.hpp"
#include "describe/outline.hpp"
#include "tape/interpret.hpp"

namespace anholon::read_model_test {
namespace {

using Json = nlohmann::json;

Model shipped(const std::string& name) {
  return read_model(fmt::format("{}/models/{}/{}.toml", ANHOLON_SOURCE_DIR, name, name));
}

Exact number(const Json& text) { return Exact::from_decimal(text.get<std::string>()); }

/// A model of one body, with more lines behind it.
Model small(const std::string& group, const std::string& lines) {
  return read_model_text("anholon = 1\nname = \"small\"\ngroup = \"" + group + "\"\n" + lines, "small.toml");
}

/// Value of an expression; the model's inputs that are not named are zero, R is the identity.
Exact value(const Model& model, const Expr& x,
            const std::vector<std::pair<std::string, Exact>>& inputs = {}) {
  Tape& tape = *model.tape;
  std::vector<Exact> values(tape.inputs().size());
  for (std::size_t i = 0; i < model.parameters.size(); ++i) values[i] = model.parameters[i].value;
  for (const std::size_t i : {0, 4, 8}) values[tape.node(model.symbols.R[i]).a] = 1;
  for (const auto& [name, v] : inputs) {
    const auto found = std::find(tape.inputs().begin(), tape.inputs().end(), name);
    EXPECT_NE(found, tape.inputs().end()) << name;
    values[static_cast<std::size_t>(found - tape.inputs().begin())] = v;
  }
  return interpret<Exact>(tape, {x.id(tape)}, values).front();
}

class Reference : public ::testing::TestWithParam<const char*> {
 protected:
  Reference() : model(shipped(GetParam())) {
    std::ifstream stream(ANHOLON_SOURCE_DIR "/tests/describe/references.json");
    reference = Json::parse(stream).at(GetParam());
  }
  Model model;
  Json reference;
};

TEST_P(Reference, HasItsParametersAndCoordinates) {
  ASSERT_EQ(model.parameters.size(), reference.at("parameters").size());
  for (const Parameter& parameter : model.parameters) {
    const Json& expected = reference.at("parameters").at(parameter.name);
    EXPECT_EQ(parameter.value, number(expected.at("value"))) << parameter.name;
    EXPECT_EQ(parameter.unit, expected.at("unit").get<std::string>());
    EXPECT_EQ(parameter.meaning, expected.at("meaning").get<std::string>());
  }
  std::vector<std::string> eta, passive, active;
  for (const int i : free_components(model.group))
    eta.emplace_back(twist_component_names[static_cast<std::size_t>(i)]);
  for (const Coordinate& coordinate : model.coordinates)
    (coordinate.drive == Drive::active ? active : passive).push_back(coordinate.name);
  EXPECT_EQ(Json(eta), reference.at("coordinates").at("eta"));
  EXPECT_EQ(Json(passive), reference.at("coordinates").at("r_p"));
  EXPECT_EQ(Json(active), reference.at("coordinates").at("r_a"));
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(value(model, model.gravity[i]), number(reference.at("gravity")[i]));
}

TEST_P(Reference, HasItsWrittenRows) {
  // rows that are declared rather than written are checked where the recursion is
  const auto order = [&](const Json& names, std::vector<std::string>& all) {
    for (const Json& name : names) all.push_back(name.get<std::string>());
  };
  std::vector<std::string> eta, passive, active;
  order(reference.at("coordinates").at("eta"), eta);
  order(reference.at("coordinates").at("r_p"), passive);
  order(reference.at("coordinates").at("r_a"), active);
  for (const Json& state : reference.at("states")) {
    const Json& inputs = state.at("inputs");
    std::vector<std::pair<std::string, Exact>> pose;
    for (std::size_t i = 0; i < passive.size(); ++i)
      pose.emplace_back(passive[i], number(inputs.at("r_p")[i]));
    for (std::size_t i = 0; i < active.size(); ++i) pose.emplace_back(active[i], number(inputs.at("r_a")[i]));
    for (std::size_t row = 0; row < model.rows.size(); ++row) {
      if (!model.rows[row].expression) continue;
      const auto coefficient = [&](const std::string& velocity) {
        auto at = pose;
        at.emplace_back(velocity, Exact(1));
        return value(model, *model.rows[row].expression, at);
      };
      const auto expect = [&](const std::string& velocity, const Json& entry) {
        EXPECT_LT(abs(coefficient(velocity) - number(entry)), Exact::from_decimal("1e-28"))
            << row << ' ' << velocity;
      };
      const Json& outputs = state.at("outputs");
      for (std::size_t i = 0; i < eta.size(); ++i) expect(eta[i], outputs.at("A")[row][i]);
      for (std::size_t i = 0; i < passive.size(); ++i) expect(passive[i] + "_dot", outputs.at("B_p")[row][i]);
      for (std::size_t i = 0; i < active.size(); ++i) expect(active[i] + "_dot", outputs.at("B_a")[row][i]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Reference,
                         ::testing::Values("mobile_pendulum", "bicycle", "rigid_snakeboard",
                                           "soft_snakeboard"));

TEST(ReadModel, ReadsEveryShippedModel) {
  for (const char* name : {"mobile_pendulum_one_wheel", "double_pendulum", "arm6", "free_chain",
                           "wheeled_snake3", "wheeled_snake5", "trailer"}) {
    const Model model = shipped(name);
    EXPECT_EQ(model.name, name);
    EXPECT_EQ(model.file, std::string(name) + ".toml");
    EXPECT_EQ(model.sha256.size(), 64U);
    EXPECT_TRUE(model.notes.empty()) << model.notes.front();
  }
}

TEST(ReadModel, MakesTheInputsOfTheTapeInTheirOrder) {
  const Model model = small("SE2", R"toml(
[parameters]
b = { value = "2.5", unit = "m" }
a = { value = 1, unit = "kg" }
[[body]]
name = "hull"
[[body]]
name = "arm"
parent = "hull"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "q" }
)toml");
  const std::vector<std::string> expected = {
      "b",   "a",   "t",   "R_XX", "R_XY", "R_XZ", "R_YX", "R_YY",    "R_YZ",    "R_ZX",    "R_ZY", "R_ZZ",
      "p_X", "p_Y", "p_Z", "q",    "V_X",  "V_Y",  "V_Z",  "Omega_X", "Omega_Y", "Omega_Z", "q_dot"};
  EXPECT_EQ(model.tape->inputs(), expected);
  EXPECT_EQ(model.parameters[0].value, Exact::ratio(5, 2));
}

TEST(ReadModel, TakesDecimalsFromTheTextAndNotFromADouble) {
  const Model model = small("SE3", R"toml(
[parameters]
a = { value = 0.1, unit = "kg" }
b = { value = 1_000.000_1, unit = "kg" }
c = { value = 0.1000000000000000055511151231257827, unit = "kg" }
[[body]]
name = "hull"
inertia = { mass = 1e-1 }
)toml");
  EXPECT_EQ(model.parameters[0].value, Exact::ratio(1, 10));
  EXPECT_EQ(model.parameters[1].value, Exact::ratio(10000001, 10000));
  EXPECT_NE(model.parameters[2].value, Exact::ratio(1, 10));
  EXPECT_EQ(value(model, model.bodies[0].mass), Exact::ratio(1, 10));
}

TEST(ReadModel, MovesInertiaToTheOriginByParallelAxes) {
  const Model model = small("SE3", R"toml(
[parameters]
m = { value = 3, unit = "kg" }
[[body]]
name = "by_com"
inertia = { mass = "m", com = [1, 2, 3], about_com = { xx = 5, yy = 6, zz = 7, xy = 0.1, xz = 0.2, yz = 0.3 } }
[[body]]
name = "by_first_moment"
parent = "by_com"
joint = { kind = "fixed" }
inertia = { mass = "m", first_moment = [3, 6, 9], about_com = { xx = 5, yy = 6, zz = 7, xy = 0.1, xz = 0.2, yz = 0.3 } }
[[body]]
name = "about_origin"
parent = "by_com"
joint = { kind = "fixed" }
inertia = { mass = "m", com = [1, 2, 3], about_origin = { xx = 44, yy = 36, zz = 22, xy = -5.9, xz = -8.8, yz = -17.7 } }
)toml");
  // I_com + m (c.c 1 - c c^T), c = (1, 2, 3), c.c = 14
  const std::array<Exact, 6> expected = {
      44, 36, 22, Exact::ratio(-59, 10), Exact::ratio(-88, 10), Exact::ratio(-177, 10)};
  for (const BodyDescription& body : model.bodies) {
    SCOPED_TRACE(body.name);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(value(model, body.inertia[i]), expected[i]) << i;
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(value(model, body.first_moment[i]), Exact(3 * (static_cast<int>(i) + 1)));
  }
}

TEST(ReadModel, LeavesWhatIsNotGivenAStructuralZero) {
  const Model model = shipped("rigid_snakeboard");
  const BodyDescription& rotor = model.bodies[3];
  EXPECT_TRUE(rotor.mass.is_zero());
  for (const Expr& s : rotor.first_moment) EXPECT_TRUE(s.is_zero());
  for (const std::size_t i : {0, 1, 3, 4, 5}) EXPECT_TRUE(rotor.inertia[i].is_zero());
  EXPECT_FALSE(rotor.inertia[2].is_zero());
}

TEST(ReadModel, ComposesRotations) {
  const Model model = small("SE3", R"toml(
[[body]]
name = "hull"
[[body]]
name = "turns"
parent = "hull"
pose = { rotation = [{ axis = "z", angle = "pi/2" }, { axis = "x", angle = "pi/2" }] }
joint = { kind = "fixed" }
[[body]]
name = "rpy"
parent = "hull"
pose = { rotation = { rpy = ["pi/2", 0, "pi/2"] } }
joint = { kind = "fixed" }
)toml");
  // Rz(90) Rx(90): x -> y, y -> z, z -> x
  const std::array<int, 9> expected = {0, 0, 1, 1, 0, 0, 0, 1, 0};
  for (const std::size_t body : {1, 2}) {
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_EQ(value(model, model.bodies[body].R[i]), Exact(expected[i])) << i;
  }
}

TEST(ReadModel, ScalesAxesToUnitLengthAndSaysSo) {
  const Model model = small("SE3", R"toml(
[[body]]
name = "hull"
[[body]]
name = "a"
parent = "hull"
joint = { kind = "revolute", axis = [0.6, 0, 0.8], coordinate = "r1" }
[[body]]
name = "b"
parent = "hull"
joint = { kind = "revolute", axis = [1, 0, 1], coordinate = "r2" }
)toml");
  EXPECT_EQ(value(model, model.bodies[1].joint.axis[0]), Exact::ratio(3, 5));
  EXPECT_LT(abs(value(model, model.bodies[2].joint.axis[0]) - sqrt(Exact::ratio(1, 2))),
            Exact::from_decimal("1e-100"));
  ASSERT_EQ(model.notes.size(), 1U);
  EXPECT_EQ(model.notes[0], "the axis of the joint of body 'b' (line 14) was scaled to unit length");
}

TEST(ReadModel, GathersSpringsDampersAndFriction) {
  const Model model = small("fixed", R"toml(
potential = "0.5*k*sin(r1)^2"
dissipation = "c*dot(r1)^4"
[parameters]
k = { value = 4, unit = "N m" }
c = { value = 3, unit = "J s^3" }
[[body]]
name = "base"
[[body]]
name = "a"
parent = "base"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r1", stiffness = "k", rest = 0.5, damping = 6, friction = { torque = 7, velocity = 0.01 } }
[[body]]
name = "b"
parent = "base"
joint = { kind = "prismatic", axis = [0, 0, 1], coordinate = "x", range = [-1, 1], stiffness = 10, damping = 2 }
)toml");
  const std::vector<std::pair<std::string, Exact>> at = {
      {"r1", Exact(2)}, {"x", Exact(3)}, {"r1_dot", Exact(1)}, {"x_dot", Exact(5)}};
  const Exact s = sin(Exact(2));
  EXPECT_LT(abs(value(model, model.potential, at) - (Exact::ratio(9, 2) + Exact(45) + Exact(2) * s * s)),
            Exact::from_decimal("1e-100"));
  EXPECT_EQ(value(model, model.dissipation, at), Exact(3 + 25 + 3));
  ASSERT_EQ(model.forces.size(), 1U);
  EXPECT_EQ(model.forces[0].index, 6);
  EXPECT_EQ(value(model, model.forces[0].force, at), -(Exact(7) * tanh(Exact(100))));
}

TEST(ReadModel, SpreadsTheForcesOfACoupledJointOverItsCoordinates) {
  const Model model = small("fixed", R"toml(
[[body]]
name = "base"
[[body]]
name = "a"
parent = "base"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r1" }
[[body]]
name = "b"
parent = "a"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r2" }
[[body]]
name = "c"
parent = "b"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r3", damping = 1 }
[[coupling]]
coordinate = "r3"
equals = "2*r1 + r2^2"
[[force]]
coordinate = "r3"
force = "5"
)toml");
  ASSERT_EQ(model.coordinates.size(), 2U);
  ASSERT_EQ(model.forces.size(), 2U);
  const std::vector<std::pair<std::string, Exact>> at = {
      {"r2", Exact(3)}, {"r1_dot", Exact(1)}, {"r2_dot", Exact(2)}};
  EXPECT_EQ(value(model, model.forces[0].force, at), Exact(10));
  EXPECT_EQ(value(model, model.forces[1].force, at), Exact(30));
  EXPECT_EQ(value(model, model.dissipation, at), Exact(98));  // (2 + 2*3*2)^2 / 2
}

TEST(ReadModel, DerivesTheRowsOfBladesAndWheels) {
  const Model model = shipped("mobile_pendulum");
  ASSERT_EQ(model.rows.size(), 2U);
  const RowDescription& row = model.rows[0];
  EXPECT_EQ(row.name, "rolling_front_wheel");
  ASSERT_EQ(row.terms.size(), 2U);
  EXPECT_EQ(row.terms[0].body, 0);
  EXPECT_EQ(value(model, row.terms[0].linear[0]), Exact(1));
  EXPECT_EQ(value(model, row.terms[0].point[0]), Exact::ratio(3, 10));
  EXPECT_EQ(row.terms[1].body, 1);
  EXPECT_EQ(value(model, row.terms[1].angular[1]), Exact::ratio(-12, 100));
  EXPECT_EQ(shipped("trailer").rows[1].name, "no_lateral_slip_trailer");
}

TEST(ReadModel, ReadsForcesAndFreeVelocities) {
  const Model model = small("SE2", R"toml(
free_velocities = ["V_X", "dot(r1)"]
[[body]]
name = "hull"
[[body]]
name = "arm"
parent = "hull"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r1" }
[[force]]
body = "arm"
force = ["-3*V_X", 0, 0]
point = [0.1, 0, 0]
axes = "world"
[[force]]
component = "Omega_Z"
force = "sin(t)"
[[force]]
coordinate = "r1"
force = "-R_XX*p_X*1"
)toml");
  EXPECT_EQ(model.free_velocities, (std::vector<std::string>{"V_X", "r1"}));
  ASSERT_EQ(model.wrenches.size(), 1U);
  EXPECT_TRUE(model.wrenches[0].in_world_axes);
  EXPECT_EQ(model.wrenches[0].body, 1);
  ASSERT_EQ(model.forces.size(), 2U);
  EXPECT_EQ(model.forces[0].index, 5);
  EXPECT_EQ(model.forces[1].index, 6);
}

TEST(ReadModel, ReadsTheExampleOfItsDocumentation) {
  std::ostringstream text;
  text << std::ifstream(ANHOLON_SOURCE_DIR "/docs/model-file.md").rdbuf();
  const std::string page = text.str();
  const std::string fence = "```toml\n";
  const std::size_t begin = page.find(fence) + fence.size();
  const Model model = read_model_text(page.substr(begin, page.find("```", begin) - begin), "example.toml");
  EXPECT_EQ(model.name, "cart_pendulum");
  EXPECT_EQ(model.coordinates.size(), 1U);
}

TEST(ReadModel, PlacesErrorsInStringsOfManyLines) {
  try {
    small("SE2", "[[body]]\nname = \"hull\"\n[[constraint]]\nrow = \"\"\"\nV_X\n  - V_Q\"\"\"\n");
    FAIL();
  } catch (const ModelError& error) {
    ASSERT_EQ(error.diagnostics().size(), 1U);
    EXPECT_EQ(error.diagnostics()[0].where.line, 9);
    EXPECT_EQ(error.diagnostics()[0].where.column, 5);
  }
}

TEST(ReadModel, CollectsErrorsInTheOrderOfTheFileAndStopsAtTwenty) {
  std::string lines = "[[body]]\nname = \"hull\"\n";
  for (int i = 0; i < 30; ++i) lines += fmt::format("[[force]]\nnonsense_{} = 1\n", i);
  try {
    small("SE2", lines);
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_EQ(error.diagnostics().size(), 20U);
    EXPECT_TRUE(std::is_sorted(error.diagnostics().begin(), error.diagnostics().end(),
                               [](const auto& a, const auto& b) { return a.where.line < b.where.line; }));
  }
}

TEST(ReadModel, RefusesFilesThatCannotBeRead) {
  for (const char* path : {"/nowhere/at/all.toml", "/"}) {
    try {
      read_model(path);
      FAIL();
    } catch (const ModelError& error) {
      EXPECT_EQ(std::string(error.what()),
                fmt::format("{}: error: the file cannot be read; check its path and permissions", path));
    }
  }
  EXPECT_THROW(read_model("/dev/zero"), ModelError);
}

}  // namespace
}  // namespace anholon::read_model_test
