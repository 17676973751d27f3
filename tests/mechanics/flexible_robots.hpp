// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Known motions of flexible robots, for tests and for bench/flexible_figures.cpp:
// frequencies of rotating beams, the spin-up manoeuvre of Kane, Ryan and Banerjee (1987) and Wu and Haug
// (1988), an arm whose flexible link carries another one, by the recursion, by Ritz and by finite elements.

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "describe/model.hpp"
#include "mechanics/jet.hpp"

namespace anholon::test {

using Square = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

/// omega of K x = omega^2 M x, rising; imaginary ones as minus their magnitude.
std::vector<Real> frequencies(const Square& K, const Square& M);

/// A shipped model, with parts of its text replaced. @throws std::invalid_argument where it has no such part
Model model_with(const std::string& name, const std::vector<std::pair<std::string, std::string>>& changes);

/// The keys of a beam with n modes, whose coordinates are `prefix` 1 ... n.
std::string modes(int n, const std::string& prefix);

/// Frequencies of the coordinates that are not driven, at rest relative to the motion of the driven ones.
std::vector<Real> small_motion(const Model& model, const std::vector<Real>& r,
                               const std::vector<Real>& r_dot);

/// Frequencies of a unit beam (rhoA = EI = L = 1) on a hinge that turns at the rate Omega.
std::vector<Real> rotating(int n, const std::string& deformation, Real Omega);

/// (t, deflection of the tip) of the shipped rotating beam with n modes, from rest to `speed` within 15 s, by
/// classical Runge-Kutta steps of 5 ms, an eightieth of the shortest period with three modes.
std::vector<std::pair<double, double>> spin_up(int n, const std::string& deformation, double speed);

/// Frequencies of the shipped two-link arm with n modes at the elbow angle q2; `ends` are keys of the shapes.
std::vector<Real> arm_of_model(int n, Real q2, const std::string& ends = "");
/// Of the same arm, from the integrals of its shapes.
std::vector<Real> arm_by_ritz(int n, Real q2);
/// Of the same arm, by cubic elements with consistent masses.
std::vector<Real> arm_by_finite_elements(int elements, Real q2);

/// The soft snake-board with n modes in each beam.
Model snakeboard(int n, const std::string& deformation);

}  // namespace anholon::test
