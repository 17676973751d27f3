// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A scene, generated, compiled and integrated: trajectory, torques, constraint forces, energies.

#include <string>
#include <vector>

#include "describe/scene.hpp"

namespace anholon {

/// One row of a trajectory; see SimulationResult::columns.
struct SimulationResult {
  std::vector<std::string> columns;  // with units: "V_X [m/s]"
  std::vector<std::vector<double>> rows;
  std::string status;  // "ok", or why the integration stopped
  bool finished = false;
  long steps = 0, rejected = 0, evaluations = 0;
  double cpu_seconds = 0;  // of the integration alone
  double nanoseconds_per_evaluation = 0;
  double energy_balance = 0;       // largest |E(t) - E(0) - work + dissipation| / scale of the energies
  double constraint_residual = 0;  // largest |A eta + B r_dot| relative to what cancels
  double orthonormality = 0;       // largest ||R^T R - 1||
  int operations = 0;              // of one evaluation of the field
  bool was_cached = false;         // the compiled code
  std::string class_of_table_I;
};

/// @throws ModelError, CompileError
SimulationResult simulate_scene(const Scene& scene);

/// Error against cost for one way to compute, at one tolerance.
struct WorkPrecisionPoint {
  std::string code;  // "generated", "recursion"
  double tolerance = 0;
  double error = 0;  // of the final state against a long double run of tolerance 1e-16
  double cpu_seconds = 0;
  long evaluations = 0;
  std::string status;
};
std::vector<WorkPrecisionPoint> work_precision(const Scene& scene);

}  // namespace anholon
