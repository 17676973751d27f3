// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Gauss-Legendre quadrature in exact arithmetic's floats.

#include <utility>
#include <vector>

#include "number/exact.hpp"

namespace anholon {

struct QuadraturePoint {
  Exact x, weight;
};

/// The rule of `points` points on [0, 1], nodes by Newton on the Legendre polynomial, to the working digits.
/// It is exact for polynomials below the degree 2 points.
std::vector<QuadraturePoint> gauss_legendre(int points);

}  // namespace anholon
