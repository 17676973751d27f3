// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What a motion in double is judged by on the way: balance of energy, constraints, compatibility of the
// imposed motion.

#include <string>
#include <vector>

#include "simulate/runner.hpp"

namespace anholon {

/// E(t) - E(0) - work + dissipated, and its largest size relative to the largest of the energies that take
/// part: kinetic, change of potential, work, dissipated.
class EnergyMonitor {
 public:
  /// @return the defect at this time [J]
  double observe(double kinetic, double potential, double work, double dissipated);
  /// The largest of the energies that took part so far [J].
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] double largest_relative_defect() const { return scale_ > 0 ? worst_ / scale_ : 0; }

 private:
  bool started_ = false;
  double initial_ = 0, initial_potential_ = 0, scale_ = 0, worst_ = 0;
};

/// |A eta + B_p r_p_dot + B_a r_a_dot| relative to what cancels in it, at the velocities in the buffers; 0
/// without rows.
double constraint_residual(const SceneProgram& program, Runner<double>& run);

/// The conditions that an over-constrained system puts on its imposed motion, one for each row that the
/// leading rows of (A, B_p) imply.
class CompatibilityMonitor {
 public:
  CompatibilityMonitor(const SceneProgram& program, Runner<double>& run);
  /// Which row the imposed rates or accelerations violate at the state in the buffers; empty where none.
  /// Needs rates().
  std::string violation(double t);

 private:
  const SceneProgram& program_;
  Runner<double>& run_;
  std::vector<int> implied_;                    // rows
  std::vector<double> rate_size_, accel_size_;  // of the terms of each condition, the largest so far
};

}  // namespace anholon
