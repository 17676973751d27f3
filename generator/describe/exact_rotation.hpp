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

/// The k for which the angle is within 1e-10 of k pi/4, if there is one.
std::optional<int> eighth_turns(const Exact& angle);

/// Cosine and sine; of k pi/4 exactly where `snap` allows it.
std::array<Exact, 2> cosine_and_sine(const Exact& angle, bool snap);

/// Rz(yaw) Ry(pitch) Rx(roll).
ExactMatrix rotation_from_rpy(const ExactVector& rpy, bool snap);

/// The unit vector along a, which is not zero. @param snap  whether a direction within 1e-10 of a coordinate
/// axis is it
ExactVector unit_vector(const ExactVector& a, bool snap);

ExactMatrix product(const ExactMatrix& a, const ExactMatrix& b);
ExactVector product(const ExactMatrix& a, const ExactVector& v);
ExactMatrix transposed(const ExactMatrix& a);

/// The multiple of 1/2 that x is up to the rounding of its last digits, else x.
Exact settled(const Exact& x);

}  // namespace anholon
