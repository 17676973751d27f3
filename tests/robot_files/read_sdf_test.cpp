// SPDX-License-Identifier: GPL-2.0-or-later

// What an SDFormat file means: frames, axes, springs, bases.

#include <gtest/gtest.h>

#include <algorithm>

#include "describe/read_robot.hpp"
#include "tape/interpret.hpp"

namespace anholon::read_sdf_test {
namespace {

bool notes_contain(const Model& model, const std::string& text) {
  return std::ranges::any_of(model.notes,
                             [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

std::string link(const std::string& name, const std::string& inside = "") {
  return "<link name='" + name +
         "'><inertial><pose>0.1 0 0 0 0 "
         "0</pose><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.3</izz>"
         "</inertia></inertial>" +
         inside + "</link>";
}
std::string joint(const std::string& parent, const std::string& child, const std::string& inside,
                  const std::string& type = "revolute", const std::string& name = "j") {
  return "<joint name='" + name + "' type='" + type + "'><parent>" + parent + "</parent><child>" + child +
         "</child>" + inside + "</joint>";
}
Model read(const std::string& inside, const std::string& version = "1.9", const RobotOptions& options = {}) {
  return read_robot_text("<sdf version='" + version + "'><model name='m'>" + inside + "</model></sdf>",
                         "m.sdf", options);
}
Exact value(const Expr& e) { return e.constant_value().value(); }
const std::string z_axis = "<axis><xyz>0 0 1</xyz></axis>";

TEST(ReadSdf, WithoutAJointToTheWorldTheRootMoves) {
  const Model model = read("<pose>0 0 1 0 0 0</pose>" + link("a"));
  EXPECT_EQ(model.group, GroupKind::SE3);
  EXPECT_TRUE(notes_contain(model, "no joint has the parent 'world'"));
  EXPECT_TRUE(notes_contain(model, "dropped: the pose of the model"));
}

TEST(ReadSdf, TheModelsPoseCountsForAJointToTheWorld) {
  const Model model = read("<pose degrees='1'>1 2 3 0 0 90</pose>" + link("a", "<pose>1 0 0 0 0 0</pose>") +
                           joint("world", "a", "", "fixed"));
  EXPECT_EQ(model.group, GroupKind::fixed);
  ASSERT_EQ(model.bodies.size(), 2U);
  EXPECT_EQ(model.bodies[0].name, "world");
  EXPECT_EQ(value(model.bodies[1].p[0]), Exact(1));
  EXPECT_EQ(value(model.bodies[1].p[1]), Exact(3));
  EXPECT_EQ(value(model.bodies[1].R[3]), Exact(1));
  EXPECT_TRUE(model.notes.empty()) << model.notes.front();
}

TEST(ReadSdf, AJointOffItsLinkGetsAFrame) {
  const Model model = read(link("a") + link("b", "<pose>1 0 0 0 0 0</pose>") +
                           joint("a", "b", "<pose>-0.25 0 0 0 0 0</pose>" + z_axis));
  ASSERT_EQ(model.bodies.size(), 3U);
  EXPECT_EQ(model.bodies[1].name, "b_at_j");
  EXPECT_EQ(value(model.bodies[1].p[0]), Exact::from_decimal("0.75"));
  EXPECT_EQ(model.bodies[2].name, "b");
  EXPECT_EQ(model.bodies[2].joint.kind, JointKind::fixed);
  EXPECT_EQ(value(model.bodies[2].p[0]), Exact::from_decimal("0.25"));
  EXPECT_TRUE(
      notes_contain(model, "added: massless frame 'b_at_j': the axis of joint 'j' misses the origin of 'b'"));
  EXPECT_FALSE(notes_contain(model, "has no inertial"));
}

TEST(ReadSdf, ASlideNeedsNoFrame) {
  const Model model =
      read(link("a") + link("b") + joint("a", "b", "<pose>5 0 0 0 0 0</pose>" + z_axis, "prismatic"));
  EXPECT_EQ(model.bodies.size(), 2U);
}

TEST(ReadSdf, AxesAreInTheFrameThatTheFileNames) {
  const std::string tilted = link("a") + link("b", "<pose degrees='true'>0 0 0 90 0 0</pose>");
  const auto axis = [&](const Model& model, std::size_t i) { return value(model.bodies[1].joint.axis[i]); };
  EXPECT_EQ(axis(read(tilted + joint("a", "b", z_axis)), 2), Exact(1));
  const std::string in_model = "<axis><xyz expressed_in='__model__'>0 0 1</xyz></axis>";
  EXPECT_EQ(axis(read(tilted + joint("a", "b", in_model)), 1), Exact(1));  // Rx(90)^T z = y
  const std::string old_tilted = link("a") + link("b", "<pose>0 0 0 1.57079632679 0 0</pose>");
  const std::string old_axis =
      "<axis><xyz>0 0 1</xyz><use_parent_model_frame>1</use_parent_model_frame></axis>";
  EXPECT_EQ(axis(read(old_tilted + joint("a", "b", old_axis), "1.6"), 1), Exact(1));
}

TEST(ReadSdf, SpringsAreAPotential) {
  const Model model = read(link("a") + link("b") +
                           joint("a", "b",
                                 "<axis><xyz>0 0 1</xyz><dynamics><spring_stiffness>50</spring_stiffness>"
                                 "<spring_reference>0.5</spring_reference></dynamics></axis>"));
  Tape& tape = *model.tape;
  std::vector<Exact> inputs(tape.inputs().size(), Exact(0));
  inputs[tape.node(model.symbols.r[0]).a] = 2;
  const auto at_two = interpret<Exact>(tape, std::vector{model.potential.id(tape)}, inputs);
  EXPECT_EQ(at_two[0], Exact::from_decimal("56.25"));  // 50/2 (2 - 0.5)^2
}

TEST(ReadSdf, MimicIsACoupling) {
  const Model model =
      read(link("a") + link("b") + link("c") + joint("a", "b", z_axis) +
               joint("b", "c",
                     "<axis><xyz>0 0 1</xyz><mimic joint='j'><multiplier>2</multiplier><offset>0.5</offset>"
                     "<reference>0.25</reference></mimic></axis>",
                     "revolute", "k"),
           "1.11");
  ASSERT_EQ(model.coordinates.size(), 1U);
  Tape& tape = *model.tape;
  std::vector<Exact> inputs(tape.inputs().size(), Exact(0));
  inputs[tape.node(model.symbols.r[0]).a] = 1;
  const NodeId displacement = model.bodies[2].joint.displacement.id(tape);
  EXPECT_EQ(interpret<Exact>(tape, std::vector{displacement}, inputs)[0], Exact(2));  // 2 (1 - 0.25) + 0.5
}

TEST(ReadSdf, BoundsWithoutEndAreNone) {
  const Model model = read(
      link("a") + link("b") +
      joint("a", "b", "<axis><xyz>0 0 1</xyz><limit><lower>-1e+16</lower><upper>inf</upper></limit></axis>",
            "prismatic"));
  EXPECT_EQ(model.coordinates[0].upper, Exact(1));
  EXPECT_TRUE(notes_contain(model, "joint 'j' has no limits along j: range [-1, 1] m"));
}

TEST(ReadSdf, ALinkWithoutInertialHasTheFormatsDefault) {
  const Model model = read("<link name='a'><visual name='v'/><visual name='w'/></link>");
  EXPECT_EQ(value(model.bodies[0].mass), Exact(1));
  EXPECT_EQ(value(model.bodies[0].inertia[2]), Exact(1));
  EXPECT_TRUE(notes_contain(model, "assumed: link 'a' has no inertial: 1 kg and 1 kg m^2"));
  EXPECT_TRUE(notes_contain(model, "dropped: 2 <visual>"));
}

TEST(ReadSdf, RoundedQuaternionsOfQuarterTurnsAreExact) {
  const std::string pose =
      "<pose rotation_format='quat_xyzw'>0 0 0  0.5 0.49999999999 0.5 0.50000000001</pose>";
  const Model model = read(link("a") + link("b", pose) + joint("a", "b", z_axis));
  const std::array<int, 9> expected = {0, 0, 1, 1, 0, 0, 0, 1, 0};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(value(model.bodies[1].R[i]), Exact(expected[i])) << i;
  EXPECT_TRUE(notes_contain(model, "snapped: the orientation of link 'b' taken as exact"));
  RobotOptions as_written;
  as_written.as_written = true;
  const Model other = read(link("a") + link("b", pose) + joint("a", "b", z_axis), "1.9", as_written);
  EXPECT_FALSE(value(other.bodies[1].R[0]).is_zero());
  EXPECT_TRUE(other.bodies[1].R[0].constant_value()->is_rational());
}

}  // namespace
}  // namespace anholon::read_sdf_test
