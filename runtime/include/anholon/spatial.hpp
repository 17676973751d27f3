// SPDX-License-Identifier: MIT
#pragma once

// Three-vectors and 3x3 matrices over any scalar, and rotations about a coordinate axis. They are kept this
// small because a symbolic scalar needs nothing else, and because rotations about one axis are where
// operations are saved.

#include <array>
#include <cstddef>

namespace anholon {

template <class S>
struct Vec3 {
  S x = S(0), y = S(0), z = S(0);

  S& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  const S& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  Vec3& operator-=(const Vec3& b) { return *this = *this - b; }

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(const S& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

template <class S>
S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class S>
Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class S>
Vec3<S> unit(int axis) {
  Vec3<S> e;
  e[axis] = S(1);
  return e;
}

/// Row-major 3x3 matrix.
template <class S>
struct Mat3 {
  std::array<S, 9> m = {S(0), S(0), S(0), S(0), S(0), S(0), S(0), S(0), S(0)};

  static Mat3 identity() {
    Mat3 r;
    r.m[0] = r.m[4] = r.m[8] = S(1);
    return r;
  }
  S& operator()(int i, int j) { return m[static_cast<std::size_t>(3 * i + j)]; }
  const S& operator()(int i, int j) const { return m[static_cast<std::size_t>(3 * i + j)]; }

  friend Vec3<S> operator*(const Mat3& a, const Vec3<S>& v) {
    return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z, a.m[3] * v.x + a.m[4] * v.y + a.m[5] * v.z,
            a.m[6] * v.x + a.m[7] * v.y + a.m[8] * v.z};
  }
  friend Mat3 operator*(const Mat3& a, const Mat3& b) {
    Mat3 r;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
    }
    return r;
  }
  friend Mat3 operator*(const S& s, const Mat3& a) {
    Mat3 r;
    for (std::size_t i = 0; i < 9; ++i) r.m[i] = s * a.m[i];
    return r;
  }
  friend Mat3 operator+(const Mat3& a, const Mat3& b) {
    Mat3 r;
    for (std::size_t i = 0; i < 9; ++i) r.m[i] = a.m[i] + b.m[i];
    return r;
  }
  [[nodiscard]] Mat3 transposed() const {
    Mat3 r;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r(i, j) = (*this)(j, i);
    }
    return r;
  }
};

/// a^T v
template <class S>
Vec3<S> transposed_times(const Mat3<S>& a, const Vec3<S>& v) {
  return {a.m[0] * v.x + a.m[3] * v.y + a.m[6] * v.z, a.m[1] * v.x + a.m[4] * v.y + a.m[7] * v.z,
          a.m[2] * v.x + a.m[5] * v.y + a.m[8] * v.z};
}

/// Matrix of the cross product: skew(a) b = a x b.
template <class S>
Mat3<S> skew(const Vec3<S>& a) {
  return {{S(0), -a.z, a.y, a.z, S(0), -a.x, -a.y, a.x, S(0)}};
}

/// The vector v with v_i = eps_ijk a_jk: turns an integral of p q^T into that of p x q.
template <class S>
Vec3<S> axial(const Mat3<S>& a) {
  return {a(1, 2) - a(2, 1), a(2, 0) - a(0, 2), a(0, 1) - a(1, 0)};
}

/// Rotation by an angle, given as its cosine and sine, about coordinate axis 0, 1 or 2.
template <class S>
struct AxisRotation {
  int axis = 2;
  S c = S(1), s = S(0);

  /// Components in the unrotated frame of a vector given in the rotated one.
  [[nodiscard]] Vec3<S> apply(const Vec3<S>& v) const {
    const int i = (axis + 1) % 3;
    const int j = (axis + 2) % 3;
    Vec3<S> r = v;
    r[i] = c * v[i] - s * v[j];
    r[j] = s * v[i] + c * v[j];
    return r;
  }
  /// Components in the rotated frame of a vector given in the unrotated one.
  [[nodiscard]] Vec3<S> apply_inverse(const Vec3<S>& v) const {
    const int i = (axis + 1) % 3;
    const int j = (axis + 2) % 3;
    Vec3<S> r = v;
    r[i] = c * v[i] + s * v[j];
    r[j] = c * v[j] - s * v[i];
    return r;
  }
  [[nodiscard]] Mat3<S> matrix() const {
    Mat3<S> r;
    for (int k = 0; k < 3; ++k) {
      const Vec3<S> column = apply(unit<S>(k));
      for (int i = 0; i < 3; ++i) r(i, k) = column[i];
    }
    return r;
  }
};

/// Linear part first, in the axes of the frame that its name says.
template <class S>
struct Spatial {
  Vec3<S> linear, angular;
  S& operator[](int i) { return i < 3 ? linear[i] : angular[i - 3]; }
  const S& operator[](int i) const { return i < 3 ? linear[i] : angular[i - 3]; }
};

}  // namespace anholon
