// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "anholon/mechanism.hpp"

namespace anholon::testing {

/// Inertia of a body about its mass centre, in the body's axes.
inline Mat3<double> central_inertia(const Body<double>& b, Vec3<double>& centre) {
  centre = b.mass == 0 ? Vec3<double>{} : (1 / b.mass) * b.first_moment;
  const double square = dot(centre, centre);
  Mat3<double> I = b.inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) I(i, j) -= b.mass * ((i == j ? square : 0.0) - centre[i] * centre[j]);
  }
  return I;
}

}  // namespace anholon::testing
