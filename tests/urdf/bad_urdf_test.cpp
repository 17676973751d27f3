// SPDX-License-Identifier: GPL-2.0-or-later
#include <gtest/gtest.h>

#include "describe/read_robot.hpp"

namespace anholon::bad_urdf_test {
namespace {

/// What the reader says of a text; empty where it reads it.
std::string fault(const std::string& text) {
  try {
    read_robot_text(text, "bad.urdf");
    return "";
  } catch (const ModelError& error) {
    return error.what();
  }
}

/// A robot of two links and one joint with more lines behind them, from line 4.
std::string pair(const std::string& joint, const std::string& more = "") {
  return "<robot name='r'>\n<link name='a'/>\n<link name='b'/>\n" + joint + "\n" + more + "</robot>\n";
}
std::string hinge(const std::string& inside, const std::string& attributes = "name='j' type='revolute'") {
  return "<joint " + attributes + "><parent link='a'/><child link='b'/>" + inside + "</joint>";
}
std::string inertial(const std::string& inside) {
  return "<robot name='r'>\n<link name='a'>\n<inertial>" + inside + "</inertial>\n</link>\n</robot>\n";
}

struct Bad {
  const char* what;
  std::string text;
  std::string message;
};

class BadUrdf : public ::testing::TestWithParam<Bad> {};

TEST_P(BadUrdf, HasOneClearError) { EXPECT_EQ(fault(GetParam().text), GetParam().message); }

const std::string unit_inertia = "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>";

INSTANTIATE_TEST_SUITE_P(
    All, BadUrdf,
    ::testing::Values(
        Bad{"Empty", "",
            "bad.urdf:1:1: error: the file has no element; mend the XML there or in the lines above"},
        Bad{"NotClosed", "<robot name='r'>\n<link name='a'>\n</robot>\n",
            "bad.urdf:2:1: error: an element is closed by the tag of another one; mend the XML there or in "
            "the lines above"},
        Bad{"OtherRoot", "<machine/>\n",
            "bad.urdf:1:1: error: the outermost element is <machine>; a robot file is one <robot> (URDF), "
            "<sdf> "
            "(SDFormat) or <mujoco> (MJCF)"},
        Bad{"NoName", "<robot>\n<link name='a'/>\n</robot>\n",
            "bad.urdf:1:1: error: the robot has no 'name'; write name=\"...\""},
        Bad{"NoLink", "<robot name='r'/>\n",
            "bad.urdf:1:1: error: the robot has no link; write at least one <link>"},
        Bad{"UnknownElement", pair(hinge("<orign xyz='0 0 1'/>")),
            "bad.urdf:4:68: error: joint 'j' has an unknown element <orign>; did you mean 'origin'?"},
        Bad{"UnknownAttribute", pair(hinge("<origin xzy='0 0 1'/>")),
            "bad.urdf:4:76: error: the origin of joint 'j' has an unknown attribute 'xzy'; did you mean "
            "'xyz'?"},
        Bad{"AttributeTwice", pair(hinge("<origin xyz='0 0 1' xyz='0 0 2'/>")),
            "bad.urdf:4:1: error: an attribute is not of the form name=\"value\", or stands there twice; "
            "mend the XML there or in the lines above"},
        Bad{"TwoAxes", pair(hinge("<axis xyz='1 0 0'/><axis xyz='0 1 0'/>")),
            "bad.urdf:4:87: error: joint 'j' has a second <axis>; remove one of them"},
        Bad{"UnknownType", pair(hinge("", "name='j' type='revolut'")),
            "bad.urdf:4:17: error: joint 'j' has the type 'revolut'; did you mean 'revolute'?"},
        Bad{"ZeroAxis", pair(hinge("<axis xyz='0 0 0'/>")),
            "bad.urdf:4:74: error: the axis of joint 'j' is zero; write its direction, for example \"0 0 "
            "1\""},
        Bad{"NotANumber", pair(hinge("<origin xyz='0 nan 0'/>")),
            "bad.urdf:4:76: error: xyz of the origin of joint 'j' is 'nan', not a finite decimal number; "
            "write a number like -0.25 or 1.5e-3"},
        Bad{"Infinite", inertial("<mass value='inf'/>" + unit_inertia),
            "bad.urdf:3:17: error: value of the mass of link 'a' is 'inf', not a finite decimal number; "
            "write a number like -0.25 or 1.5e-3"},
        Bad{"Huge", inertial("<mass value='1e999'/>" + unit_inertia),
            "bad.urdf:3:17: error: value of the mass of link 'a' is 1e999; no number may exceed 1e30"},
        Bad{"TwoNumbers", pair(hinge("<axis xyz='0 1'/>")),
            "bad.urdf:4:74: error: xyz of the axis of joint 'j' has 2 numbers; write three"},
        Bad{"NegativeMass", inertial("<mass value='-1'/>" + unit_inertia),
            "bad.urdf:3:17: error: the mass of link 'a' is -1; it must not be negative"},
        Bad{"Indefinite",
            inertial("<mass value='1'/><inertia ixx='1' ixy='2' ixz='0' iyy='1' iyz='0' izz='1'/>"),
            "bad.urdf:3:28: error: the inertia of link 'a' is not positive semidefinite; check the signs and "
            "the order ixx ixy ixz iyy iyz izz"},
        Bad{"NoMass", inertial(unit_inertia),
            "bad.urdf:3:1: error: the inertial of link 'a' has no <mass>; write <mass value=\"...\"/>"},
        Bad{"NoEntry", inertial("<mass value='1'/><inertia ixx='1' ixy='0' iyy='1' iyz='0' izz='1'/>"),
            "bad.urdf:3:28: error: the inertia of link 'a' has no 'ixz'; write ixz=\"...\""},
        Bad{"SecondLink", pair(hinge(""), "<link name='b'/>\n"),
            "bad.urdf:5:1: error: there is a second link 'b'; the first stands in line 3; rename one"},
        Bad{"SecondJoint",
            pair(
                hinge(""),
                "<link name='c'/><joint name='j' type='fixed'><parent link='a'/><child link='c'/></joint>\n"),
            "bad.urdf:5:17: error: there is a second joint 'j'; the first stands in line 4; rename one"},
        Bad{"MissingLink", pair("<joint name='j' type='fixed'><parent link='a'/><child link='bb'/></joint>"),
            "bad.urdf:4:55: error: joint 'j' names a link 'bb' that does not exist; did you mean 'b'?"},
        Bad{"NoChild", pair("<joint name='j' type='fixed'><parent link='a'/></joint>"),
            "bad.urdf:4:1: error: joint 'j' has no <child>; write <child link=\"...\"/>"},
        Bad{"Itself", pair("<joint name='j' type='fixed'><parent link='a'/><child link='a'/></joint>"),
            "bad.urdf:4:55: error: joint 'j' joins link 'a' to itself; name two links"},
        Bad{"TwoParents",
            pair(
                hinge(""),
                "<link name='c'/><joint name='k' type='fixed'><parent link='c'/><child link='b'/></joint>\n"),
            "bad.urdf:5:71: error: link 'b' is the child of a second joint 'k'; it is that of 'j' already; "
            "loops need a constraint, not a joint"},
        Bad{"Cycle",
            pair(hinge(""), "<joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint>\n"),
            "bad.urdf: error: every link is the child of some joint: the joints form a cycle; let one link "
            "be the root"},
        Bad{"CycleApart",
            pair(hinge(""),
                 "<link name='c'/><link name='d'/><joint name='k' type='fixed'><parent link='c'/><child "
                 "link='d'/></joint>\n"
                 "<joint name='l' type='fixed'><parent link='d'/><child link='c'/></joint>\n"),
            "bad.urdf:5:1: error: link 'c' hangs on a cycle of joints; join it to the tree of 'a'"},
        Bad{"TwoRoots", pair(""),
            "bad.urdf:3:1: error: there are 2 root links: a and b; join them by joints; one link is the "
            "root"},
        Bad{"NoRange", pair(hinge("", "name='j' type='prismatic'")),
            "bad.urdf:4:1: error: joint 'j' is prismatic and has no <limit>; write its working range, <limit "
            "lower=\"...\" "
            "upper=\"...\" effort=\"0\" velocity=\"0\"/>"},
        Bad{"RangeUpsideDown", pair(hinge("<limit lower='1' upper='-1'/>")),
            "bad.urdf:4:75: error: the limit of joint 'j' has lower 1 above upper -1; exchange them"},
        Bad{"NegativeDamping", pair(hinge("<dynamics damping='-0.1'/>")),
            "bad.urdf:4:78: error: damping of the dynamics of joint 'j' is -0.1; it must not be negative"},
        Bad{"MimicsNobody", pair(hinge("<mimic joint='k'/>")),
            "bad.urdf:4:68: error: joint 'j' mimics a joint 'k' that does not exist; name another joint"},
        Bad{"MimicsItself", pair(hinge("<mimic joint='j'/>")),
            "bad.urdf:4:68: error: joint 'j' mimics itself in the end; let one joint of the circle be free"},
        Bad{"Text", pair(hinge("revolves")),
            "bad.urdf:4:1: error: joint 'j' has text in it; remove the text; data stands in attributes or in "
            "elements "
            "of their own"}),
    [](const ::testing::TestParamInfo<Bad>& info) { return info.param.what; });

TEST(BadUrdf, AllFaultsOfElementsAreReportedAtOnce) {
  const std::string text = fault(pair(hinge("<axis xyz='0 0 0'/><limit lower='x'/>")));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
}

}  // namespace
}  // namespace anholon::bad_urdf_test
