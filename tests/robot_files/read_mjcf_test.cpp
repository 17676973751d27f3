// SPDX-License-Identifier: GPL-2.0-or-later

// What an MJCF file means: classes, several joints of a body, references, couplings.

#include <gtest/gtest.h>

#include <algorithm>

#include "describe/read_robot.hpp"
#include "tape/interpret.hpp"

namespace anholon::read_mjcf_test {
namespace {

bool notes_contain(const Model& model, const std::string& text) {
  return std::ranges::any_of(model.notes,
                             [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

const std::string inertial = "<inertial pos='0.1 0 0' mass='2' diaginertia='0.1 0.2 0.25'/>";
Model read(const std::string& bodies, const std::string& head = "", const std::string& tail = "") {
  return read_robot_text(
      "<mujoco model='m'>" + head + "<worldbody>" + bodies + "</worldbody>" + tail + "</mujoco>", "m.xml");
}
std::string body(const std::string& inside, const std::string& attributes = "name='a'") {
  return "<body " + attributes + ">" + inertial + inside + "</body>";
}
Exact value(const Expr& e) { return e.constant_value().value(); }
Exact displacement(const Model& model, std::size_t k, const Exact& r) {
  const Tape& tape = *model.tape;
  std::vector<Exact> inputs(tape.inputs().size(), Exact(0));
  inputs[tape.node(model.symbols.r[0]).a] = r;
  return interpret<Exact>(tape, std::vector{model.bodies[k].joint.displacement.id(*model.tape)}, inputs)[0];
}

TEST(ReadMjcf, ABodyWithoutJointIsFixedToTheWorld) {
  const Model model = read(body(""));
  EXPECT_EQ(model.group, GroupKind::fixed);
  ASSERT_EQ(model.bodies.size(), 2U);
  EXPECT_EQ(model.bodies[1].joint.kind, JointKind::fixed);
}

TEST(ReadMjcf, AFreeJointMakesTheGroup) {
  for (const std::string free : {"<freejoint/>", "<joint type='free' name='root'/>"}) {
    const Model model = read(body(free));
    EXPECT_EQ(model.group, GroupKind::SE3);
    EXPECT_EQ(model.bodies.size(), 1U);
  }
}

TEST(ReadMjcf, SeveralJointsFollowEachOther) {
  const Model model =
      read(body("<joint name='x' axis='1 0 0'/><joint name='y' axis='0 1 0' pos='0 0 0.5'/>"
                "<joint name='s' type='slide' axis='0 0 2'/>",
                "name='a' pos='0 0 1'"));
  ASSERT_EQ(model.bodies.size(), 4U);
  EXPECT_EQ(model.bodies[1].joint.coordinate, "x");
  EXPECT_EQ(value(model.bodies[1].p[2]), Exact(1));
  EXPECT_EQ(model.bodies[2].joint.coordinate, "y");
  EXPECT_EQ(value(model.bodies[2].p[2]), Exact::from_decimal("0.5"));
  EXPECT_EQ(model.bodies[3].name, "a");
  EXPECT_EQ(model.bodies[3].joint.kind, JointKind::prismatic);
  EXPECT_EQ(value(model.bodies[3].p[2]), Exact::from_decimal("-0.5"));
  EXPECT_EQ(value(model.bodies[3].joint.axis[2]), Exact(1));
  EXPECT_TRUE(notes_contain(model, "added: massless frame 'a_at_x' between the joints of 'a'"));
}

TEST(ReadMjcf, ClassesInheritAndChildrenTakeTheirBodysClass) {
  const std::string head =
      "<default><default class='arm'><default class='tight'><joint range='-10 10'/></default>"
      "<joint axis='0 1 0' range='-90 90'/></default></default>";
  const Model model = read(
      body("<joint name='p'/>" +
               body("<joint name='q'/>" + body("<joint name='s' class='tight'/>", "name='c'"), "name='b'"),
           "name='a' childclass='arm'"),
      head);
  EXPECT_EQ(value(model.bodies[2].joint.axis[1]), Exact(1));
  EXPECT_EQ(value(model.bodies[3].joint.axis[1]), Exact(1));
  EXPECT_EQ(model.coordinates[1].upper, Exact::pi() / Exact(2));
  EXPECT_LT(abs(model.coordinates[2].upper - Exact::pi() / Exact(18)), Exact::from_decimal("1e-40"));
}

TEST(ReadMjcf, EulerAnglesFollowTheSequence) {
  const auto matrix = [&](const std::string& head) {
    std::array<Exact, 9> R;
    const Model model = read(body("", "name='a' euler='90 90 0'"), head);
    for (std::size_t i = 0; i < 9; ++i) R[i] = value(model.bodies[1].R[i]);
    return R;
  };
  EXPECT_EQ(matrix(""), (std::array<Exact, 9>{0, 0, 1, 1, 0, 0, 0, 1, 0}));  // Rx(90) Ry(90)
  EXPECT_EQ(matrix("<compiler eulerseq='XYZ'/>"),
            (std::array<Exact, 9>{0, 1, 0, 0, 0, -1, -1, 0, 0}));         // Ry Rx
  EXPECT_TRUE(read(body("", "name='a' euler='90 45 0'")).notes.empty());  // exact degrees are not snapped
}

TEST(ReadMjcf, DirectionsOfZAreLeastTurns) {
  const Model model = read(body("", "name='a' zaxis='0 2 0'") + body("", "name='b' zaxis='0 0 -1'"));
  const std::array<int, 9> to_y = {1, 0, 0, 0, 0, 1, 0, -1, 0}, down = {1, 0, 0, 0, -1, 0, 0, 0, -1};
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(value(model.bodies[1].R[i]), Exact(to_y[i])) << i;
    EXPECT_EQ(value(model.bodies[2].R[i]), Exact(down[i])) << i;
  }
}

TEST(ReadMjcf, AReferenceIsTheCoordinateInTheFilesPose) {
  const Model model = read(body("<joint name='j' ref='90'/>"));
  const std::array<int, 9> turned_back = {0, 1, 0, -1, 0, 0, 0, 0, 1};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(value(model.bodies[1].R[i]), Exact(turned_back[i])) << i;
  EXPECT_EQ(displacement(model, 1, 1), Exact(1));
  const Model slide =
      read(body("<joint name='j' type='slide' axis='0 2 0' ref='0.5'/>", "name='a' pos='0 1 0'"));
  EXPECT_EQ(value(slide.bodies[1].p[1]), Exact::from_decimal("0.5"));
}

TEST(ReadMjcf, AJointEqualityIsACoupling) {
  const std::string two =
      body("<joint name='j' type='slide'/>" + body("<joint name='k' type='slide' ref='0.25'/>", "name='b'"));
  const Model model =
      read(two, "", "<equality><joint joint1='k' joint2='j' polycoef='0.5 -2 0 0 0'/></equality>");
  ASSERT_EQ(model.coordinates.size(), 1U);
  EXPECT_EQ(displacement(model, 2, 1), Exact::from_decimal("-1.25"));  // 0.25 + 0.5 - 2
  EXPECT_TRUE(notes_contain(model, "joint 'k' follows 'j' exactly"));
  EXPECT_EQ(
      read(two, "", "<equality><joint joint1='k' joint2='j' active='false'/></equality>").coordinates.size(),
      2U);
}

TEST(ReadMjcf, GravityIsTheFiles) {
  const std::string head = "<option gravity='1 0 -1.62'/>";
  EXPECT_EQ(value(read(body(""), head).gravity[0]), Exact(1));
  RobotOptions options;
  options.gravity = Exact(3);
  const Model model = read_robot_text("<mujoco>" + head + "<worldbody>" + body("") + "</worldbody></mujoco>",
                                      "m.xml", options);
  EXPECT_EQ(value(model.gravity[0]), Exact(0));
  EXPECT_EQ(value(model.gravity[2]), Exact(-3));
}

TEST(ReadMjcf, InertiasOfGeomsAreExact) {
  const Model model = read(
      "<body name='a'><geom type='box' size='0.1 0.2 0.3' pos='0 0 1' density='1250'/>"
      "<geom type='box' size='0.1 0.2 0.3' pos='0 0 -1' mass='60'/></body>");
  const BodyDescription& a = model.bodies[1];
  EXPECT_EQ(value(a.mass), Exact(120));
  EXPECT_TRUE(a.first_moment[2].is_zero());
  EXPECT_EQ(value(a.inertia[0]), Exact::from_decimal("125.2"));  // 120 (0.13 / 3 + 1)
  EXPECT_EQ(value(a.inertia[2]), Exact(2));                      // 120 (0.05 / 3)
  EXPECT_TRUE(a.inertia[3].is_zero());
  EXPECT_TRUE(notes_contain(model, "assumed: body 'a' has no inertial: that of 2 geoms"));
}

TEST(ReadMjcf, UnnamedPartsGetNames) {
  const Model model = read("<body>" + inertial + "<joint axis='1 0 0'/><joint/></body>");
  EXPECT_EQ(model.bodies.back().name, "body_1");
  EXPECT_EQ(model.coordinates[0].name, "body_1_joint");
  EXPECT_EQ(model.coordinates[1].name, "body_1_joint_2");
  EXPECT_TRUE(notes_contain(model, "named: the body in line 1 is called body_1"));
}

TEST(ReadMjcf, WhatDynamicsDoesNotNeedIsListed) {
  const Model model = read(body("<geom type='sphere' size='1'/><site/>"), "<asset/>", "<actuator/><sensor/>");
  for (const char* what : {"<geom>", "<site>", "<asset>", "<actuator>", "<sensor>"})
    EXPECT_TRUE(notes_contain(model, std::string("dropped: 1 ") + what)) << what;
}

}  // namespace
}  // namespace anholon::read_mjcf_test
