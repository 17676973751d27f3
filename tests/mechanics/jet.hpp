// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Motions as truncated Taylor series in time, and poses made of them. The tests of mechanics write a robot's
// positions down with homogeneous transforms over these numbers; velocities and accelerations then follow
// without any formula of mechanics. Nothing here shares code with the recursion.

#include <array>
#include <cmath>
#include <vector>

namespace anholon::test {

using Real = long double;

/// Value, first and second time derivative.
struct Jet {
  Real x = 0, d = 0, dd = 0;
  Jet() = default;
  Jet(Real value) : x(value) {}  // NOLINT: constants are meant to mix with motions
  Jet(Real value, Real first, Real second) : x(value), d(first), dd(second) {}

  friend Jet operator+(const Jet& a, const Jet& b) { return {a.x + b.x, a.d + b.d, a.dd + b.dd}; }
  friend Jet operator-(const Jet& a, const Jet& b) { return {a.x - b.x, a.d - b.d, a.dd - b.dd}; }
  friend Jet operator-(const Jet& a) { return {-a.x, -a.d, -a.dd}; }
  friend Jet operator*(const Jet& a, const Jet& b) {
    return {a.x * b.x, a.d * b.x + a.x * b.d, a.dd * b.x + 2 * a.d * b.d + a.x * b.dd};
  }
  Jet& operator+=(const Jet& b) { return *this = *this + b; }
};

/// f(a) from the value and the first two derivatives of f.
inline Jet chain(const Jet& a, Real f, Real f1, Real f2) { return {f, f1 * a.d, f2 * a.d * a.d + f1 * a.dd}; }
inline Jet sin(const Jet& a) { return chain(a, std::sin(a.x), std::cos(a.x), -std::sin(a.x)); }
inline Jet cos(const Jet& a) { return chain(a, std::cos(a.x), -std::sin(a.x), -std::cos(a.x)); }
inline Jet exp(const Jet& a) { return chain(a, std::exp(a.x), std::exp(a.x), std::exp(a.x)); }

struct Vector {
  std::array<Jet, 3> c;
  Vector() = default;
  Vector(Jet x, Jet y, Jet z) : c{x, y, z} {}
  Jet& operator[](std::size_t i) { return c[i]; }
  const Jet& operator[](std::size_t i) const { return c[i]; }
  friend Vector operator+(const Vector& a, const Vector& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  }
  friend Vector operator*(const Jet& s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
};

/// Homogeneous transform.
struct Pose {
  std::array<std::array<Jet, 3>, 3> R = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vector p;

  friend Vector operator*(const Pose& g, const Vector& v) {
    Vector r = g.p;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) r[i] += g.R[i][j] * v[j];
    }
    return r;
  }
  friend Pose operator*(const Pose& a, const Pose& b) {
    Pose r;
    r.p = a * b.p;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        r.R[i][j] = 0;
        for (std::size_t k = 0; k < 3; ++k) r.R[i][j] += a.R[i][k] * b.R[k][j];
      }
    }
    return r;
  }
};

inline Pose moved(const Vector& by) {
  Pose g;
  g.p = by;
  return g;
}

/// Turn about a unit vector, by the formula of Rodrigues.
inline Pose turned(const std::array<Real, 3>& axis, const Jet& angle) {
  const Jet c = cos(angle);
  const Jet s = sin(angle);
  Pose g;
  for (std::size_t i = 0; i < 3; ++i) {  // cos 1 + (1 - cos) a a^T + sin [a]
    for (std::size_t j = 0; j < 3; ++j)
      g.R[i][j] = (Jet(1) - c) * Jet(axis[i] * axis[j]) + (i == j ? c : Jet(0));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    g.R[k][j] += s * Jet(axis[i]);
    g.R[j][k] += -(s * Jet(axis[i]));
  }
  return g;
}

/// R_dot R^T as a vector: angular velocity in the world.
inline std::array<Real, 3> angular_velocity(const Pose& g) {
  std::array<Real, 3> w{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    for (std::size_t c = 0; c < 3; ++c) w[i] += (g.R[k][c].d * g.R[j][c].x - g.R[j][c].d * g.R[k][c].x) / 2;
  }
  return w;
}

/// Its derivative: the skew part of R_ddot R^T.
inline std::array<Real, 3> angular_acceleration(const Pose& g) {
  std::array<Real, 3> w{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    for (std::size_t c = 0; c < 3; ++c) w[i] += (g.R[k][c].dd * g.R[j][c].x - g.R[j][c].dd * g.R[k][c].x) / 2;
  }
  return w;
}

}  // namespace anholon::test
