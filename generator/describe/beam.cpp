// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/beam.hpp"

#include <cmath>
#include <stdexcept>

namespace anholon {
namespace {

Exact cosh(const Exact& x) {
  const Exact e = exp(x);
  return (e + Exact(1) / e) / Exact(2);
}

Exact sinh(const Exact& x) {
  const Exact e = exp(x);
  return (e - Exact(1) / e) / Exact(2);
}

/// Root of cos b + 1 / cosh b = 0 near (index - 1/2) pi, by Newton from its value in double.
Exact root(int index) {
  double start = (index - 0.5) * M_PI;
  for (int i = 0; i < 20; ++i)
    start -=
        (std::cos(start) + 1 / std::cosh(start)) / (-std::sin(start) - std::tanh(start) / std::cosh(start));
  Exact b = Exact::from_double(start).as_float();
  for (unsigned digits = 15; digits < 2 * WorkingDigits::current();
       digits *= 2) {  // each step doubles the digits
    const Exact inverse_cosh = Exact(1) / cosh(b);
    const Exact slope = -sin(b) - sinh(b) * inverse_cosh * inverse_cosh;
    b -= (cos(b) + inverse_cosh) / slope;
  }
  return b;
}

}  // namespace

CantileverMode cantilever_mode(int index) {
  if (index < 1 || index > 30) throw std::invalid_argument("modes are numbered from 1 to 30");
  const WorkingDigits digits(128);
  CantileverMode mode;
  mode.b = root(index);
  mode.sigma = (cosh(mode.b) + cos(mode.b)) / (sinh(mode.b) + sin(mode.b));
  mode.sign = index % 2 == 1 ? 1 : -1;
  mode.mean = Exact(mode.sign) * mode.sigma / mode.b;
  mode.moment = Exact(mode.sign) / (mode.b * mode.b);
  return mode;
}

}  // namespace anholon
