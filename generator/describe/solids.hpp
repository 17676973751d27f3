// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Homogeneous solids and bodies made of them, in exact numbers (pi and what it is multiplied with: to the
// working digits).

#include <array>
#include <vector>

#include "describe/exact_rotation.hpp"

namespace anholon {

/// A solid about its own axes; its centre of mass is the origin.
struct Solid {
  Exact volume;                         // m^3
  std::array<Exact, 3> square_lengths;  // moments of inertia per mass, m^2
};

Solid ball(const Exact& radius);
/// @param half  half the edges
Solid box(const ExactVector& half);
/// @param half  half the axes
Solid ellipsoid(const ExactVector& half);
/// Along z, 2 half long.
Solid cylinder(const Exact& radius, const Exact& half);
/// A cylinder along z that half balls end.
Solid capsule(const Exact& radius, const Exact& half);

/// A solid's mass and place in a body.
struct PlacedSolid {
  Solid solid;
  Exact mass;
  ExactPose pose;
};

/// Mass, centre of mass and central inertia (xx yy zz xy xz yz) in the body's axes; the mass must not vanish.
struct BodyOfSolids {
  Exact mass;
  ExactVector centre;
  std::array<Exact, 6> inertia;
};
BodyOfSolids joined(const std::vector<PlacedSolid>& solids);

}  // namespace anholon
