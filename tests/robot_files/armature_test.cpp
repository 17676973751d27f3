// SPDX-License-Identifier: GPL-2.0-or-later

// Armatures: what a motor's inertia adds to its joint. On a body that stands still it is the same as a rotor
// that turns about the joint's axis behind a gear, and that rotor can be described as a body with a coupling.

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "anholon/free_dynamics.hpp"
#include "check/verify_tree.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "robot_files/same_robot.hpp"
#include "tape/interpret.hpp"

namespace anholon::armature_test {
namespace {

/// Two joints, the first of which stands on the base.
/// @param first  kind, axis and further keys of the first joint
/// @param more  further bodies and couplings
std::string two_joints(const std::string& first, const std::string& drive, const std::string& more = "") {
  return R"(anholon = 1
name    = "two"
group   = "fixed"
gravity = [0, 0, -9.81]
[parameters]
J = { value = 0.0007, unit = "kg m^2" }
m = { value = 0.09, unit = "kg" }
[[body]]
name = "base"
[[body]]
name    = "one"
parent  = "base"
pose    = { translation = [0.1, 0.2, 0.3] }
joint   = { coordinate = "r1", range = [-1, 1], drive = ")" +
         drive + "\", " + first + R"( }
inertia = { mass = 1.4, com = [0.1, 0.02, -0.3], about_com = { xx = 0.02, yy = 0.045, zz = 0.03, xy = 0.001 } }
[[body]]
name    = "two"
parent  = "one"
pose    = { translation = [0, 0.1, -0.6] }
joint   = { kind = "revolute", axis = [0.6, 0, 0.8], coordinate = "r2", drive = "active", armature = 0.03 }
inertia = { mass = 0.9, com = [0.02, 0.1, -0.2], about_com = { xx = 0.01, yy = 0.018, zz = 0.012 } }
)" + more;
}

/// The second rotor's place in the file is in front of its coupling.
std::string rotor(const std::string& joint, const std::string& inertia) {
  return "[[body]]\nname = 'rotor'\nparent = 'base'\npose = { translation = [0.4, 0.2, 0.5] }\njoint = { "
         "coordinate "
         "= 'q', " +
         joint + " }\ninertia = { " + inertia + " }\n[[coupling]]\ncoordinate = 'q'\nequals = '7*r1'\n";
}

struct Pair {
  std::string armature, rotor;  // the same robot
};
std::vector<Pair> pairs(const std::string& drive) {
  const std::string turn = "axis = [0, 1, 0]", along = "axis = [1, 0, 0]";
  return {{two_joints("kind = 'revolute', " + turn + ", armature = '49*J'", drive),
           two_joints("kind = 'revolute', " + turn, drive,
                      rotor("kind = 'revolute', " + turn, "about_com = { yy = 'J' }"))},
          {two_joints("kind = 'prismatic', " + along + ", armature = '49*m'", drive),  // level: no weight
           two_joints("kind = 'prismatic', " + along, drive,
                      rotor("kind = 'prismatic', " + along, "mass = 'm'"))},
          {two_joints("kind = 'helical', pitch = 0.2, " + turn + ", armature = '49*J'", drive),
           two_joints("kind = 'helical', pitch = 0.2, " + turn, drive,
                      rotor("kind = 'revolute', " + turn, "about_com = { yy = 'J' }"))}};
}

/// Values of all outputs of the named functions at one random state, the same for programs with equal inputs.
std::vector<Exact> values(const Program& program, const std::vector<std::string>& functions) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Exact> inputs(program.tape.inputs().size(), Exact(0));
  for (const ParameterInfo& p : program.parameters) inputs[program.tape.node(p.node).a] = p.value;
  for (const InputBlock& b : program.inputs) {
    for (const NodeId id : b.nodes) inputs[program.tape.node(id).a] = Exact::from_double(uniform(random));
  }
  std::vector<NodeId> roots;
  for (const std::string& name : functions) {
    const auto f = std::ranges::find(program.functions, name, &Function::name);
    if (f == program.functions.end()) throw std::out_of_range(name);
    for (const OutputBlock& b : f->outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  }
  return interpret<Exact>(program.tape, roots, inputs);
}

void expect_equal(const std::vector<Exact>& a, const std::vector<Exact>& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_LT(abs(a[i] - b[i]).to_double(), 1e-60) << "entry " << i;  // both are exact to 100 digits
}

TEST(Armature, IsARotorBehindAGear) {
  TreeRequest request;
  request.functions = {"inverse_dynamics", "bias_forces", "gravity_forces",     "mass_matrix",
                       "forward_dynamics", "mass_factor", "inverse_mass_matrix"};
  for (const Pair& pair : pairs("active")) {
    const auto with_armature = derive_tree(read_model_text(pair.armature, "two.toml"), request);
    const auto with_rotor = derive_tree(read_model_text(pair.rotor, "two.toml"), request);
    expect_equal(values(with_armature->program, request.functions),
                 values(with_rotor->program, request.functions));
  }
}

TEST(Armature, OfAPassiveJointIsInTheReducedDynamics) {
  for (const Pair& pair : pairs("passive")) {
    const auto with_armature = derive(read_model_text(pair.armature, "two.toml"));
    const auto with_rotor = derive(read_model_text(pair.rotor, "two.toml"));
    const std::vector<std::string> functions = {"forward_dynamics", "inverse_torques", "reduced_dynamics"};
    expect_equal(values(with_armature->program, functions), values(with_rotor->program, functions));
  }
}

/// Hinges, slides, a coupling and a free base, all with armatures.
const std::string robot_with_armatures = R"(<mujoco model="geared">
  <default><joint armature="0.02" damping="0.3"/><default class="big"><joint armature="0.4"/></default></default>
  <worldbody>
    <body name="trunk"><freejoint/>
      <inertial pos="0.01 0 0.02" mass="4" diaginertia="0.05 0.06 0.07"/>
      <body name="hip" pos="0 0.1 0">
        <inertial pos="0 0.02 0" mass="1" diaginertia="0.004 0.005 0.003"/>
        <joint name="h1" axis="1 0 0" class="big"/>
        <joint name="h2" axis="0 1 0" pos="0 0 -0.05"/>
        <body name="leg" pos="0 0 -0.3">
          <inertial pos="0.01 0 -0.1" mass="0.8" fullinertia="0.004 0.005 0.001 0.0003 0 0.0001"/>
          <joint name="slide" type="slide" axis="0.6 0 0.8" armature="1.5"/>
        </body>
        <body name="foot" pos="0.1 0 -0.2">
          <inertial pos="0.02 0.01 -0.1" mass="0.3" diaginertia="0.001 0.002 0.001"/>
          <joint name="toe" axis="1 1 1" armature="0.05"/>
        </body>
      </body>
      <body name="arm" pos="0 -0.1 0.2">
        <inertial pos="0.2 0 0.01" mass="0.6" diaginertia="0.001 0.003 0.003"/>
        <joint name="arm" axis="0 0 1" armature="0"/>
      </body>
    </body>
  </worldbody>
  EQUALITY
</mujoco>)";
std::string with_equality(const std::string& text) {
  std::string all = robot_with_armatures;
  return all.replace(all.find("EQUALITY"), 8, text);
}

TEST(Armature, EveryFunctionAgreesWithTheRecursion) {
  const std::string coupled =
      "<equality><joint joint1='toe' joint2='h2' polycoef='0.1 -2 0 0 0'/></equality>";
  RobotOptions symbolic;
  symbolic.symbolic_inertia = true;
  for (const auto& [equality, options] :
       {std::pair(std::string(), RobotOptions{}), {coupled, RobotOptions{}}, {std::string(), symbolic}}) {
    const Model model = read_robot_text(with_equality(equality), "geared.xml", options);
    TreeRequest request;
    request.optimise = OptimiseFor::speed;  // armatures matter to what is computed, not to its rounding
    if (!options.symbolic_inertia) request.functions = tree_function_names();
    const auto derivation = derive_tree(model, request);
    const Verification v = verify_tree(model, *derivation, {5}, {});
    EXPECT_LE(v.formula_worst, formula_bound) << v.formula_at;
    EXPECT_LE(v.energy_balance, 1e-11);  // the bound of verify
    for (const OutputError& e : v.outputs)
      EXPECT_TRUE(e.passed) << e.function << "." << e.output << ": " << e.worst;
  }
}

/// Without armatures, and with the difference put on the diagonal of the mass matrix.
TEST(Armature, StandsOnTheDiagonalOfTheMassMatrix) {
  const auto matrix = [](const Model& model) {
    const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), {});
    State<double> s;
    s.r.assign(model.coordinates.size(), 0.3), s.r_dot.assign(model.coordinates.size(), 0.0);
    return FreeDynamics<double>(mechanism).mass_matrix(s);
  };
  const Model with = read_robot_text(with_equality(""), "geared.xml");
  Model without = read_robot_text(with_equality(""), "geared.xml");
  for (BodyDescription& b : without.bodies) b.joint.armature = 0;
  const Matrix<double> A = matrix(with), B = matrix(without);
  const std::map<std::string, double> expected = {
      {"h1", 0.4}, {"h2", 0.02}, {"slide", 1.5}, {"toe", 0.05}, {"arm", 0}};
  for (int i = 0; i < A.rows(); ++i) {
    for (int j = 0; j < A.rows(); ++j) {
      const double on_diagonal =
          i == j && i >= 6 ? expected.at(with.coordinates[static_cast<std::size_t>(i - 6)].name) : 0;
      EXPECT_NEAR(A(i, j) - B(i, j), on_diagonal, 1e-14);  // of entries up to 6 kg
    }
  }
}

TEST(Armature, OfALockedJointIsGone) {
  const Model model =
      read_model_text(two_joints("kind = 'revolute', axis = [0, 1, 0], armature = 1", "active") +
                          "[[coupling]]\ncoordinate = "
                          "'r3'\nequals = '0.4'\n[[body]]\nname = "
                          "'three'\nparent = 'two'\njoint = { kind "
                          "= 'revolute', axis = [1, 0, 0], "
                          "coordinate = 'r3', armature = 5 }\n",
                      "two.toml");
  const MechanismDescription d = describe_mechanism(model);
  EXPECT_EQ(d.bodies[1].armature.constant_value()->to_double(), 1.0);
  EXPECT_TRUE(d.bodies[3].armature.is_zero());
}

TEST(Armature, MustNotBeNegative) {
  try {
    read_model_text(two_joints("kind = 'revolute', axis = [0, 1, 0], armature = '-J'", "active"), "two.toml");
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_EQ(error.diagnostics().front().fact, "the armature of the joint of body 'one' is -0.0007");
  }
}

}  // namespace
}  // namespace anholon::armature_test
