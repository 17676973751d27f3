// SPDX-License-Identifier: GPL-2.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "describe/mechanise.hpp"
#include "describe/names.hpp"
#include "describe/read_robot.hpp"
#include "urdf/small_robots.hpp"

namespace anholon::read_urdf_test {
namespace {

using testing::joint;
using testing::link;

bool notes_contain(const Model& model, const std::string& text) {
  return std::ranges::any_of(model.notes,
                             [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

/// Two links and a joint of the given kind.
std::string two(const std::string& type, const std::string& rpy, const std::string& axis,
                const std::string& more = "") {
  return "<robot name='two'>" + link("a", "1", "0 0 0") + link("b", "2", "0.1 0.2 0.3") +
         joint("j", type, "a", "b", "1 2 3", rpy, axis, more) + "</robot>";
}

Mechanism<Exact> mechanism_of(const Model& model) {
  std::vector<Exact> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value);
  return mechanise<Exact>(describe_mechanism(model), parameters);
}

TEST(ReadUrdf, AnglesNearQuarterTurnsAreExact) {
  const Model model = read_robot_text(two("revolute", "1.57079632679 0 -3.14159265359", "0 0 1"), "two.urdf");
  const Mechanism<Exact> m = mechanism_of(model);
  const std::array<int, 9> expected = {-1, 0, 0, 0, 0, 1, 0, 1, 0};  // Rz(-pi) Rx(pi/2)
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(m.bodies[1].R.m[i], Exact(expected[i])) << i;
  EXPECT_TRUE(notes_contain(model, "roll 1.57079632679 of joint 'j' taken as pi/2"));
  EXPECT_TRUE(notes_contain(model, "yaw -3.14159265359 of joint 'j' taken as -pi"));
}

TEST(ReadUrdf, AsWrittenKeepsDigits) {
  RobotOptions options;
  options.as_written = true;
  const Model model = read_robot_text(two("revolute", "1.57079632679 0 0", "0 0 1"), "two.urdf", options);
  const Exact tilt = mechanism_of(model).bodies[1].R(1, 1);
  EXPECT_FALSE(tilt.is_zero());
  EXPECT_LT(abs(tilt), Exact::from_decimal("1e-11"));
  EXPECT_TRUE(model.notes.empty()) << model.notes.front();
}

TEST(ReadUrdf, AnglesFarFromQuarterTurnsStay) {
  const Model model = read_robot_text(two("revolute", "1.5707963 0 0", "0 0 1"), "two.urdf");
  EXPECT_FALSE(mechanism_of(model).bodies[1].R(1, 1).is_zero());
}

TEST(ReadUrdf, AxesAreMadeUnitVectors) {
  const Model model = read_robot_text(two("revolute", "0 0 0", "1e-12 0 -2"), "two.urdf");
  EXPECT_EQ(model.bodies[1].joint.axis[2].constant_value(), Exact(-1));
  EXPECT_TRUE(model.bodies[1].joint.axis[0].is_zero());
  EXPECT_TRUE(notes_contain(model, "axis of joint 'j' taken as (0, 0, -1)"));
}

TEST(ReadUrdf, InertiaIsAboutTheOrigin) {
  const Model model = read_robot_text(two("revolute", "0 0 0", "0 0 1"), "two.urdf");
  const BodyDescription& b = model.bodies[1];
  EXPECT_EQ(b.mass.constant_value(), Exact(2));
  EXPECT_EQ(b.first_moment[1].constant_value(), Exact::from_decimal("0.4"));
  EXPECT_EQ(b.inertia[0].constant_value(), Exact::from_decimal("0.271"));   // 0.011 + 2 (0.04 + 0.09)
  EXPECT_EQ(b.inertia[3].constant_value(), Exact::from_decimal("-0.039"));  // 0.001 - 2 * 0.02
  EXPECT_EQ(b.inertia[5].constant_value(), Exact::from_decimal("-0.1185"));
}

TEST(ReadUrdf, SymbolicInertiaNamesWhatIsNotZero) {
  RobotOptions options;
  options.symbolic_inertia = true;
  const Model model = read_robot_text(two("revolute", "0 0 0", "0 0 1"), "two.urdf", options);
  std::vector<std::string> names;
  for (const Parameter& p : model.parameters) names.push_back(p.name);
  EXPECT_EQ(names.size(), 17U);  // the first link's centre of mass is its origin
  EXPECT_EQ(names.front(), "a_m");
  EXPECT_EQ(names.back(), "b_Iyz");
  EXPECT_TRUE(model.bodies[0].first_moment[0].is_zero());
}

TEST(ReadUrdf, MimicIsACoupling) {
  const Model model = read_robot_text(testing::arm(), "arm.urdf");
  EXPECT_EQ(model.coordinates.size(), 6U);
  EXPECT_EQ(model.bodies.size(), 10U);
  const Mechanism<Exact> m = mechanism_of(model);
  ASSERT_EQ(m.couplings.size(), 1U);
  std::vector<Exact> r(6, Exact(0)), out(3);
  r[5] = 2;
  m.couplings[0].evaluate(r, out);
  EXPECT_EQ(out[0], Exact::from_decimal("-2.8"));
  EXPECT_EQ(out[1], Exact::from_decimal("-1.5"));
}

TEST(ReadUrdf, FloatingRootJointMakesTheGroup) {
  const Model model = read_robot_text(
      "<robot name='f'><link name='world'/>" + link("a", "1", "0 0 0") +
          "<joint name='free' type='floating'><parent link='world'/><child link='a'/></joint></robot>",
      "f.urdf");
  EXPECT_EQ(model.group, GroupKind::SE3);
  EXPECT_EQ(model.bodies.size(), 1U);
  EXPECT_TRUE(model.coordinates.empty());
}

TEST(ReadUrdf, PlanarJointIsAChain) {
  const Model model = read_robot_text(two("planar", "0 0 0", "0 0 1"), "two.urdf");
  ASSERT_EQ(model.coordinates.size(), 3U);
  EXPECT_EQ(model.coordinates[0].name, "j_x");
  EXPECT_EQ(model.coordinates[2].name, "j_angle");
  EXPECT_EQ(model.bodies.size(), 4U);
  EXPECT_EQ(model.bodies[3].name, "b");
  EXPECT_EQ(model.bodies[2].joint.axis[1].constant_value(), Exact(1));
}

TEST(ReadUrdf, NamesBecomeIdentifiers) {
  const Model model = read_robot_text(
      "<robot name='2 legs &quot;x&quot;'>" + link("a-b", "1", "0 0 0") + link("a b", "1", "0 0 0") +
          link("class", "1", "0 0 0") + joint("t", "revolute", "a-b", "a b", "0 0 0", "0 0 0", "0 0 1") +
          joint("return", "revolute", "a b", "class", "0 0 0", "0 0 0", "0 0 1") + "</robot>",
      "x.urdf");
  EXPECT_EQ(model.name, "robot_2_legs_x");
  EXPECT_EQ(model.bodies[0].name, "a_b");
  EXPECT_EQ(model.bodies[1].name, "a_b_2");
  EXPECT_EQ(model.bodies[2].name, "class_");
  EXPECT_EQ(model.coordinates[0].name, "t_2");  // t is the time
  EXPECT_EQ(model.coordinates[1].name, "return_");
  EXPECT_TRUE(notes_contain(model, "link 'a-b' is called a_b"));
}

TEST(ReadUrdf, LimitsAreTheRange) {
  const Model model = read_robot_text(two("revolute", "0 0 0", "0 0 1"), "two.urdf");
  EXPECT_EQ(model.coordinates[0].lower, Exact(-2));
  EXPECT_EQ(model.coordinates[0].upper, Exact(2));
}

TEST(ReadUrdf, VisualsAreLeftOutWithANote) {
  const Model model = read_robot_text(
      "<robot name='v'><link name='a'><visual><geometry><mesh "
      "filename='x'/></geometry></visual></link></robot>",
      "v.urdf");
  EXPECT_TRUE(notes_contain(model, "dropped: 1 <visual>"));
  EXPECT_TRUE(notes_contain(model, "link 'a' has no inertial: massless"));
}

}  // namespace
}  // namespace anholon::read_urdf_test
