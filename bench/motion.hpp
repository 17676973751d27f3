// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The same motion by every engine: a robot on a fixed base that starts at its first sample and falls freely.

#include <string>
#include <vector>

#include "robot.hpp"

namespace anholon::bench {

/// Where a motion ends.
struct FinalState {
  std::vector<double> r, r_dot;
};

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
