// SPDX-License-Identifier: GPL-2.0-or-later
//
// A motion known in closed form on any Lie group, and a field that has it as its solution.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace anholon::testing {

/// The body follows g(t) = exp(a(t) xi_1) exp(b(t) xi_2), whose twist
///
///   eta(t) = a'(t) Ad(exp(-b xi_2)) xi_1 + b'(t) xi_2,      a = sin t, b = t + t^2/4
///
/// never commutes with itself at another time, and y(t) = (cos t, exp(-t), t^2). The field adds terms that
/// vanish on this solution but not beside it: pose and y exchange their errors as an oscillator does, at
/// about 4 rad/s, so that the error of a method comes from its nested stages and not from quadrature alone,
/// whose terms of order 5 are so small in Dormand-Prince that those of order 6 would hide them down to h =
/// 1/50.
template <class G>
struct ManufacturedMotion {
  using Real = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  static constexpr int size_y = 3;

  Tangent xi_1 = axis({0.3, -0.8, 0.5, 0.6, 0.2, -0.7}), xi_2 = axis({-0.5, 0.4, 0.9, -0.3, 0.7, 0.4});
  Real coupling = Real(4);
  mutable long evaluations = 0;

  /// The last `dim` of six numbers, so that the angular part is never 0.
  static Tangent axis(const std::array<double, 6>& numbers) {
    Tangent xi;
    for (int i = 0; i < G::dim; ++i) xi[i] = Real(numbers[6 - G::dim + i]);
    return xi;
  }

  G pose(Real t) const { return G::exp(std::sin(t) * xi_1) * G::exp((t + t * t / 4) * xi_2); }
  Vector y(Real t) const {
    Vector values(size_y);
    values << std::cos(t), std::exp(-t), t * t;
    return values;
  }

  void operator()(Real t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) const {
    ++evaluations;
    const Tangent astray = (g.inverse() * pose(t)).log();
    const Real y_0_astray = y[0] - std::cos(t), y_1_astray = y[1] - std::exp(-t);
    eta = std::cos(t) * (G::exp(-(t + t * t / 4) * xi_2).adjoint() * xi_1) + (1 + t / 2) * xi_2 +
          coupling * (y_0_astray * xi_1 + y_1_astray * xi_2);
    y_dot[0] = -std::sin(t) - y_0_astray * y[1] + coupling * astray.dot(xi_1);
    y_dot[1] = -y[1] + coupling * astray.dot(xi_2);
    y_dot[2] = 2 * t;
  }

  /// Distance from the solution: tangent of the pose error and error of y together.
  Real error(Real t, const G& g, const Vector& y_found) const {
    return std::sqrt((pose(t).inverse() * g).log().squaredNorm() + (y_found - y(t)).squaredNorm());
  }
};

}  // namespace anholon::testing
