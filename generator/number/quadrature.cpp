// SPDX-License-Identifier: GPL-2.0-or-later
#include "number/quadrature.hpp"

#include <cmath>

namespace anholon {
namespace {

/// P_n(x) and its derivative.
template <class S>
std::pair<S, S> legendre(int n, const S& x) {
  S before(0), p(1);
  for (int k = 0; k < n; ++k) {
    const S next = (S(2 * k + 1) * x * p - S(k) * before) / S(k + 1);
    before = p;
    p = next;
  }
  const S slope = S(n) * (x * p - before) / (x * x - S(1));
  return {p, slope};
}

}  // namespace

std::vector<QuadraturePoint> gauss_legendre(int points) {
  std::vector<QuadraturePoint> rule;
  for (int i = 0; i < points; ++i) {
    double start = -std::cos(M_PI * (i + 0.75) / (points + 0.5));
    for (int step = 0; step < 20; ++step) {
      const auto [p, slope] = legendre(points, start);
      start -= p / slope;
    }
    Exact x = Exact::from_double(start).as_float();
    for (unsigned digits = 14; digits < 2 * WorkingDigits::current(); digits *= 2) {  // doubled by each step
      const auto [p, slope] = legendre(points, x);
      x -= p / slope;
    }
    const Exact slope = legendre(points, x).second;
    rule.push_back({(Exact(1) + x) / Exact(2), Exact(1) / ((Exact(1) - x * x) * slope * slope)});
  }
  return rule;
}

}  // namespace anholon
