// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Remark 7 of the article: springs in the contacts determine how redundant ones share. One scene, its
// contacts stiffer from step to step, beside the same scene with rigid contacts and lambda of least norm.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "describe/scene.hpp"

namespace anholon {

/// The multipliers at the end of the scene, at one stiffness.
struct StiffnessStep {
  double stiffness = 0;    // N/m or N m/rad
  Eigen::VectorXd lambda;  // by row
  double distance = 0;     // to the rigid ones, relative to the largest of them
  long evaluations = 0;
  std::string status;
};

struct StiffnessLadder {
  std::vector<std::string> rows;  // of rigid contacts: those that hold by themselves carry nothing
  Eigen::VectorXd rigid;          // least norm
  std::vector<StiffnessStep> steps;
};

/// @param factors  of the scene's stiffness; its damping grows with their root, so that damping ratios stay
/// @throws ModelError where the scene has no contact_elasticity, or stops early with rigid contacts
StiffnessLadder stiffness_ladder(const Scene& scene, const std::vector<double>& factors);

}  // namespace anholon
