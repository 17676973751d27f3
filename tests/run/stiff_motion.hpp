// SPDX-License-Identifier: GPL-2.0-or-later
//
// A stiff motion known in closed form on any Lie group, after Prothero and Robinson: a field that has it as
// its solution however fast its fast components are, with the Jacobian written out.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "run/manufactured_motion.hpp"

namespace anholon::testing {

/// The pose is that of ManufacturedMotion, y = (cos t, exp(-t), psi/omega^2, psi'/omega^2, z) with
/// psi = 1 + sin(2t)/2 and z = sin(3t)/2. The components 2 and 3 are those of a compliant mechanism: an
/// elongation, which a spring of frequency omega keeps small while its force psi stays, and its rate. That
/// force drives the slow component 0, as in reduced coordinates, by a share that changes with the shape.
/// The last component relaxes at the rate lambda. Pose and y exchange their errors.
template <class G>
struct StiffMotion {
  using Real = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector3 = Eigen::Matrix<Real, 3, 1>;
  static constexpr int size_y = 5;

  Real omega = Real(3), lambda = Real(2);
  ManufacturedMotion<G> path = path_of_the_pose();
  Vector3 w{Real(0.7L), Real(-0.4L), Real(0.5L)}, u{Real(0.3L), Real(0.9L), Real(-0.2L)},
      v{Real(-0.6L), Real(0.5L), Real(0.8L)};

  G pose(Real t) const { return path.pose(t); }
  Vector y(Real t) const {
    Vector values(size_y);
    values << std::cos(t), std::exp(-t), psi(t) / (omega * omega), std::cos(2 * t) / (omega * omega),
        std::sin(3 * t) / 2;
    return values;
  }

  void operator()(Real t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) const {
    const Real off_0 = y[0] - std::cos(t), off_1 = y[1] - std::exp(-t), off_4 = y[4] - std::sin(3 * t) / 2;
    const Real s = astray(t, g), force = omega * omega * y[2] - psi(t);
    eta = twist(t) + (2 * off_0 + off_4) * path.xi_1 + (2 * off_1 + s) * path.xi_2;
    y_dot[0] = -std::sin(t) - off_0 * y[1] + share(y[1]) * force + 2 * s;
    y_dot[1] = -y[1] + 2 * s;
    y_dot[2] = y[3];
    y_dot[3] = -2 * std::sin(2 * t) / (omega * omega) - (2 + share(y[1])) * force + off_0;
    y_dot[4] = Real(1.5L) * std::cos(3 * t) - lambda * (1 + y[0] * y[0]) * (off_4 - s);
  }

  void jacobian(Real t, const G& g, const Vector& y, Matrix& F, Vector& F_t) const {
    const Real off_0 = y[0] - std::cos(t), off_4 = y[4] - std::sin(3 * t) / 2;
    const Real s = astray(t, g), force = omega * omega * y[2] - psi(t);
    const Real relax = lambda * (1 + y[0] * y[0]), share_slope = std::cos(y[1]) / 2;
    constexpr int n = G::dim;
    F.setZero();
    F_t.setZero();
    for (int j = 0; j < n; ++j) {
      const Real slope = along(g, Tangent::Unit(j));
      F.col(j).template head<n>() = slope * path.xi_2;
      F(n + 0, j) = F(n + 1, j) = 2 * slope;
      F(n + 4, j) = relax * slope;
    }
    F.col(n + 0).template head<n>() = 2 * path.xi_1;
    F.col(n + 1).template head<n>() = 2 * path.xi_2;
    F.col(n + 4).template head<n>() = path.xi_1;
    F(n + 0, n + 0) = -y[1];
    F(n + 0, n + 1) = -off_0 + share_slope * force;
    F(n + 0, n + 2) = share(y[1]) * omega * omega;
    F(n + 1, n + 1) = -1;
    F(n + 2, n + 3) = 1;
    F(n + 3, n + 0) = 1;
    F(n + 3, n + 1) = -share_slope * force;
    F(n + 3, n + 2) = -(2 + share(y[1])) * omega * omega;
    F(n + 4, n + 0) = -2 * lambda * y[0] * (off_4 - s);
    F(n + 4, n + 4) = -relax;
    const Real s_t = -along(pose(t), twist(t)), psi_t = std::cos(2 * t);
    F_t.template head<n>() = twist_rate(t) + (2 * std::sin(t) - Real(1.5L) * std::cos(3 * t)) * path.xi_1 +
                             (2 * std::exp(-t) + s_t) * path.xi_2;
    F_t[n + 0] = -std::cos(t) - std::sin(t) * y[1] - share(y[1]) * psi_t + 2 * s_t;
    F_t[n + 1] = 2 * s_t;
    F_t[n + 3] = -4 * std::cos(2 * t) / (omega * omega) + (2 + share(y[1])) * psi_t + std::sin(t);
    F_t[n + 4] = Real(-4.5L) * std::sin(3 * t) + relax * (Real(1.5L) * std::cos(3 * t) + s_t);
  }

  /// Distance from the solution; what the spring does counts as its force and the rate of that force.
  Real error(Real t, const G& g, const Vector& found) const {
    Vector off = found - y(t);
    off[2] *= omega * omega;
    off[3] *= omega;
    return std::sqrt((pose(t).inverse() * g).log().squaredNorm() + off.squaredNorm());
  }

 private:
  // not inlined: g++ 12 would take its numbers for uninitialised ones
  [[gnu::noinline]] static ManufacturedMotion<G> path_of_the_pose() { return {}; }
  static Real psi(Real t) { return 1 + std::sin(2 * t) / 2; }
  static Real share(Real y_1) { return std::sin(y_1) / 2; }

  Tangent moved(Real t) const { return G::exp(Tangent(-(t + t * t / 4) * path.xi_2)).adjoint() * path.xi_1; }
  Tangent twist(Real t) const { return std::cos(t) * moved(t) + (1 + t / 2) * path.xi_2; }
  Tangent twist_rate(Real t) const {
    return -std::sin(t) * moved(t) - std::cos(t) * (1 + t / 2) * G::bracket(path.xi_2, moved(t)) +
           path.xi_2 / 2;
  }

  /// w . (p - p*) + u . (R - R*) v: how far a pose is from the path.
  Real astray(Real t, const G& g) const {
    const G at = pose(t);
    return w.dot(g.p() - at.p()) + u.dot((g.R() - at.R()) * v);
  }
  /// Its derivative along a twist in body axes.
  Real along(const G& g, const Tangent& twist) const {
    Vector3 V = Vector3::Zero(), Omega = Vector3::Zero();
    for (int i = 0; i < G::linear_dim; ++i) V[i] = twist[i];
    for (int i = G::linear_dim; i < G::dim; ++i) Omega[3 - G::dim + i] = twist[i];  // in the plane: Z alone
    return w.dot(g.R() * V) + u.dot(g.R() * Omega.cross(v));
  }
};

}  // namespace anholon::testing
