// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Shapes that a beam may deflect in, over x = X/L in [0, 1], and the integrals of them that the dynamics
// needs, by Gauss quadrature to more than 40 digits. Bending shapes of a clamped beam, with b and sigma from
// the boundary conditions at the other end:
//
//   f(x) = [cosh bx - cos bx - sigma (sinh bx - sin bx)] / (the same at 1)
//
// The beam may carry a body at its end, as far as the choice of the shapes goes: tip_mass in units of rhoA L,
// tip_inertia in units of rhoA L^3. Without one the b are the roots of cos b cosh b = -1.

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "number/exact.hpp"

namespace anholon {

/// f, f' and f'' at x.
using BeamShape = std::function<std::array<Exact, 3>(const Exact& x)>;

struct ClampedMode {
  Exact b;
  Exact sigma;
};

/// @param index  from 1 (the lowest) to 30
ClampedMode clamped_mode(int index, const Exact& tip_mass = 0, const Exact& tip_inertia = 0);

/// Unit deflection at the end.
BeamShape clamped_shape(const ClampedMode& mode);
/// sin(i pi x): both ends on the body's x axis.
BeamShape pinned_shape(int index);
/// sin((i - 1/2) pi x) with the sign that makes it 1 at the end: torsion and axial deflection, fixed-free.
BeamShape fixed_free_shape(int index);

enum class BeamFamily { bending_y, bending_z, torsion, axial };
constexpr bool bends(BeamFamily family) {
  return family == BeamFamily::bending_y || family == BeamFamily::bending_z;
}

struct BeamMode {
  BeamFamily family = BeamFamily::bending_y;
  BeamShape shape;
};

/// A part of the beam, from where the one before ends, with its properties as functions of x in units of
/// those of the whole beam; empty where they are the same.
struct BeamSection {
  using Factor = std::function<Exact(const Exact& x)>;
  Exact to = 1;
  Factor mass, bending_y, bending_z, torsion, axial, polar_inertia;
};

/// Dimensionless integrals over [0, 1]; m is the mass factor, but the factor of polar inertia where torsion
/// meets torsion.
struct BeamIntegrals {
  std::array<Exact, 3> mass;                   // of m, m x, m x^2
  Exact polar;                                 // of the factor of polar inertia
  std::vector<Exact> mean, moment;             // of m f_j, m x f_j
  std::vector<std::vector<Exact>> overlap;     // of m f_j f_l
  std::vector<std::vector<Exact>> stiffness;   // f_j'' f_l'' in bending, else f_j' f_l'; 0 across families
  std::vector<std::vector<Exact>> shortening;  // of m(x) int_0^x f_j' f_l' within a plane of bending
  std::vector<std::vector<Exact>> shortening_moment;  // of m(x) x int_0^x f_j' f_l'
};

/// @throws std::domain_error with a reason where a factor of a section is negative or undefined
BeamIntegrals beam_integrals(const std::vector<BeamMode>& modes, const std::vector<BeamSection>& sections);

/// Integrals of f_j' f_l' over [0, x] within a plane of bending; 0 elsewhere.
std::vector<std::vector<Exact>> shortening_up_to(const Exact& x, const std::vector<BeamMode>& modes);

/// What is an integer or a simple fraction to 50 digits; other values as they are.
Exact snapped(const Exact& x);

}  // namespace anholon
