// SPDX-License-Identifier: MIT
#pragma once

// Symmetric 3x3 matrices and the second moment Sigma = integral of X X^T dm, which carries a body's
// rotational inertia with fewer operations than I = tr(Sigma) 1 - Sigma: a mass on a joint's axis has one
// entry in it where I has two.

#include "anholon/spatial.hpp"

namespace anholon {

/// Whether a scalar is zero by its structure: for a number, whether it is zero.
template <class S>
bool vanishes(const S& x) {
  if constexpr (requires { x.is_zero(); }) {
    return x.is_zero();
  } else {
    return x == S(0);
  }
}

/// Symmetric 3x3 matrix, each entry kept once.
template <class S>
struct Symmetric3 {
  Vec3<S> diagonal;
  Vec3<S> mixed;  // yz, zx, xy: entry i stands opposite to axis i

  [[nodiscard]] const S& operator()(int i, int j) const { return i == j ? diagonal[i] : mixed[3 - i - j]; }
  S& operator()(int i, int j) { return i == j ? diagonal[i] : mixed[3 - i - j]; }
  friend Symmetric3 operator+(const Symmetric3& a, const Symmetric3& b) {
    return {a.diagonal + b.diagonal, a.mixed + b.mixed};
  }
  friend Vec3<S> operator*(const Symmetric3& a, const Vec3<S>& v) {
    return {a.diagonal.x * v.x + a.mixed.z * v.y + a.mixed.y * v.z,
            a.mixed.z * v.x + a.diagonal.y * v.y + a.mixed.x * v.z,
            a.mixed.y * v.x + a.mixed.x * v.y + a.diagonal.z * v.z};
  }
  [[nodiscard]] S trace() const { return diagonal.x + diagonal.y + diagonal.z; }
};

/// Sigma of an inertia matrix I, and I of Sigma: the map tr(a)/2 1 - a and its inverse tr(a) 1 - a.
template <class S>
Symmetric3<S> second_moment(const Mat3<S>& I) {
  const S half = S(1) / S(2);
  return {{half * (I(1, 1) + I(2, 2) - I(0, 0)), half * (I(0, 0) + I(2, 2) - I(1, 1)),
           half * (I(0, 0) + I(1, 1) - I(2, 2))},
          {-I(1, 2), -I(0, 2), -I(0, 1)}};
}
template <class S>
Mat3<S> inertia_matrix(const Symmetric3<S>& a) {
  return {{a.diagonal.y + a.diagonal.z, -a.mixed.z, -a.mixed.y, -a.mixed.z, a.diagonal.x + a.diagonal.z,
           -a.mixed.x, -a.mixed.y, -a.mixed.x, a.diagonal.x + a.diagonal.y}};
}

/// R a R^T for the turn R about a coordinate axis, in 16 operations: with k = s (a_ii - a_jj) + 2 c a_ij the
/// turned block is a_ii - s k, a_jj + s k, c k - a_ij, since c^2 + s^2 = 1.
template <class S>
Symmetric3<S> turned(const AxisRotation<S>& R, const Symmetric3<S>& a) {
  const int z = R.axis;
  const int i = (z + 1) % 3;
  const int j = (z + 2) % 3;
  Symmetric3<S> r = a;
  const S k = R.s * (a.diagonal[i] - a.diagonal[j]) + (R.c + R.c) * a.mixed[z];
  r.diagonal[i] = a.diagonal[i] - R.s * k;
  r.diagonal[j] = a.diagonal[j] + R.s * k;
  r.mixed[z] = R.c * k - a.mixed[z];
  // (a_iz, a_jz) turn like a vector; mixed[i] is a_jz, mixed[j] is a_iz
  r.mixed[j] = R.c * a.mixed[j] - R.s * a.mixed[i];
  r.mixed[i] = R.s * a.mixed[j] + R.c * a.mixed[i];
  return r;
}

/// R a R^T for a general matrix a, in 23 operations: of the 2x2 block across the axis, the antisymmetric part
/// and the trace stay.
template <class S>
Mat3<S> turned(const AxisRotation<S>& R, const Mat3<S>& a) {
  const int z = R.axis;
  const int i = (z + 1) % 3;
  const int j = (z + 2) % 3;
  Mat3<S> r = a;
  const S k = R.s * (a(i, i) - a(j, j)) + R.c * (a(i, j) + a(j, i));
  r(i, i) = a(i, i) - R.s * k;
  r(j, j) = a(j, j) + R.s * k;
  r(i, j) = R.c * k - a(j, i);
  r(j, i) = R.c * k - a(i, j);
  r(i, z) = R.c * a(i, z) - R.s * a(j, z);
  r(j, z) = R.s * a(i, z) + R.c * a(j, z);
  r(z, i) = R.c * a(z, i) - R.s * a(z, j);
  r(z, j) = R.s * a(z, i) + R.c * a(z, j);
  return r;
}

/// R = turn * P, where a row of R has a single entry: P permutes the axes in a circle and changes signs.
template <class S>
struct AxisFactors {
  bool exist = false;
  AxisRotation<S> turn;
  int shift = 0;  // axis i of the result is axis i + shift of what P turns
  std::array<S, 3> sign = {S(1), S(1), S(1)};

  explicit AxisFactors(const Mat3<S>& R) {
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3 && !exist; ++col) {
        if (!vanishes(R(row, (col + 1) % 3)) || !vanishes(R(row, (col + 2) % 3))) continue;
        exist = true;
        shift = (col - row + 3) % 3;
        sign[static_cast<std::size_t>(row)] = sign[static_cast<std::size_t>((row + 2) % 3)] = R(row, col);
        turn = {row, R((row + 1) % 3, (col + 1) % 3), R((row + 2) % 3, (col + 1) % 3)};
      }
    }
  }
  /// Entry (i, j) of P a P^T.
  template <class Matrix>
  [[nodiscard]] S permuted(const Matrix& a, int i, int j) const {
    return sign[static_cast<std::size_t>(i)] * a((i + shift) % 3, (j + shift) % 3) *
           sign[static_cast<std::size_t>(j)];
  }
};

/// R a R^T for a constant rotation R.
template <class S>
Symmetric3<S> turned(const Mat3<S>& R, const Symmetric3<S>& a) {
  Symmetric3<S> r;
  if (const AxisFactors<S> factors(R); factors.exist) {
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) r(i, j) = factors.permuted(a, i, j);
    }
    return turned(factors.turn, r);
  }
  for (int j = 0; j < 3; ++j) {
    const Vec3<S> column = a * Vec3<S>{R(j, 0), R(j, 1), R(j, 2)};
    for (int i = 0; i <= j; ++i) r(i, j) = R(i, 0) * column.x + R(i, 1) * column.y + R(i, 2) * column.z;
  }
  return r;
}
template <class S>
Mat3<S> turned(const Mat3<S>& R, const Mat3<S>& a) {
  if (const AxisFactors<S> factors(R); factors.exist) {
    Mat3<S> r;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r(i, j) = factors.permuted(a, i, j);
    }
    return turned(factors.turn, r);
  }
  return R * a * R.transposed();
}

/// Mass, first moment and second moment about a frame's origin, in its axes.
template <class S>
struct MassMoments {
  S mass = S(0);
  Vec3<S> first;
  Symmetric3<S> second;

  friend MassMoments operator+(const MassMoments& a, const MassMoments& b) {
    return {a.mass + b.mass, a.first + b.first, a.second + b.second};
  }
  /// About an origin from which the old one is at p: Sigma + p h^T + (h + m p) p^T. The products p_i h_i
  /// stand alone because a wrench about the new origin needs them too.
  [[nodiscard]] MassMoments moved(const Vec3<S>& p) const {
    MassMoments r = *this;
    const Vec3<S> mp = mass * p;
    r.first = first + mp;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      r.second.diagonal[i] = second.diagonal[i] + (p[i] * first[i] + p[i] * r.first[i]);
      r.second(i, j) = second(i, j) + p[i] * r.first[j] + p[j] * first[i];
    }
    return r;
  }
};

}  // namespace anholon
