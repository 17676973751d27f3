// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A robot as every contender sees it: its mechanism in numbers, bodies on fixed joints merged, and random
// states within the limits of its joints.

#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "anholon/mechanism.hpp"
#include "describe/model.hpp"

namespace anholon::bench {

/// One state with the motion or the forces that go with it. eta and eta_dot are zero for a fixed base.
struct Sample {
  State<double> state;
  std::array<double, 4> quaternion_wxyz = {1, 0, 0, 0};  // of state.R
  Spatial<double> eta_dot;                               // derivative of eta's components
  std::vector<double> r_ddot;                            // (s)
  std::vector<double> tau;                               // (s) forces of the joints
};

struct Robot {
  std::string name;
  Model model;                  // without springs, dampers, friction and armatures: no peer is asked for them
  Model symbolic;               // the same with inertial figures as parameters
  Mechanism<double> mechanism;  // of the described frames
  std::vector<Sample> samples;
};

/// Robots whose base stands on the ground, by the names of their files; all others float.
inline std::set<std::string> fixed_bases() { return {"double_pendulum", "iiwa", "panda", "ur5"}; }

/// R of a unit quaternion, scalar first.
Mat3<double> rotation(const std::array<double, 4>& wxyz);

/// @param count  number of samples
Robot load_robot(const std::filesystem::path& urdf, bool floating, std::size_t count);

}  // namespace anholon::bench
