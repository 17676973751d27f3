// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The same motion by every engine: a robot that starts at its first sample and falls freely.

#include <array>
#include <string>
#include <vector>

#include "anholon/mechanism.hpp"
#include "robot.hpp"

namespace anholon::bench {

/// Where a motion ends: (R row-major, p in m) of a free base and r; its twist in its own axes, linear part
/// first, and r_dot.
struct FinalState {
  std::vector<double> position, velocity;
};

/// What a free base adds, from what engines keep of it: quaternion, position and linear velocity in world
/// axes, angular velocity in its own.
FinalState free_base(const std::array<double, 4>& quaternion_wxyz, const Vec3<double>& p,
                     const Vec3<double>& linear_in_world, const Vec3<double>& angular);

/// One engine at one accuracy, whatever that is for it.
struct MotionRun {
  FinalState end;
  double cpu_seconds = 0;
  long evaluations = 0;  // of the dynamics; 0 where the engine does not tell
  std::string status = "ok";
};

/// MuJoCo's classical Runge-Kutta method of order 4 with equal steps.
MotionRun mujoco_motion(const Robot& robot, double duration, long steps);
/// Simbody's Runge-Kutta-Merson 4(3) integrator at an accuracy.
MotionRun simbody_motion(const Robot& robot, double duration, double accuracy);

}  // namespace anholon::bench
