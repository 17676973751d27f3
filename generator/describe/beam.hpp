// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Cantilever modes of a uniform Euler-Bernoulli beam, normalised to unit tip deflection, and their integrals
// in closed form. With x = X/L in [0, 1], b_i the i-th positive root of cos b cosh b = -1, sigma = (cosh b +
// cos b) / (sinh b + sin b) and s = (-1)^(i+1):
//
//   phi_i(x) = s/2 [cosh bx - cos bx - sigma (sinh bx - sin bx)],   phi_i(1) = 1
//   int phi_i dx = s sigma / b,   int x phi_i dx = s / b^2,   int phi_i phi_j dx = delta_ij / 4
//
// Modal stiffness: EI int phi_i''^2 dX = EI b^4 / (4 L^3).

#include "number/exact.hpp"

namespace anholon {

/// Integrals of one mode over x in [0, 1], to the working digits.
struct CantileverMode {
  Exact b;  // root of cos b cosh b = -1
  Exact sigma;
  int sign = 1;  // s
  Exact mean;    // int phi dx
  Exact moment;  // int x phi dx
};

/// @param index  from 1 (the lowest) to 30
CantileverMode cantilever_mode(int index);

}  // namespace anholon
