// SPDX-License-Identifier: GPL-2.0-or-later
#include <gtest/gtest.h>

#include "describe/read_robot.hpp"

namespace anholon::bad_mjcf_test {
namespace {

/// What the reader says of a text; empty where it reads it.
std::string fault(const std::string& text) {
  try {
    read_robot_text(text, "bad.xml");
    return "";
  } catch (const ModelError& error) {
    return error.what();
  }
}

/// A head in line 2, bodies in line 4, a tail in line 6.
std::string file(const std::string& bodies, const std::string& head = "", const std::string& tail = "") {
  return "<mujoco>\n" + head + "\n<worldbody>\n" + bodies + "\n</worldbody>\n" + tail + "\n</mujoco>\n";
}
std::string body(const std::string& inside, const std::string& attributes = "name='a'") {
  return "<body " + attributes + "><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>" + inside + "</body>";
}
std::string inertial(const std::string& attributes) {
  return file("<body name='a'><inertial " + attributes + "/></body>");
}

struct Bad {
  const char* what;
  std::string text;
  std::string message;
};

class BadMjcf : public ::testing::TestWithParam<Bad> {};

TEST_P(BadMjcf, HasOneClearError) { EXPECT_EQ(fault(GetParam().text), GetParam().message); }

INSTANTIATE_TEST_SUITE_P(
    All, BadMjcf,
    ::testing::Values(
        Bad{"NoBody", file(""),
            "bad.xml:1:1: error: the file has no body; write at least one <body> in <worldbody>"},
        Bad{"UnknownSection", file(body(""), "<worlbody/>"),
            "bad.xml:2:1: error: the file has an unknown element <worlbody>; did you mean 'worldbody'?"},
        Bad{"Include", file(body("") + "<include file='x.xml'/>"),
            "bad.xml:4:75: error: the worldbody has an element <include>, which is not supported; write the "
            "parts into one file"},
        Bad{"GlobalCoordinates", file(body(""), "<compiler coordinate='global'/>"),
            "bad.xml:2:11: error: coordinate of the compiler is 'global', which is not supported; write "
            "poses in the frame of the parent"},
        Bad{"InertiaFromGeoms", file(body(""), "<compiler inertiafromgeom='true'/>"),
            "bad.xml:2:11: error: the compiler takes all inertias from geoms; remove it, and every "
            "<inertial> that is not meant"},
        Bad{"TotalMass", file(body(""), "<compiler settotalmass='3'/>"),
            "bad.xml:2:11: error: the compiler scales all masses; write the figures that are meant"},
        Bad{"EulerSequence", file(body(""), "<compiler eulerseq='xYz'/>"),
            "bad.xml:2:11: error: eulerseq of the compiler is 'xYz'; write three of xyz, for turned axes, or "
            "three of XYZ, for axes that stay"},
        Bad{"UnknownAngle", file(body(""), "<compiler angle='degrees'/>"),
            "bad.xml:2:11: error: angle of the compiler is 'degrees'; did you mean 'degree'?"},
        Bad{"Fluid", file(body(""), "<option viscosity='0.1'/>"),
            "bad.xml:2:9: error: viscosity of the option is 0.1, which is not supported; remove it; forces "
            "of a fluid are written as [[force]] in a side-car file"},
        Bad{"NoGravityFlag", file(body(""), "<option><flag gravity='disable'/></option>"),
            "bad.xml:2:15: error: the flag 'gravity' switches off what the bodies say; remove it, and what "
            "it switches off"},
        Bad{"ClassWithoutName", file(body(""), "<default><default/></default>"),
            "bad.xml:2:10: error: a <default> inside another has no 'class'; write class=\"...\""},
        Bad{"ClassTwice", file(body(""), "<default><default class='x'/><default class='x'/></default>"),
            "bad.xml:2:39: error: there is a second class 'x'; rename one"},
        Bad{"UnknownClass", file(body("<joint class='leg'/>"), "<default><default class='legs'/></default>"),
            "bad.xml:4:75: error: there is no class 'leg'; did you mean 'legs'?"},
        Bad{"BadDefault", file(body("<joint name='j'/>"), "<default><joint axis='0 0 0'/></default>"),
            "bad.xml:2:17: error: the axis of joint 'j' is zero; write its direction, for example \"0 0 1\""},
        Bad{"UnknownAttribute", file(body("<joint stifness='1'/>")),
            "bad.xml:4:75: error: joint 'a_joint' has an unknown attribute 'stifness'; did you mean "
            "'stiffness'?"},
        Bad{"MeshAlone", file("<body name='a'><geom type='mesh' mesh='m'/></body>"),
            "bad.xml:4:16: error: a geom of body 'a' is a mesh, and the body has no <inertial>; write "
            "<inertial pos=\"...\" mass=\"...\" fullinertia=\"...\"/>"},
        Bad{"PlaneAlone", file("<body name='a'><geom type='plane' size='1 1 1'/></body>"),
            "bad.xml:4:16: error: a geom of body 'a' is a plane, and the body has no <inertial>; write "
            "<inertial pos=\"...\" mass=\"...\" fullinertia=\"...\"/>"},
        Bad{"UnknownShape", file("<body name='a'><geom type='spher' size='1'/></body>"),
            "bad.xml:4:22: error: type of a geom of body 'a' is 'spher'; did you mean 'sphere'?"},
        Bad{"NoSize", file("<body name='a'><geom type='box'/></body>"),
            "bad.xml:4:16: error: a geom of body 'a' has no 'size'; write its radius, or half its lengths"},
        Bad{"TwoSizes", file("<body name='a'><geom type='box' size='1 2'/></body>"),
            "bad.xml:4:33: error: size of a geom of body 'a' has 2 numbers; write three"},
        Bad{"FlatBox", file("<body name='a'><geom type='box' size='1 2 0'/></body>"),
            "bad.xml:4:33: error: size of a geom of body 'a' is 1 2 0; sizes are positive"},
        Bad{"NoLength", file("<body name='a'><geom type='capsule' size='1' fromto='0 0 1 0 0 1'/></body>"),
            "bad.xml:4:46: error: fromto of a geom of body 'a' has no length; write two different ends"},
        Bad{"Shell", file("<body name='a'><geom size='1' shellinertia='true'/></body>"),
            "bad.xml:4:31: error: shellinertia of a geom of body 'a' is 'true', which is not supported; "
            "write <inertial pos=\"...\" mass=\"...\" fullinertia=\"...\"/>"},
        Bad{"NegativeDensity", file("<body name='a'><geom size='1' density='-1'/></body>"),
            "bad.xml:4:31: error: density of a geom of body 'a' is -1; it must not be negative"},
        Bad{"MistypedGeom", file("<body name='a'><geom size='1' densty='3'/></body>"),
            "bad.xml:4:31: error: a geom of body 'a' has an unknown attribute 'densty'; did you mean "
            "'density'?"},
        Bad{"SomeGroups", file(body(""), "<compiler inertiagrouprange='2 3'/>"),
            "bad.xml:2:11: error: inertiagrouprange of the compiler is '2 3', which is not supported; write "
            "<inertial> for the bodies that have geoms of other groups"},
        Bad{"NoMass", inertial("pos='0 0 0' diaginertia='1 1 1'"),
            "bad.xml:4:16: error: the inertial of body 'a' has no 'mass'; write <inertial pos=\"...\" "
            "mass=\"...\" fullinertia=\"...\"/>"},
        Bad{"NegativeMass", inertial("pos='0 0 0' mass='-1' diaginertia='1 1 1'"),
            "bad.xml:4:38: error: the mass of body 'a' is -1; it must not be negative"},
        Bad{"TwoInertias", inertial("pos='0 0 0' mass='1' diaginertia='1 1 1' fullinertia='1 1 1 0 0 0'"),
            "bad.xml:4:16: error: the inertial of body 'a' has both 'diaginertia' and 'fullinertia'; write "
            "one of them"},
        Bad{"TurnedFullInertia", inertial("pos='0 0 0' mass='1' quat='0 1 0 0' fullinertia='1 1 1 0 0 0'"),
            "bad.xml:4:47: error: the inertial of body 'a' has both 'fullinertia' and 'quat'; write "
            "fullinertia in the axes of the body"},
        Bad{"Indefinite", inertial("pos='0 0 0' mass='1' fullinertia='1 1 1 0 0 3'"),
            "bad.xml:4:47: error: the inertia of body 'a' is not positive semidefinite; check the signs and "
            "the order xx yy zz xy xz yz"},
        Bad{"TwoOrientations", file(body("", "name='a' quat='1 0 0 0' euler='0 0 0'")),
            "bad.xml:4:31: error: body 'a' has both 'quat' and 'euler'; write one of them"},
        Bad{"ZeroQuaternion", file(body("", "name='a' quat='0 0 0 0'")),
            "bad.xml:4:16: error: quat of body 'a' is zero; write a direction that is one"},
        Bad{"ParallelAxes", file(body("", "name='a' xyaxes='0 0 1 0 0 2'")),
            "bad.xml:4:16: error: xyaxes of body 'a' has parallel axes; write a direction that is one"},
        Bad{"TwoNumbers", file(body("", "name='a' pos='0 1'")),
            "bad.xml:4:16: error: pos of body 'a' has 2 numbers; write three"},
        Bad{"NotANumber", file(body("", "name='a' pos='0 1 one'")),
            "bad.xml:4:16: error: pos of body 'a' is 'one', not a finite decimal number; write a number like "
            "-0.25 or 1.5e-3"},
        Bad{"Mocap", file(body("", "name='a' mocap='true'")),
            "bad.xml:4:16: error: mocap of body 'a' is 'true', which is not supported; only bodies that "
            "forces move are read"},
        Bad{"BodyTwice", file(body("") + body("")),
            "bad.xml:4:75: error: there is a second link 'a'; the first stands in line 4; rename one"},
        Bad{"Ball", file(body("<joint name='j' type='ball'/>")),
            "bad.xml:4:84: error: joint 'j' is a ball joint, which is not supported; write three hinges, one "
            "after the other"},
        Bad{"FreeInside", file(body(body("<freejoint/>", "name='b'"))),
            "bad.xml:4:135: error: body 'b' has a free joint and stands in another body; only a body right "
            "in the worldbody can have a free joint, and no other"},
        Bad{"FreeAndHinge", file(body("<freejoint/><joint name='j'/>")),
            "bad.xml:4:68: error: body 'a' has a free joint and others; only a body right in the worldbody "
            "can have a free joint, and no other"},
        Bad{"DampedFree",
            file(body("<joint name='j' type='free'/>"), "<default><joint damping='1'/></default>"),
            "bad.xml:2:17: error: damping of joint 'j' is 1, which is not supported; write <freejoint/>, "
            "which has no such default"},
        Bad{"NegativeDamping", file(body("<joint name='j' damping='-1'/>")),
            "bad.xml:4:84: error: damping of joint 'j' is -1; it must not be negative"},
        Bad{"NegativeArmature",
            file(body("<joint name='j'/>"), "<default><joint armature='-0.01'/></default>"),
            "bad.xml:2:17: error: armature of joint 'j' is -0.01; it must not be negative"},
        Bad{"ArmatureOfAFreeBody",
            file(body("<joint name='j' type='free'/>"), "<default><joint armature='1'/></default>"),
            "bad.xml:2:17: error: armature of joint 'j' is 1, which is not supported; write <freejoint/>, "
            "which has no such default"},
        Bad{"SpringDamper", file(body("<joint name='j' springdamper='0.1 1'/>")),
            "bad.xml:4:84: error: springdamper of joint 'j' is 0.1 1, which is not supported; write "
            "stiffness and damping"},
        Bad{"LimitedWithoutRange", file(body("<joint name='j' limited='true'/>")),
            "bad.xml:4:84: error: joint 'j' is limited and has no 'range'; write range=\"... ...\""},
        Bad{"RangeUpsideDown", file(body("<joint name='j' range='1 -1'/>")),
            "bad.xml:4:84: error: the range of joint 'j' has lower 1 above upper -1; exchange them"},
        Bad{"Weld", file(body("", "name='a'"), "", "<equality><weld body1='a'/></equality>"),
            "bad.xml:6:11: error: the <equality> has an element <weld>, which is not supported; remove it; a "
            "loop is closed by a [[constraint]] of a side-car file"},
        Bad{"NoSuchJoint",
            file(body("<joint name='knee'/>"), "",
                 "<equality><joint joint1='knee' joint2='kne'/></equality>"),
            "bad.xml:6:32: error: there is no joint 'kne' that an equality can couple; did you mean 'knee'?"},
        Bad{"NotLinear",
            file(body("<joint name='j'/><joint name='k'/>"), "",
                 "<equality><joint joint1='j' joint2='k' polycoef='0 1 2 0 0'/></equality>"),
            "bad.xml:6:40: error: the polynomial that couples 'j' to 'k' is not linear; remove it, and write "
            "a [[coupling]] in a side-car file"},
        Bad{"FollowsItself",
            file(body("<joint name='j'/>"), "", "<equality><joint joint1='j' joint2='j'/></equality>"),
            "bad.xml:6:11: error: joint 'j' mimics itself in the end; let one joint of the circle be free"},
        Bad{"TendonSpring", file(body(""), "", "<tendon><fixed name='t' stiffness='3'/></tendon>"),
            "bad.xml:6:25: error: stiffness of a tendon is 3, which is not supported; write its force as "
            "[[force]] or potential in a side-car file"}),
    [](const ::testing::TestParamInfo<Bad>& info) { return info.param.what; });

}  // namespace
}  // namespace anholon::bad_mjcf_test
