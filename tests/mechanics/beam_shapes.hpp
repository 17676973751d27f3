// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Shapes of beams by their definitions, and Gauss quadrature, in long double: for witnesses. Nothing here
// shares code with the generator.

#include <cmath>
#include <utility>
#include <vector>

#include "mechanics/jet.hpp"

namespace anholon::test {

/// Nodes and weights of Gauss-Legendre quadrature on [0, 1], by Newton on the Legendre polynomial.
inline std::vector<std::pair<Real, Real>> gauss_legendre(int n) {
  std::vector<std::pair<Real, Real>> rule;
  for (int i = 0; i < n; ++i) {
    Real x = std::cos(M_PIl * (i + 0.75L) / (n + 0.5L)), slope = 1;
    for (int step = 0; step < 60; ++step) {
      Real p = 1, before = 0;
      for (int k = 0; k < n; ++k) {
        const Real next = ((2 * k + 1) * x * p - k * before) / (k + 1);
        before = p, p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

/// Cantilever mode j = 1, 2, ... with phi(1) = 1: cosh bs - cos bs - sigma (sinh bs - sin bs) over its value
/// at 1. The hyperbolic functions are taken apart, because sigma is close to 1: 1 - sigma = (sin b - cos b -
/// e^-b) / (sinh b + sin b).
struct Cantilever {
  Real b, sigma, difference, tip;
  explicit Cantilever(int j) {
    Real low = (j - 1) * M_PIl + 1e-3L, high = j * M_PIl;  // cos b cosh b = -1, one root in each interval
    const auto f = [](Real x) { return std::cos(x) + 1 / std::cosh(x); };
    for (int i = 0; i < 200; ++i) {
      const Real middle = (low + high) / 2;
      ((f(middle) > 0) == (f(low) > 0) ? low : high) = middle;
    }
    b = low;
    difference = (std::sin(b) - std::cos(b) - std::exp(-b)) / (std::sinh(b) + std::sin(b));
    sigma = 1 - difference;
    tip = part(1, -1);
  }
  [[nodiscard]] Real part(Real s, Real sign) const {
    const Real hyperbolic = (difference * std::exp(b * s) + (1 + sigma) * std::exp(-b * s)) / 2;
    return hyperbolic + sign * (std::cos(b * s) - sigma * std::sin(b * s));
  }
  [[nodiscard]] Real at(Real s) const { return part(s, -1) / tip; }
  [[nodiscard]] Real slope(Real s) const {  // sinh bs + sin bs - sigma (cosh bs - cos bs)
    const Real hyperbolic = (difference * std::exp(b * s) - (1 + sigma) * std::exp(-b * s)) / 2;
    return b * (hyperbolic + std::sin(b * s) + sigma * std::cos(b * s)) / tip;
  }
  [[nodiscard]] Real curvature(Real s) const { return b * b * part(s, 1) / tip; }
};

}  // namespace anholon::test
