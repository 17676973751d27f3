// SPDX-License-Identifier: GPL-2.0-or-later

// Model files that stand on a URDF file: the same robot as one that is written as a model file from the
// start, and exact messages for what is wrong with them.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "anholon/free_dynamics.hpp"
#include "derive/derive.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "reduce/samples.hpp"

namespace anholon::supplement_test {
namespace {

namespace fs = std::filesystem;

/// A cart with two turning axles and a tail to be.
constexpr const char* urdf = R"(<robot name="cart">
<link name="hull"><inertial><origin xyz="0.1 0 0"/><mass value="4"/>
  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.25"/></inertial></link>
<link name="fore"><inertial><mass value="0.5"/>
  <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.012"/></inertial></link>
<link name="aft"><inertial><mass value="0.75"/>
  <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.015"/></inertial></link>
<joint name="steer" type="revolute"><parent link="hull"/><child link="fore"/><origin xyz="0.4 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="caster" type="continuous"><parent link="hull"/><child link="aft"/><origin xyz="-0.3 0 0"/>
  <axis xyz="0 0 1"/><dynamics damping="0.02"/></joint>
</robot>
)";

constexpr const char* supplement = R"(anholon = 1
urdf  = "cart.urdf"
group = "SE2"
[parameters]
k = { value = "0.7", unit = "N m", meaning = "caster spring" }
[[joint]]
name = "caster"
drive = "passive"
stiffness = "k"
rest = 0.1
[[body]]
name = "tail"
parent = "aft"
joint = { kind = "fixed" }
beam = { length = 0.5, mass_per_length = 0.2, bending_stiffness = 0.3, deformation = "quadratic" }
[[body]]
name = "flag"
parent = "hull"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "wave" }
inertia = { mass = 0.1, com = [0.2, 0, 0], about_com = { zz = 0.001 } }
[[coupling]]
coordinate = "wave"
equals = "2*steer"
[[constraint]]
kind = "no_lateral_slip"
body = "fore"
[[force]]
component = "V_X"
force = "-0.3*V_X"
)";

/// The same in one file.
constexpr const char* whole = R"(anholon = 1
name = "cart"
group = "SE2"
gravity = [0, 0, "-9.81"]
[parameters]
k = { value = "0.7", unit = "N m", meaning = "caster spring" }
[[body]]
name = "hull"
inertia = { mass = 4, com = [0.1, 0, 0], about_com = { xx = 0.1, yy = 0.2, zz = 0.25 } }
[[body]]
name = "fore"
parent = "hull"
pose = { translation = [0.4, 0, 0] }
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "steer", drive = "active", range = [-1, 1] }
inertia = { mass = 0.5, about_com = { xx = 0.01, yy = 0.01, zz = 0.012 } }
[[body]]
name = "aft"
parent = "hull"
pose = { translation = [-0.3, 0, 0] }
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "caster", stiffness = "k", rest = 0.1, damping = 0.02 }
inertia = { mass = 0.75, about_com = { xx = 0.01, yy = 0.01, zz = 0.015 } }
[[body]]
name = "tail"
parent = "aft"
joint = { kind = "fixed" }
beam = { length = 0.5, mass_per_length = 0.2, bending_stiffness = 0.3, deformation = "quadratic" }
[[body]]
name = "flag"
parent = "hull"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "wave" }
inertia = { mass = 0.1, com = [0.2, 0, 0], about_com = { zz = 0.001 } }
[[coupling]]
coordinate = "wave"
equals = "2*steer"
[[constraint]]
kind = "no_lateral_slip"
body = "fore"
[[force]]
component = "V_X"
force = "-0.3*V_X"
)";

class Supplement : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("anholon_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::create_directories(folder_);
    write("cart.urdf", urdf);
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  [[nodiscard]] Model read(const std::string& text) const {
    write("robot.toml", text);
    return read_model(folder_ / "robot.toml");
  }
  /// Message without the folder.
  [[nodiscard]] std::string fault(const std::string& text) const {
    try {
      static_cast<void>(read(text));
      return "";
    } catch (const ModelError& error) {
      std::string message = error.what();
      const std::string prefix = (folder_ / "").string();
      for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix))
        message.erase(at, prefix.size());
      return message;
    }
  }
  fs::path folder_;
};

TEST_F(Supplement, MakesTheSameRobotAsOneModelFile) {
  const Model one = read(supplement);
  const Model other = read_model_text(whole, "whole.toml");
  ASSERT_EQ(one.coordinates.size(), other.coordinates.size());
  for (std::size_t i = 0; i < one.coordinates.size(); ++i) {
    EXPECT_EQ(one.coordinates[i].name, other.coordinates[i].name);
    EXPECT_EQ(one.coordinates[i].drive, other.coordinates[i].drive);
    EXPECT_EQ(one.coordinates[i].lower, other.coordinates[i].lower);
  }
  const std::vector<Exact> parameters = {one.parameters.at(0).value};
  const Mechanism<Exact> a = mechanise<Exact>(describe_mechanism(one), parameters);
  const Mechanism<Exact> b = mechanise<Exact>(describe_mechanism(other), parameters);
  FreeDynamics<Exact> x(a), y(b);
  SampleSource source;
  const Exact tiny = Exact::from_decimal("1e-50");  // of numbers of 60 digits or more, about 1 in size
  const auto same = [&](const std::vector<Exact>& p, const std::vector<Exact>& q) {
    ASSERT_EQ(p.size(), q.size());
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_LT(abs(p[i] - q[i]), tiny) << i;
  };
  for (int i = 0; i < 5; ++i) {
    const State<Exact> state = random_state(other, source);
    same(x.mass_matrix(state).entries(), y.mass_matrix(state).entries());
    same(x.forces(state), y.forces(state));
    const auto [G, bias] = x.constraints(state);
    const auto [H, other_bias] = y.constraints(state);
    same(G.entries(), H.entries());
    same(bias, other_bias);
  }
}

TEST_F(Supplement, GoesThroughTheReduction) {
  const auto derivation = derive(read(supplement));
  EXPECT_EQ(derivation->reduction.partition.s_p(), 2);
  EXPECT_EQ(derivation->reduction.partition.s_a(), 1);
  EXPECT_EQ(derivation->reduction.ranks.m, 1);
}

TEST_F(Supplement, CouplesAJointOfTheFile) {
  const std::string text =
      "anholon = 1\nurdf = \"cart.urdf\"\n[[coupling]]\ncoordinate = \"steer\"\nequals = \"0.5*caster^2\"\n";
  const Model model = read(text);
  ASSERT_EQ(model.coordinates.size(), 1U);
  EXPECT_EQ(model.coordinates[0].name, "caster");
  const Mechanism<double> m = mechanise<double>(describe_mechanism(model), std::vector<double>{});
  FreeDynamics<double> dynamics(m);
  State<double> state;
  state.r = {0.8}, state.r_dot = {0};
  // fixed hull: each axle turns about z, so M = I_aft + I_fore (d steer / d caster)^2
  EXPECT_NEAR(dynamics.mass_matrix(state)(0, 0), 0.015 + 0.012 * 0.8 * 0.8, 1e-16);
}

TEST_F(Supplement, HasExactMessages) {
  const std::string head = "anholon = 1\nurdf = \"cart.urdf\"\n";
  EXPECT_EQ(fault("anholon = 1\nurdf = \"wagon.urdf\"\n"),
            "robot.toml:2:8: error: 'wagon.urdf' is not a URDF file; name a file ending in .urdf, .sdf, "
            ".mjcf or .xml, "
            "relative to this one");
  EXPECT_EQ(fault(head + "[[joint]]\nname = \"steet\"\n"),
            "robot.toml:4:8: error: 'steet' is not a joint that moves a coordinate; did you mean 'steer'?");
  EXPECT_EQ(fault(head + "[[joint]]\nname = \"steer\"\nstifness = 3\n"),
            "robot.toml:5:1: error: unknown key 'stifness' in joint 'steer'; did you mean 'stiffness'?");
  EXPECT_EQ(fault(head + "grup = \"SE2\"\n"),
            "robot.toml:3:1: error: unknown key 'grup' in the description; did you mean 'group'?");
  EXPECT_EQ(fault(head + "[[joint]]\nname = \"steer\"\n[[joint]]\nname = \"steer\"\n"),
            "robot.toml:6:8: error: joint 'steer' stands here twice; write its keys in one table");
  EXPECT_EQ(fault(head + "[[joint]]\nname = \"steer\"\nstiffness = \"k\"\n"),
            "robot.toml:5:14: error: 'k' is not a known name; only numbers are known here");
  EXPECT_EQ(fault(head + "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"for\"\n"),
            "robot.toml:5:8: error: 'for' is not a body; did you mean 'fore'?");
  EXPECT_EQ(
      fault(head + "[[coupling]]\ncoordinate = \"caster\"\nequals = \"steer\"\n"),
      "cart.urdf:10:1: error: joint 'caster' has damping, friction or a spring, and 'caster' is coupled by a "
      "supplement; say it in the supplement instead, as a coupling, damping, friction or stiffness");
}

}  // namespace
}  // namespace anholon::supplement_test
