// SPDX-License-Identifier: GPL-2.0-or-later
//
// Joints, groups and couplings against the positions of point masses.
#include <gtest/gtest.h>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "mechanics/witness.hpp"

namespace anholon::joint_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests
using std::cos, std::sin;

// ---- every joint about every axis
// --------------------------------------------------------------------------------

struct Axis {
  const char* name;
  const char* text;
  std::array<Real, 3> value;
};
const Real alpha = 0.7L, beta = 2.3L;
const Axis axes[] = {
    {"X", "[1, 0, 0]", {1, 0, 0}},
    {"Y", "[0, 1, 0]", {0, 1, 0}},
    {"Z", "[0, 0, 1]", {0, 0, 1}},
    {"MinusX", "[-1, 0, 0]", {-1, 0, 0}},
    {"MinusY", "[0, -1, 0]", {0, -1, 0}},
    {"MinusZ", "[0, 0, -1]", {0, 0, -1}},
    {"ObliqueXY", "[0.6, -0.8, 0]", {0.6L, -0.8L, 0}},
    {"ObliqueYZ", "[0, -0.28, 0.96]", {0, -0.28L, 0.96L}},
    {"ObliqueZX", "[-0.8, 0, 0.6]", {-0.8L, 0, 0.6L}},
    {"Oblique", "[\"2/3\", \"-1/3\", \"2/3\"]", {2 / 3.0L, -1 / 3.0L, 2 / 3.0L}},
    {"ObliqueBackwards", "[\"2/7\", \"3/7\", \"-6/7\"]", {2 / 7.0L, 3 / 7.0L, -6 / 7.0L}},
    {"Scaled", "[1, 2, -2]", {1 / 3.0L, 2 / 3.0L, -2 / 3.0L}},
    {"SymbolicInAPlane", "[\"cos(alpha)\", 0, \"-sin(alpha)\"]", {cos(alpha), 0, -sin(alpha)}},
    {"Symbolic",
     "[\"cos(alpha)*cos(beta)\", \"sin(alpha)*cos(beta)\", \"sin(beta)\"]",
     {cos(alpha) * cos(beta), sin(alpha) * cos(beta), sin(beta)}},
};

struct JointCase {
  const char* kind;
  Axis axis;
};
void PrintTo(const JointCase& c, std::ostream* stream) { *stream << c.kind << ' ' << c.axis.name; }

class Joint : public testing::TestWithParam<JointCase> {};

// A free base, the joint under test in a tilted place, a hinge behind it, and a body fixed to that: each
// body's frame may be turned by what the reader makes of its axis, and none of this may show.
TEST_P(Joint, MovesTheMassesAsItsTransformSays) {
  const auto& [kind, axis] = GetParam();
  const std::string kind_text = kind;
  const std::string more = kind_text == "prismatic" ? ", range = [-1, 1]"
                           : kind_text == "helical" ? ", pitch = 0.13"
                                                    : "";
  Witness w;
  w.description =
      header("SE3",
             "gravity = [1.3, -0.7, -9.6]\n[parameters]\nalpha = { value = 0.7, unit = \"rad\" }\nbeta = { "
             "value = "
             "2.3, unit = \"rad\" }") +
      body("base", "", cloud(0)) +
      body("moving", "base", cloud(1),
           fmt::format(
               "pose = {{ translation = [0.2, -0.3, 0.4], rotation = {{ axis = \"y\", angle = 0.4 }} }}\n"
               "joint = {{ kind = \"{}\", axis = {}, coordinate = \"a\"{} }}",
               kind, axis.text, more),
           false) +
      body("hinged", "moving", cloud(2),
           "pose = { translation = [0.1, 0.25, -0.2], rotation = { axis = \"x\", angle = -0.9 } }\n"
           "joint = { kind = \"revolute\", axis = [0, -0.6, 0.8], coordinate = \"b\" }") +
      body("tip", "hinged", cloud(0),
           "pose = { translation = [-0.1, 0, 0.3], rotation = [{ axis = \"z\", angle = 0.5 }, { axis = "
           "\"x\", angle = 0.3 }] }\n"
           "joint = { kind = \"fixed\" }");
  w.gravity = {1.3L, -0.7L, -9.6L};
  w.masses = [kind_text, axis = axis](const Pose& g, const std::vector<Jet>& r) {
    Pose motion;
    if (kind_text != "prismatic") motion = turned(axis.value, r[0]);
    const Jet along = kind_text == "prismatic" ? r[0] : kind_text == "helical" ? Jet(0.13L) * r[0] : Jet(0);
    motion.p = Vector(along * axis.value[0], along * axis.value[1], along * axis.value[2]);
    const Pose moving = g * moved({0.2L, -0.3L, 0.4L}) * turned({0, 1, 0}, 0.4L) * motion;
    const Pose hinged =
        moving * moved({0.1L, 0.25L, -0.2L}) * turned({1, 0, 0}, -0.9L) * turned({0, -0.6L, 0.8L}, r[1]);
    const Pose tip = hinged * moved({-0.1L, 0, 0.3L}) * turned({0, 0, 1}, 0.5L) * turned({1, 0, 0}, 0.3L);
    std::vector<MassPoint> points;
    add(points, g, cloud(0)), add(points, moving, cloud(1)), add(points, hinged, cloud(2)),
        add(points, tip, cloud(0));
    return points;
  };
  expect_mechanics_of(w);
}

std::vector<JointCase> joint_cases() {
  std::vector<JointCase> cases;
  for (const char* kind : {"revolute", "prismatic", "helical"}) {
    for (const Axis& axis : axes) cases.push_back({kind, axis});
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Kinds, Joint, testing::ValuesIn(joint_cases()), [](const auto& info) {
  std::string name = info.param.kind;
  name[0] = static_cast<char>(std::toupper(name[0]));
  return name + "About" + info.param.axis.name;
});

// The axes stay right when parameters change after the description was read, though the axis that the frame
// is turned to was chosen at their defaults.
TEST(Joint, KeepsItsAxisWhenItsParametersChange) {
  const auto text = [](const char* value) {
    return header("SE3", fmt::format("[parameters]\nalpha = {{ value = {}, unit = \"rad\" }}\n", value)) +
           body("base", "", cloud(0)) +
           body("arm", "base", cloud(1),
                "joint = { kind = \"helical\", pitch = 0.2, axis = [\"cos(alpha)/3\", \"sin(alpha)/3\", "
                "\"2*sqrt(2)/3\"], coordinate = "
                "\"a\" }");
  };
  const MechanismDescription there = describe_mechanism(read_model_text(text("0.4"), "there.toml"));
  const MechanismDescription here = describe_mechanism(read_model_text(text("2.9"), "here.toml"));
  const Model model = read_model_text(text("2.9"), "here.toml");
  const Mechanism<Real> changed = mechanise<Real>(there, {2.9L});
  const Mechanism<Real> direct = mechanise<Real>(here, {2.9L});
  std::mt19937_64 rng(20130922);
  for (int i = 0; i < 20; ++i) {
    const State<Real> state = random_position_and_velocity(model, rng);
    FreeDynamics<Real> a(changed), b(direct);
    const auto f = a.forces(state);
    const auto g = b.forces(state);
    for (std::size_t k = 0; k < f.size(); ++k) EXPECT_NEAR(static_cast<double>(f[k] - g[k]), 0, 1e-17);
  }
}

// ---- every group
// --------------------------------------------------------------------------------------------------

class Group : public testing::TestWithParam<GroupKind> {};

// A base that the group moves, two links, gravity aslant, and a potential that depends on the pose.
TEST_P(Group, MovesTheReferenceBodyInItsOwnAxes) {
  const GroupKind group = GetParam();
  const bool turns = group == GroupKind::SE3 || group == GroupKind::SO3 || group == GroupKind::SE2;
  const bool moves = group != GroupKind::SO3 && group != GroupKind::fixed;
  std::string potential = "k*cos(a)*cos(b)";
  if (turns) potential += " + k*R_XY*R_YX + 2*k*R_XX*cos(a) - k*R_YY*R_XY";
  if (group == GroupKind::SE3 || group == GroupKind::SO3) potential += " + 3*k*R_ZX*R_YZ*R_ZZ";
  if (moves) potential += " + c*p_X*p_X/2 + c*p_X*d*cos(b)";
  if (moves && group != GroupKind::R1) potential += " + c*p_X*p_Y + c*p_Y*p_Y";
  if (group == GroupKind::SE3 || group == GroupKind::R3) potential += " - c*p_Z*p_Y";
  if (turns && moves) potential += " + c*d*R_XX*p_Y";
  Witness w;
  w.description =
      header(std::string(name(group)), fmt::format("gravity = [0.9, -2.1, -9.4]\npotential = \"{}\"\n"
                                                   "[parameters]\nk = {{ value = 3.5, unit = \"N m\" }}\n"
                                                   "c = {{ value = 12.5, unit = \"N/m\" }}\n"
                                                   "d = {{ value = 0.75, unit = \"m\" }}",
                                                   potential)) +
      body("base", "", cloud(0)) +
      body("upper", "base", cloud(1),
           "pose = { translation = [0.3, 0.1, -0.2], rotation = { rpy = [0.2, -0.5, 1.1] } }\n"
           "joint = { kind = \"revolute\", axis = [0, 0, 1], coordinate = \"a\" }") +
      body("lower", "upper", cloud(2),
           "pose = { translation = [0.4, 0, 0.1] }\njoint = { kind = \"revolute\", axis = [0, 1, 0], "
           "coordinate = \"b\" }");
  w.gravity = {0.9L, -2.1L, -9.4L};
  w.masses = [](const Pose& g, const std::vector<Jet>& r) {
    const Pose upper = g * moved({0.3L, 0.1L, -0.2L}) * turned({0, 0, 1}, 1.1L) * turned({0, 1, 0}, -0.5L) *
                       turned({1, 0, 0}, 0.2L) * turned({0, 0, 1}, r[0]);
    const Pose lower = upper * moved({0.4L, 0, 0.1L}) * turned({0, 1, 0}, r[1]);
    std::vector<MassPoint> points;
    add(points, g, cloud(0)), add(points, upper, cloud(1)), add(points, lower, cloud(2));
    return points;
  };
  w.potential = [=](const Pose& g, const std::vector<Jet>& r) {
    const Jet k = 3.5L, c = 12.5L, d = 0.75L;
    Jet U = k * cos(r[0]) * cos(r[1]);
    if (turns)
      U += k * g.R[0][1] * g.R[1][0] + Jet(2) * k * g.R[0][0] * cos(r[0]) - k * g.R[1][1] * g.R[0][1];
    if (group == GroupKind::SE3 || group == GroupKind::SO3)
      U += Jet(3) * k * g.R[2][0] * g.R[1][2] * g.R[2][2];
    if (moves) U += c * g.p[0] * g.p[0] * Jet(0.5L) + c * g.p[0] * d * cos(r[1]);
    if (moves && group != GroupKind::R1) U += c * g.p[0] * g.p[1] + c * g.p[1] * g.p[1];
    if (group == GroupKind::SE3 || group == GroupKind::R3) U += -(c * g.p[2] * g.p[1]);
    if (turns && moves) U += c * d * g.R[0][0] * g.p[1];
    return U;
  };
  expect_mechanics_of(w);
}
INSTANTIATE_TEST_SUITE_P(Kinds, Group,
                         testing::Values(GroupKind::SE3, GroupKind::SE2, GroupKind::SO3, GroupKind::R1,
                                         GroupKind::R2, GroupKind::R3, GroupKind::fixed),
                         [](const auto& info) { return std::string(name(info.param)); });

// ---- couplings
// ----------------------------------------------------------------------------------------------------

/// A chain a (turn about z), x (slide along y), then a joint whose displacement is c(a, x), with a spring, a
/// damper and friction on the coupled joint itself.
void expect_coupling(const std::string& group, const std::string& kind, const std::string& expression,
                     const std::function<Jet(const Jet& a, const Jet& x)>& c) {
  SCOPED_TRACE(kind + " " + expression);
  const std::string friction = kind == "prismatic" ? "force" : "torque";
  Witness w;
  w.description =
      header(group, "gravity = [0.4, -9.2, 2.2]\n[parameters]\nl = { value = 0.8, unit = \"m\" }") +
      body("base", "", cloud(0)) +
      body("turning", "base", cloud(1),
           "joint = { kind = \"revolute\", axis = [0, 0, 1], coordinate = \"a\" }") +
      body("sliding", "turning", cloud(2),
           "pose = { translation = [0.1, 0, 0.2] }\njoint = { kind = \"prismatic\", axis = [0, 1, 0], "
           "coordinate = \"x\", range = [-1, 1] }") +
      body(
          "coupled", "sliding", cloud(1),
          fmt::format("pose = {{ translation = [0, 0.2, 0.1], rotation = {{ axis = \"y\", angle = 0.6 }} }}\n"
                      "joint = {{ kind = \"{}\", axis = [0.8, 0, -0.6], coordinate = \"q\"{}, stiffness = "
                      "4.5, rest = 0.3, "
                      "damping = 0.7, friction = {{ {} = 0.9, velocity = 0.4 }} }}",
                      kind, kind == "helical" ? ", pitch = -0.11" : "", friction)) +
      fmt::format("[[coupling]]\ncoordinate = \"q\"\nequals = \"{}\"\n", expression);
  w.gravity = {0.4L, -9.2L, 2.2L};
  w.masses = [=](const Pose& g, const std::vector<Jet>& r) {
    const Jet q = c(r[0], r[1]);
    const Pose turning = g * turned({0, 0, 1}, r[0]);
    const Pose sliding = turning * moved({0.1L, 0, 0.2L}) * moved({0, r[1], 0});
    Pose motion;
    if (kind != "prismatic") motion = turned({0.8L, 0, -0.6L}, q);
    const Jet along = kind == "prismatic" ? q : kind == "helical" ? Jet(-0.11L) * q : Jet(0);
    motion.p = Vector(along * 0.8L, 0, along * -0.6L);
    const Pose coupled = sliding * moved({0, 0.2L, 0.1L}) * turned({0, 1, 0}, 0.6L) * motion;
    std::vector<MassPoint> points;
    add(points, g, cloud(0)), add(points, turning, cloud(1)), add(points, sliding, cloud(2)),
        add(points, coupled, cloud(1));
    return points;
  };
  w.potential = [=](const Pose&, const std::vector<Jet>& r) {
    const Jet stretch = c(r[0], r[1]) - Jet(0.3L);
    return Jet(4.5L / 2) * stretch * stretch;
  };
  const auto rate_and_gradient = [c](const State<Real>& s) {
    const Real c_a = c(Jet(s.r[0], 1, 0), Jet(s.r[1])).d;
    const Real c_x = c(Jet(s.r[0]), Jet(s.r[1], 1, 0)).d;
    return std::array<Real, 3>{c_a * s.r_dot[0] + c_x * s.r_dot[1], c_a, c_x};
  };
  w.forces = [=](const Sample& sample) {
    const auto [rate, c_a, c_x] = rate_and_gradient(sample.state);
    const Real force = -0.7L * rate - 0.9L * std::tanh(rate / 0.4L);
    std::vector<Real> Q(group == "SE3" ? 6 : group == "SE2" ? 3 : 0, 0);
    Q.push_back(force * c_a), Q.push_back(force * c_x);
    return Q;
  };
  w.dissipated_power = [=](const Sample& sample) {
    const Real rate = rate_and_gradient(sample.state)[0];
    return (0.7L * rate + 0.9L * std::tanh(rate / 0.4L)) * rate;
  };
  expect_mechanics_of(w);
}

TEST(Coupling, ToAnEqualAndOppositeAngle) {
  for (const char* kind : {"revolute", "helical"})
    expect_coupling("SE3", kind, "-a", [](const Jet& a, const Jet&) { return -a; });
}

TEST(Coupling, ByAGear) {
  expect_coupling("SE2", "revolute", "7/3*a", [](const Jet& a, const Jet&) { return Jet(7 / 3.0L) * a; });
}

TEST(Coupling, ByACam) {
  expect_coupling("SE3", "prismatic", "l*(sin(a)/5 + cos(2*a)/9)", [](const Jet& a, const Jet&) {
    return Jet(0.8L) * (sin(a) * Jet(0.2L) + cos(Jet(2) * a) * Jet(1 / 9.0L));
  });
}

TEST(Coupling, ToTwoCoordinates) {
  for (const char* group : {"SE3", "fixed"}) {
    for (const char* kind : {"revolute", "helical"}) {
      expect_coupling(group, kind, "a*x/l - (x/l)^2 + exp(x/l)/3", [](const Jet& a, const Jet& x) {
        const Jet y = x * Jet(1 / 0.8L);
        return a * y - y * y + exp(y) * Jet(1 / 3.0L);
      });
    }
  }
}

TEST(Coupling, ToAConstantLocksTheJoint) {
  for (const char* kind : {"revolute", "prismatic", "helical"})
    expect_coupling("SE3", kind, std::string(kind) == "prismatic" ? "l/4" : "0.2",
                    [](const Jet&, const Jet&) { return Jet(0.2L); });
}

}  // namespace
}  // namespace anholon::joint_test
