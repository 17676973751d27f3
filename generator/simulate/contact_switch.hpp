// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Contacts that begin: an impulse of theirs takes the velocities to admissible ones. Imposed joint motions go
// on, so the motors answer with impulses of their own.

#include <Eigen/Core>

#include "simulate/runner.hpp"

namespace anholon {

/// Velocities and impulses at a switch. With d the jump of the passive velocities and M their mass matrix,
/// M d = A^T impulses, and v + d is the admissible velocity nearest to v in the kinetic metric.
struct VelocityJump {
  Eigen::VectorXd velocities;  // after; passive, in the partition's order
  Eigen::VectorXd impulses;    // one for each row of the new contacts, N s (N m s)
  double lost = 0;             // d^T M d / 2, J
  double work = 0;             // of the motors' impulses, J
  double relative = 0;         // sqrt(d^T M d / v^T M v): 0 none, 1 everything stops
};

/// @param state   position at the switch, all velocities before it
VelocityJump velocity_jump(const Model& model, const Partition& partition, const State<double>& state);

/// State that the buffers of a run hold, after rates().
State<double> state_of(const SceneProgram& program, Runner<double>& run);

/// Velocities after a switch into the buffers of the run that goes on, with nu.
void take_velocities(const SceneProgram& program, Runner<double>& run, const Eigen::VectorXd& passive);

}  // namespace anholon
