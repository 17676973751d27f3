// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What passes on a mechanism need to know of its numbers: which are constant, and the moments of a body.

#include <optional>
#include <stdexcept>

#include "anholon/mechanism.hpp"
#include "anholon/second_moment.hpp"
#include "tape/expr.hpp"

namespace anholon {

inline std::optional<Exact> constant_value(const Exact& x) { return x; }
inline std::optional<Exact> constant_value(const Expr& x) { return x.constant_value(); }

/// A constant as a scalar of the same kind as `like`, which has a tape where its kind has one.
inline Exact constant_like(const Exact& /*like*/, const Exact& value) { return value; }
inline Expr constant_like(const Expr& like, const Exact& value) {
  return {*like.tape(), like.tape()->constant(value)};
}

template <class S>
MassMoments<S> moments_of(const Body<S>& b) {
  return {b.mass, b.first_moment, second_moment(b.inertia)};
}
template <class S>
void set_moments(Body<S>& b, const MassMoments<S>& m) {
  b.mass = m.mass;
  b.first_moment = m.first;
  b.inertia = inertia_matrix(m.second);
}

/// Moments in a frame that the body's own is turned by R and moved by p from.
template <class S>
MassMoments<S> moments_in(const Mat3<S>& R, const Vec3<S>& p, const MassMoments<S>& m) {
  return MassMoments<S>{m.mass, R * m.first, turned(R, m.second)}.moved(p);
}

/// @throws std::logic_error where a mechanism has what the passes do not carry along
template <class S>
void require_rigid_tree(const Mechanism<S>& mechanism) {
  if (!mechanism.rows.empty() || !mechanism.wrenches.empty())
    throw std::logic_error("frames that rows or wrenches refer to do not move");
  for (const Body<S>& b : mechanism.bodies) {
    if (!b.modes.empty()) throw std::logic_error("frames of a compliant body do not move");
    if (b.fluid) throw std::logic_error("frames of a body with added mass do not move");
  }
}

}  // namespace anholon
