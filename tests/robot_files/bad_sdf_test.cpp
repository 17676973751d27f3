// SPDX-License-Identifier: GPL-2.0-or-later
#include <gtest/gtest.h>

#include "describe/read_robot.hpp"

namespace anholon::bad_sdf_test {
namespace {

/// What the reader says of a text; empty where it reads it.
std::string fault(const std::string& text) {
  try {
    read_robot_text(text, "bad.sdf");
    return "";
  } catch (const ModelError& error) {
    return error.what();
  }
}

/// A model with these lines from line 3.
std::string model(const std::string& inside, const std::string& version = "1.9") {
  return "<sdf version='" + version + "'>\n<model name='m'>\n" + inside + "</model>\n</sdf>\n";
}
/// Links a and b in lines 3 and 4, a joint in line 5.
std::string pair(const std::string& joint, const std::string& version = "1.9") {
  const std::string body =
      "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";
  return model("<link name='a'>" + body + "</link>\n<link name='b'>" + body + "</link>\n" + joint + "\n",
               version);
}
std::string hinge(const std::string& inside, const std::string& type = "revolute",
                  const std::string& child = "b") {
  return "<joint name='j' type='" + type + "'><parent>a</parent><child>" + child + "</child>" + inside +
         "</joint>";
}
std::string inertial(const std::string& inside) {
  return model("<link name='a'>\n<inertial>" + inside + "</inertial>\n</link>\n");
}

struct Bad {
  const char* what;
  std::string text;
  std::string message;
};

class BadSdf : public ::testing::TestWithParam<Bad> {};

TEST_P(BadSdf, HasOneClearError) { EXPECT_EQ(fault(GetParam().text), GetParam().message); }

const std::string axis = "<axis><xyz>0 0 1</xyz></axis>";

INSTANTIATE_TEST_SUITE_P(
    All, BadSdf,
    ::testing::Values(
        Bad{"NoVersion", "<sdf><model name='m'><link name='a'/></model></sdf>",
            "bad.sdf:1:1: error: the file has no 'version'; write version=\"...\""},
        Bad{"OldVersion", "<sdf version='1.4'><model name='m'><link name='a'/></model></sdf>",
            "bad.sdf:1:6: error: the file is of version 1.4; versions 1.5 to 1.12 are read; older files can "
            "be converted by 'gz sdf -p'"},
        Bad{"AWorld", "<sdf version='1.9'>\n<world name='w'/>\n</sdf>",
            "bad.sdf:2:1: error: the file has an element <world>, which is not supported; write the robot "
            "alone, as one <model> right in <sdf>"},
        Bad{"TwoModels", "<sdf version='1.9'>\n<model name='m'/>\n<model name='n'/>\n</sdf>",
            "bad.sdf:3:1: error: the file has a second <model>; remove one of them"},
        Bad{"NoLink", model(""), "bad.sdf:2:1: error: the model has no link; write at least one <link>"},
        Bad{"Include", model("<include><uri>model://x</uri></include>\n"),
            "bad.sdf:3:1: error: the model has an element <include>, which is not supported; write its links "
            "and joints right into this model"},
        Bad{"ModelInModel", model("<link name='a'/>\n<model name='n'/>\n"),
            "bad.sdf:4:1: error: the model has an element <model>, which is not supported; write its links "
            "and joints right into this model"},
        Bad{"Static", model("<link name='a'/>\n<static>true</static>\n"),
            "bad.sdf:4:1: error: the model is static; remove it; what is fixed to the world is joined to it"},
        Bad{"UnknownElement", model("<link name='a'>\n<inertal/></link>\n"),
            "bad.sdf:4:1: error: link 'a' has an unknown element <inertal>; did you mean 'inertial'?"},
        Bad{"UnknownAttribute", model("<link name='a'><pose relativ_to='b'/></link>\n"),
            "bad.sdf:3:22: error: the pose of link 'a' has an unknown attribute 'relativ_to'; did you mean "
            "'relative_to'?"},
        Bad{"ThreeNumbers", model("<link name='a'><pose>0 0 1</pose></link>\n"),
            "bad.sdf:3:16: error: the pose of link 'a' has 3 numbers; write six"},
        Bad{"NotANumber", model("<link name='a'><pose>0 0 nan 0 0 0</pose></link>\n"),
            "bad.sdf:3:16: error: the pose of link 'a' is 'nan', not a finite decimal number; write a number "
            "like -0.25 or 1.5e-3"},
        Bad{"ZeroQuaternion",
            model("<link name='a'><pose rotation_format='quat_xyzw'>0 0 1 0 0 0 0</pose></link>\n"),
            "bad.sdf:3:16: error: the quaternion of the pose of link 'a' is zero; write 0 0 0 1 for no turn"},
        Bad{"NoSuchFrame", model("<link name='a'><pose relative_to='bb'>0 0 1 0 0 0</pose></link>\n"),
            "bad.sdf:3:22: error: 'a' is posed in a frame 'bb' that does not exist; there are __model__, a "
            "and world"},
        Bad{"FramesInACircle",
            model("<link name='a'><pose relative_to='b'/></link>\n<link name='b'><pose "
                  "relative_to='a'/></link>\n"),
            "bad.sdf:3:22: error: 'a' is posed in itself in the end; let one frame of the circle be posed in "
            "the model"},
        Bad{"NameTwice", model("<link name='a'/>\n<frame name='a'/>\n"),
            "bad.sdf:4:1: error: there is a second frame 'a'; links, joints and frames share their names "
            "with the format's own; rename one"},
        Bad{"FramesOfOldFiles", model("<link name='a'/>\n<frame name='f'/>\n", "1.6"),
            "bad.sdf:4:1: error: the model has an unknown element <frame>; known are pose, static, link, "
            "joint, plugin, self_collide, allow_auto_disable, enable_wind and gripper"},
        Bad{"NoMass", inertial("<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>"),
            "bad.sdf:4:1: error: the inertial of link 'a' has no <mass>; write <mass>...</mass>, in kg"},
        Bad{"NegativeMass",
            inertial("<mass>-2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>"),
            "bad.sdf:4:11: error: the mass of link 'a' is -2; it must not be negative"},
        Bad{"NoMoment", inertial("<mass>2</mass><inertia><ixx>1</ixx><izz>1</izz></inertia>"),
            "bad.sdf:4:25: error: the inertia of link 'a' has no <iyy>; write <ixx>, <iyy> and <izz>; the "
            "others are zero where they are missing"},
        Bad{"Indefinite",
            inertial("<mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz><iyz>3</iyz></inertia>"),
            "bad.sdf:4:25: error: the inertia of link 'a' is not positive semidefinite; check the signs and "
            "the order ixx ixy ixz iyy iyz izz"},
        Bad{"NoGravity", model("<link name='a'>\n<gravity>0</gravity></link>\n"),
            "bad.sdf:4:1: error: gravity does not act on link 'a'; let it act on all links"},
        Bad{"Ball", pair(hinge("", "ball")),
            "bad.sdf:5:17: error: joint 'j' has the type 'ball', which is not supported; write three "
            "revolute joints with massless links between them"},
        Bad{"UnknownType", pair(hinge(axis, "prismatc")),
            "bad.sdf:5:17: error: joint 'j' has the type 'prismatc'; did you mean 'prismatic'?"},
        Bad{"NoAxis", pair(hinge("")),
            "bad.sdf:5:1: error: joint 'j' has no <axis>; write <axis><xyz>...</xyz></axis>"},
        Bad{"ZeroAxis", pair(hinge("<axis><xyz>0 0 0</xyz></axis>")),
            "bad.sdf:5:73: error: the axis of joint 'j' is zero; write its direction, for example 0 0 1"},
        Bad{"TwoAxes", pair(hinge(axis + "<axis2><xyz>0 1 0</xyz></axis2>")),
            "bad.sdf:5:96: error: joint 'j' has an element <axis2>, which is not supported; write two joints "
            "with a link between them"},
        Bad{"AxisInNoFrame", pair(hinge("<axis><xyz expressed_in='c'>0 0 1</xyz></axis>")),
            "bad.sdf:5:1: error: the axis of joint 'j' is expressed in a frame 'c' that does not exist; "
            "there are __model__, a, b, j and world"},
        Bad{"MissingLink", pair(hinge(axis, "revolute", "c")),
            "bad.sdf:5:51: error: joint 'j' names a link 'c' that does not exist; write a <link> of this "
            "name"},
        Bad{"WorldAsChild", pair(hinge(axis, "revolute", "world")),
            "bad.sdf:5:51: error: the world is the child of joint 'j'; let it be the parent"},
        Bad{"OneBound", pair(hinge("<axis><xyz>0 0 1</xyz><limit><lower>0</lower></limit></axis>")),
            "bad.sdf:5:89: error: the limit of joint 'j' has one bound alone; write <lower> and <upper>"},
        Bad{"BoundsUpsideDown",
            pair(hinge("<axis><xyz>0 0 1</xyz><limit><lower>1</lower><upper>0</upper></limit></axis>")),
            "bad.sdf:5:89: error: the limit of joint 'j' has lower 1 above upper 0; exchange them"},
        Bad{"NegativeSpring",
            pair(hinge(
                "<axis><xyz>0 0 1</xyz><dynamics><spring_stiffness>-1</spring_stiffness></dynamics></axis>")),
            "bad.sdf:5:99: error: spring_stiffness of the dynamics of joint 'j' is -1; it must not be "
            "negative"},
        Bad{"TwoRoots", pair(""),
            "bad.sdf:4:1: error: there are 2 root links: a and b; join them by joints; one link is the root"},
        Bad{"ALoop",
            pair(hinge(axis) +
                 "\n<joint name='k' type='fixed'><parent>world</parent><child>b</child></joint>"),
            "bad.sdf:6:52: error: link 'b' is the child of a second joint 'k'; it is that of 'j' already; "
            "loops need a constraint, not a joint"}),
    [](const ::testing::TestParamInfo<Bad>& info) { return info.param.what; });

TEST(BadSdf, FloatingContradictsAJointToTheWorld) {
  RobotOptions options;
  options.floating = true;
  try {
    read_robot_text(model("<link name='a'/>\n<joint name='j' "
                          "type='fixed'><parent>world</parent><child>a</child></joint>\n"),
                    "bad.sdf", options);
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_STREQ(error.what(),
                 "bad.sdf: error: --floating is asked for, and the file joins the robot to the world itself; "
                 "leave out --floating, or give the file a free root");
  }
}

}  // namespace
}  // namespace anholon::bad_sdf_test
