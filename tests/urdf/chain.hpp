// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A chain of links in space, as long as wanted: the URDF text.

#include <fmt/format.h>

#include <string>

namespace anholon::testing {

/// n links on revolute joints about x, y and z in turn, with offsets in two directions and mass centres off
/// every axis.
inline std::string chain(int n) {
  constexpr const char* axes[] = {"1 0 0", "0 1 0", "0 0 1"};
  std::string text = "<robot name='chain'><link name='l0'/>";
  for (int k = 1; k <= n; ++k) {
    text += fmt::format(
        "<link name='l{0}'><inertial><origin xyz='0.0{1} 0.0{2} 0.1'/><mass value='1.{1}'/>"
        "<inertia ixx='0.02{1}' iyy='0.02{2}' izz='0.012' ixy='0.001' ixz='-0.002' "
        "iyz='0.0005'/></inertial></link>"
        "<joint name='j{0}' type='revolute'><parent link='l{3}'/><child link='l{0}'/>"
        "<origin xyz='0.05 0 0.2'/><axis xyz='{4}'/><limit lower='-2' upper='2'/></joint>",
        k, 1 + k % 7, 1 + k % 5, k - 1, axes[k % 3]);
  }
  return text + "</robot>";
}

/// A chain of `trunk` links on one that may float, which ends in so many limbs, each a chain.
inline std::string branching(int trunk, int limbs, int links) {
  const std::string stem = chain(trunk);
  const std::string root = "<link name='l0'/>";
  std::string text =
      "<robot name='branching'><link name='l0'><inertial><origin xyz='0.01 0.02 0.03'/><mass value='3'/>"
      "<inertia ixx='0.05' iyy='0.06' izz='0.04' ixy='0' ixz='0' iyz='0'/></inertial></link>" +
      stem.substr(stem.find(root) + root.size());
  text.erase(text.rfind("</robot>"));
  constexpr const char* axes[] = {"1 0 0", "0 1 0", "0 0 1"};
  for (int i = 0; i < limbs; ++i) {
    std::string parent = fmt::format("l{}", trunk);
    for (int k = 1; k <= links; ++k) {
      const std::string name = fmt::format("limb{}_{}", i, k);
      text += fmt::format(
          "<link name='{0}'><inertial><origin xyz='0.01 0.0{1} -0.1'/><mass value='0.{2}'/>"
          "<inertia ixx='0.011' iyy='0.012' izz='0.009' ixy='0.001' ixz='0.000{2}' "
          "iyz='-0.0005'/></inertial></link>"
          "<joint name='to_{0}' type='{3}'><parent link='{4}'/><child link='{0}'/>"
          "<origin xyz='0.0{1} 0.1 -0.2' rpy='0.3 0 0.1'/><axis xyz='{5}'/>"
          "<limit lower='-1' upper='1'/></joint>",
          name, 1 + i, 1 + k % 3, k == 2 ? "prismatic" : "revolute", parent, axes[k % 3]);
      parent = name;
    }
  }
  return text + "</robot>";
}

}  // namespace anholon::testing
