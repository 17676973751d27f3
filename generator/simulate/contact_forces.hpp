// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Contact forces in physical terms, and how redundant contacts share what statics leaves open.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "describe/scene.hpp"

namespace anholon {

/// The force of one contact as a linear function of all multipliers: rows x multipliers.
struct ContactMap {
  std::string name;
  Eigen::MatrixXd normal;      // 1 x rows, away from the ground; empty in a plane model
  Eigen::MatrixXd tangential;  // (longitudinal, lateral) x rows; or components across the normal
  double friction = 0;         // coefficient; 0: not given
  bool unilateral = true;
};

/// What may decide how a load is shared: the multipliers are lambda + N s for any s.
struct SharingProblem {
  Eigen::VectorXd lambda;  // of least norm
  Eigen::MatrixXd N;       // rows x lambda_stat: basis of ker A^T
  std::vector<ContactMap> contacts;
};

/// s of a problem. One of the library's, or a program's own.
using SharingRule = std::function<Eigen::VectorXd(const SharingProblem&)>;

/// lambda of least norm: s = 0.
SharingRule least_norm_sharing();

/// Loads first: the normal forces of least norm. Then the tangential forces T that minimise the sum of
/// |T|^2/(mu N): contacts that can help each other freely get equal T/(mu N). What still is open gets least
/// norm.
SharingRule equal_friction_sharing();

SharingRule sharing_rule(LoadSharing sharing);

}  // namespace anholon
