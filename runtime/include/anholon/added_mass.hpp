// SPDX-License-Identifier: MIT
#pragma once

// What an ideal fluid, at rest far away, adds to a rigid body that moves in it: the kinetic energy
//
//   T = v . A v/2 + v . B w + w . C w/2
//
// of the twist (v, w) of the body's frame, and the weight of the fluid that the body displaces. Its impulses
// p = A v + B w and h = B^T v + C w obey Kirchhoff's equations (Lamb, Hydrodynamics, 6th ed., art. 124):
//
//   force = p_dot + w x p,   moment = h_dot + w x h + v x p

#include "anholon/second_moment.hpp"
#include "anholon/spatial.hpp"

namespace anholon {

template <class S>
struct AddedMass {
  Symmetric3<S> A;           // kg
  Mat3<S> B;                 // kg m
  Symmetric3<S> C;           // kg m^2
  S displaced = S(0);        // mass of the fluid displaced, kg
  Vec3<S> displaced_moment;  // displaced mass times centre of buoyancy, kg m

  friend AddedMass operator+(const AddedMass& a, const AddedMass& b) {
    return {a.A + b.A, a.B + b.B, a.C + b.C, a.displaced + b.displaced,
            a.displaced_moment + b.displaced_moment};
  }

  /// (p, h) of a twist (v, w), or their rates at a fixed pose from those of the twist's components.
  [[nodiscard]] Spatial<S> impulse(const Vec3<S>& v, const Vec3<S>& w) const {
    return {A * v + B * w, transposed_times(B, v) + C * w};
  }

  /// The same in a frame in which this one is turned by R.
  [[nodiscard]] AddedMass turned_by(const Mat3<S>& R) const {
    return {turned(R, A), turned(R, B), turned(R, C), displaced, R * displaced_moment};
  }

  /// The same about an origin from which this one's is at p. There v = v' + w x p = v' - [p] w, so that
  /// B' = B - A [p] and C' = C + [p] B' + ([p] B)^T.
  [[nodiscard]] AddedMass moved(const Vec3<S>& p) const {
    AddedMass r = *this;
    const Mat3<S> P = skew(p);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        r.B(i, j) = B(i, j) - (A(i, 0) * P(0, j) + A(i, 1) * P(1, j) + A(i, 2) * P(2, j));
    }
    const Mat3<S> after = P * r.B;
    const Mat3<S> before = P * B;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) r.C(i, j) = C(i, j) + (after(i, j) + before(j, i));
    }
    r.displaced_moment = displaced_moment + displaced * p;
    return r;
  }
};

}  // namespace anholon
