// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Equations of motion from a Lagrangian that is written down as a function of position and velocity, by
// automatic differentiation with hyper-dual numbers: for energies that are not those of mass points, such as
// truncated ones. The reference body's pose has a chart g = g_0 (x, R_x(x_4) R_y(x_5) R_z(x_6)) around the
// state, so that the equations of Lagrange hold without any theorem on quasi-velocities.

#include <cmath>
#include <functional>
#include <vector>

#include "anholon/spatial.hpp"
#include "mechanics/jet.hpp"

namespace anholon::test {

/// a + b e + c f + d e f with e^2 = f^2 = 0.
struct Hyper {
  Real a = 0, b = 0, c = 0, d = 0;
  Hyper() = default;
  Hyper(Real value) : a(value) {}  // NOLINT: constants mix with variables
  Hyper(Real a_, Real b_, Real c_, Real d_) : a(a_), b(b_), c(c_), d(d_) {}
  friend Hyper operator+(const Hyper& x, const Hyper& y) {
    return {x.a + y.a, x.b + y.b, x.c + y.c, x.d + y.d};
  }
  friend Hyper operator-(const Hyper& x, const Hyper& y) {
    return {x.a - y.a, x.b - y.b, x.c - y.c, x.d - y.d};
  }
  friend Hyper operator-(const Hyper& x) { return {-x.a, -x.b, -x.c, -x.d}; }
  friend Hyper operator*(const Hyper& x, const Hyper& y) {
    return {x.a * y.a, x.a * y.b + x.b * y.a, x.a * y.c + x.c * y.a,
            x.a * y.d + x.b * y.c + x.c * y.b + x.d * y.a};
  }
};

inline Hyper chain(const Hyper& x, Real f, Real f1, Real f2) {
  return {f, f1 * x.b, f1 * x.c, f1 * x.d + f2 * x.b * x.c};
}
inline Hyper sin(const Hyper& x) { return chain(x, std::sin(x.a), std::cos(x.a), -std::sin(x.a)); }
inline Hyper cos(const Hyper& x) { return chain(x, std::cos(x.a), -std::sin(x.a), -std::cos(x.a)); }
inline Hyper sqrt(const Hyper& x) {
  const Real r = std::sqrt(x.a);
  return chain(x, r, 1 / (2 * r), -1 / (4 * r * x.a));
}
inline Hyper inverse(const Hyper& x) { return chain(x, 1 / x.a, -1 / (x.a * x.a), 2 / (x.a * x.a * x.a)); }

/// A quantity with its time derivative.
struct Moving {
  Hyper x, d;
  Moving() = default;
  Moving(Real value) : x(value) {}                    // NOLINT: constants mix with motions
  Moving(int value) : x(static_cast<Real>(value)) {}  // NOLINT: generic code writes S(0)
  Moving(const Hyper& value, const Hyper& rate) : x(value), d(rate) {}
  friend Moving operator+(const Moving& a, const Moving& b) { return {a.x + b.x, a.d + b.d}; }
  friend Moving operator-(const Moving& a, const Moving& b) { return {a.x - b.x, a.d - b.d}; }
  friend Moving operator-(const Moving& a) { return {-a.x, -a.d}; }
  friend Moving operator*(const Moving& a, const Moving& b) { return {a.x * b.x, a.d * b.x + a.x * b.d}; }
};
inline Moving sin(const Moving& a) { return {sin(a.x), cos(a.x) * a.d}; }
inline Moving cos(const Moving& a) { return {cos(a.x), -(sin(a.x) * a.d)}; }
inline Moving sqrt(const Moving& a) {
  const Hyper r = sqrt(a.x);
  return {r, a.d * inverse(r + r)};
}
inline Moving inverse(const Moving& a) {
  const Hyper r = inverse(a.x);
  return {r, -(a.d * r * r)};
}

struct Frame {
  Mat3<Moving> R = Mat3<Moving>::identity();
  Vec3<Moving> p;
  friend Frame operator*(const Frame& a, const Frame& b) { return {a.R * b.R, a.p + a.R * b.p}; }
};
inline Frame moved_by(const Vec3<Moving>& p) { return {Mat3<Moving>::identity(), p}; }

/// Turn by a rotation vector other than zero.
inline Frame turned_by(const Vec3<Moving>& theta) {
  const Moving square = dot(theta, theta);
  const Moving angle = sqrt(square);
  const Mat3<Moving> K = skew(theta);
  Frame g;
  g.R = g.R + sin(angle) * inverse(angle) * K + (Moving(1) - cos(angle)) * inverse(square) * (K * K);
  return g;
}
inline Frame turned_about(const Vec3<Moving>& axis, const Moving& angle) {
  const Mat3<Moving> K = skew(axis);
  Frame g;
  g.R = g.R + sin(angle) * K + (Moving(1) - cos(angle)) * (K * K);
  return g;
}

/// T - V of a robot whose reference body is at g and whose coordinates are r.
using Lagrangian = std::function<Hyper(const Frame& g, const std::vector<Moving>& r)>;

struct LagrangianDynamics {
  std::vector<std::vector<Real>> M;  // of (eta, r_dot)
  std::vector<Real> force;           // (f, Q)
};

/// @param R, p  pose of the reference body; eta, r, r_dot as in State
inline LagrangianDynamics dynamics_of(const Lagrangian& lagrangian, const Mat3<Real>& R0,
                                      const std::array<Real, 3>& p0, const std::array<Real, 6>& eta,
                                      const std::vector<Real>& r, const std::vector<Real>& r_dot) {
  const std::size_t n = 6 + r.size();
  std::vector<Real> x(n, 0), v(eta.begin(), eta.end());
  for (std::size_t i = 0; i < r.size(); ++i) x[6 + i] = r[i];
  v.insert(v.end(), r_dot.begin(), r_dot.end());
  const auto at = [&](const std::vector<Moving>& q) {
    Frame origin;
    for (std::size_t i = 0; i < 9; ++i) origin.R.m[i] = Moving(R0.m[i]);
    origin.p = {Moving(p0[0]), Moving(p0[1]), Moving(p0[2])};
    Frame g = origin * moved_by({q[0], q[1], q[2]});
    for (int axis = 0; axis < 3; ++axis)
      g = g * turned_about(unit<Moving>(axis), q[static_cast<std::size_t>(3 + axis)]);
    return lagrangian(g, std::vector<Moving>(q.begin() + 6, q.end()));
  };
  const auto state = [&](const std::vector<Hyper>& dx, const std::vector<Hyper>& dv) {
    std::vector<Moving> q;
    for (std::size_t i = 0; i < n; ++i) q.emplace_back(Hyper(x[i]) + dx[i], Hyper(v[i]) + dv[i]);
    return at(q);
  };
  const std::vector<Hyper> none(n, Hyper(0));
  LagrangianDynamics result;
  result.M.assign(n, std::vector<Real>(n, 0));
  result.force.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<Hyper> e = none, along = none;
    e[i].b = 1;
    for (std::size_t k = 0; k < n; ++k) along[k].c = v[k];
    result.force[i] = state(e, none).b - state(along, e).d;  // dL/dx - (d/dx dL/dv) v
    for (std::size_t j = 0; j <= i; ++j) {
      std::vector<Hyper> both = none;
      both[i].b = 1;
      both[j].c = 1;
      result.M[i][j] = result.M[j][i] = state(none, both).d;
    }
  }
  // At constant rates of the chart the twist changes: V = R(x)^T x_dot gives V_dot = V x Omega, and the turns
  // are about axes that those before have moved.
  const std::array<Real, 6> drift = {eta[1] * eta[5] - eta[2] * eta[4],
                                     eta[2] * eta[3] - eta[0] * eta[5],
                                     eta[0] * eta[4] - eta[1] * eta[3],
                                     eta[4] * eta[5],
                                     -(eta[3] * eta[5]),
                                     eta[3] * eta[4]};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < 6; ++j) result.force[i] += result.M[i][j] * drift[j];
  }
  return result;
}

}  // namespace anholon::test
