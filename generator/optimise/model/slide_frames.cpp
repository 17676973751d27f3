// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/model/slide_frames.hpp"

#include "optimise/model/constants.hpp"

namespace anholon {

template <class S>
void slide(Mechanism<S>& mechanism, std::size_t k, const Vec3<S>& t) {
  Body<S>& body = mechanism.bodies[k];
  body.p += body.R * t;
  set_moments(body, moments_of(body).moved(-t));
  for (Body<S>& child : mechanism.bodies) {
    if (child.parent == static_cast<int>(k)) child.p -= t;
  }
}

template <class S>
int slide_frames(Mechanism<S>& mechanism) {
  require_rigid_tree(mechanism);
  int moved = 0;
  for (std::size_t k = 1; k < mechanism.bodies.size(); ++k) {
    const Body<S>& body = mechanism.bodies[k];
    Vec3<S> t;  // takes the offset's component along the axis away, or all of it
    const Vec3<S> offset = transposed_times(body.R, body.p);
    if (body.kind == JointKind::revolute || body.kind == JointKind::helical) t[body.axis] = -offset[body.axis];
    if (body.kind == JointKind::prismatic) t = -offset;
    if (vanishes(t.x) && vanishes(t.y) && vanishes(t.z)) continue;
    slide(mechanism, k, t);
    ++moved;
  }
  return moved;
}

template void slide(Mechanism<Exact>&, std::size_t, const Vec3<Exact>&);
template void slide(Mechanism<Expr>&, std::size_t, const Vec3<Expr>&);
template int slide_frames(Mechanism<Exact>&);
template int slide_frames(Mechanism<Expr>&);

}  // namespace anholon
