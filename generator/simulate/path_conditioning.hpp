// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// How well conditioned a motion is on its way, and how many digits its accelerations keep: the generated code
// against the same program in exact arithmetic at every state of the trajectory.

#include <string>
#include <vector>

#include "simulate/simulation.hpp"

namespace anholon {

struct PathPoint {
  double t = 0;           // s
  std::size_t chart = 0;  // of the kernel, from 1
  double condition = 1;   // of (A, B_p): largest singular value by the smallest that belongs to its rank
  std::vector<double> quality;  // of every chart; empty where there is one
  double error = 0;             // of the passive accelerations, relative to the largest of them
};

struct PathConditioning {
  SimulationResult motion;
  std::vector<PathPoint> points;  // one for each row of the motion
};

/// @throws ModelError, CompileError, UnfitSceneError for a scene of several phases
PathConditioning path_conditioning(const Scene& scene, const Progress& progress = {});

/// One line of names with units first.
std::string conditioning_csv(const PathConditioning& path);
/// Two panels over time, logarithmic: conditioning above, error below.
std::string conditioning_svg(const PathConditioning& path, const std::string& title);

}  // namespace anholon
