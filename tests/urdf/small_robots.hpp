// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// URDF files with figures of our own: an arm with every kind of joint and tilted axes, and a walker that
// branches.

#include <string>

namespace anholon::testing {

inline std::string link(const std::string& name, const std::string& mass, const std::string& com,
                        const std::string& rpy = "0 0 0") {
  return "<link name='" + name + "'><inertial><origin xyz='" + com + "' rpy='" + rpy + "'/><mass value='" +
         mass +
         "'/><inertia ixx='0.011' ixy='0.001' ixz='-0.002' iyy='0.013' iyz='0.0015' "
         "izz='0.009'/></inertial></link>\n";
}
inline std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                         const std::string& child, const std::string& xyz, const std::string& rpy,
                         const std::string& axis, const std::string& more = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
         child + "'/><origin xyz='" + xyz + "' rpy='" + rpy + "'/><axis xyz='" + axis +
         "'/><limit lower='-2' upper='2' effort='1' velocity='1'/>" + more + "</joint>\n";
}

/// Six joints in a row, turns about coordinate axes and a tilted one, a slide, and fixed links; `more` adds
/// to it.
inline std::string arm_with(const std::string& name, const std::string& more) {
  return "<robot name='" + name + "'>\n" + link("base", "3", "0.1 0 0.02") +
         link("one", "2.5", "0.01 -0.03 0.2") + link("two", "2", "0.15 0.02 0.01", "0.1 -0.2 0.3") +
         link("three", "1.5", "0 0.11 0.05") + link("tool", "0.4", "0 0.01 0.03") +
         link("four", "1.1", "0.02 0.01 0.09") + link("five", "0.7", "0.03 -0.02 0.04") +
         link("six", "0.5", "0.01 0.02 0.05") + link("mount", "0.2", "0 0 0.01") +
         joint("j1", "revolute", "base", "one", "0 0 0.3", "0 0 0", "0 0 1",
               "<dynamics damping='0.3' friction='0.1'/>") +
         joint("j2", "continuous", "one", "two", "0.05 0.02 0.1", "-1.57079632679 0 0", "0 0 1") +
         joint("j3", "prismatic", "two", "three", "0.2 0.1 -0.05", "0 0.785398163397 0.2", "1 0 0",
               "<dynamics damping='2'/>") +
         joint("j4", "revolute", "three", "four", "0.01 0.2 0.03", "1.57079632679 0 3.14159265359",
               "0 -1 0") +
         joint("j5", "revolute", "four", "five", "0.02 0.1 0.3", "0.3 -0.4 0.5", "0.6 0 0.8") +
         joint("j6", "revolute", "five", "six", "0.1 0 0.07", "0 0 1.57079632679", "0 1 0") +
         joint("weld", "fixed", "six", "tool", "0 0 0.1", "0.2 0.1 -0.3", "0 0 1") +
         joint("foot", "fixed", "base", "mount", "0.1 0 0", "0 0 0", "0 0 1") + more + "</robot>\n";
}
inline std::string serial_arm() { return arm_with("serial_arm", ""); }

/// The same with a finger that mimics the last joint.
inline std::string arm() {
  return arm_with("arm", link("seven", "0.3", "0.01 0.02 -0.01") +
                             joint("j7", "revolute", "five", "seven", "0 0.06 0", "0 0 0", "0 0 1",
                                   "<mimic joint='j6' multiplier='-1.5' offset='0.2'/>"));
}

/// A trunk with two legs of three joints and a head; free base.
inline std::string walker() {
  std::string text = "<robot name='walker'>\n" + link("trunk", "9", "0.02 -0.01 0.05") +
                     link("head", "0.8", "0.01 0.02 0.09") +
                     joint("neck", "revolute", "trunk", "head", "0.1 0 0.2", "0 0 0", "0 1 0");
  for (const std::string side : {"left", "right"}) {
    const std::string y = side == "left" ? "0.12" : "-0.12";
    text +=
        link(side + "_hip", "1.2", "0.01 " + y + " 0") + link(side + "_thigh", "1.9", "0.01 0.02 -0.15") +
        link(side + "_shank", "0.9", "0.02 0 -0.13") +
        joint(side + "_roll", "revolute", "trunk", side + "_hip", "0.05 " + y + " -0.1", "0 0 0", "1 0 0") +
        joint(side + "_pitch", "revolute", side + "_hip", side + "_thigh", "0.02 " + y + " 0", "0 0 0",
              "0 1 0") +
        joint(side + "_knee", "revolute", side + "_thigh", side + "_shank", "0 0.01 -0.3", "0 0 0", "0 1 0");
  }
  return text + "</robot>\n";
}

}  // namespace anholon::testing
