// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Rotations and directions in exact numbers. Files write angles like 1.57079632679; what is within 1e-10 of a
// multiple of pi/4 was meant to be it, and only the exact value makes the zeros of a rotation matrix
// structural.

#include <array>
#include <optional>

#include "number/exact.hpp"

namespace anholon {

using ExactVector = std::array<Exact, 3>;
using ExactMatrix = std::array<Exact, 9>;  // row-major

/// How near an angle or a direction must be to an exact one to be taken for it: 1e-10.
const Exact& snapping_distance();
/// What arithmetic with the working digits leaves of a zero: 1e-34.
const Exact& rounding_distance();

/// The k for which the angle is k pi/4 within a distance, if there is one.
std::optional<int> eighth_turns(const Exact& angle, const Exact& within);

/// Cosine and sine; exact for k pi/4. @param snap  whether an angle within 1e-10 of it is it
std::array<Exact, 2> cosine_and_sine(const Exact& angle, bool snap);

ExactMatrix identity_matrix();

/// The turn by an angle about coordinate axis 0, 1 or 2.
ExactMatrix turn(std::size_t axis, const Exact& angle, bool snap);

/// The unit vector along a, which is not zero. @param snap  whether a direction within 1e-10 of a coordinate
/// axis is it
ExactVector unit_vector(const ExactVector& a, bool snap);

ExactMatrix product(const ExactMatrix& a, const ExactMatrix& b);
ExactVector product(const ExactMatrix& a, const ExactVector& v);
ExactMatrix transposed(const ExactMatrix& a);

/// A frame in another: orientation and origin.
struct ExactPose {
  ExactMatrix R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  ExactVector p = {0, 0, 0};
};
ExactPose compose(const ExactPose& a, const ExactPose& b);
ExactPose inverse(const ExactPose& a);

/// The multiple of 1/2 that x is up to the rounding of its last digits, else x.
Exact settled(const Exact& x);

}  // namespace anholon
