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

}  // namespace anholon::testing
