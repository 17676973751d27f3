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

namespace {

template <class S>
bool is_zero(const Vec3<S>& v) {
  return vanishes(v.x) && vanishes(v.y) && vanishes(v.z);
}

/// How far the origin of body k goes for its own offset to become short.
template <class S>
Vec3<S> to_shorten_own(const Body<S>& body) {
  Vec3<S> t;
  const Vec3<S> offset = transposed_times(body.R, body.p);
  if (body.kind == JointKind::revolute || body.kind == JointKind::helical) t[body.axis] = -offset[body.axis];
  if (body.kind == JointKind::prismatic) t = -offset;
  return t;
}

/// The same for the offset of its only child.
template <class S>
Vec3<S> to_shorten_child(const Body<S>& body, const Body<S>& child) {
  Vec3<S> t;
  if (body.kind == JointKind::revolute || body.kind == JointKind::helical) t[body.axis] = child.p[body.axis];
  if (body.kind == JointKind::prismatic) t = child.p;
  return t;
}

}  // namespace

template <class S>
int slide_frames(Mechanism<S>& mechanism, SlideTowards towards) {
  require_rigid_tree(mechanism);
  const std::size_t size = mechanism.bodies.size();
  int moved = 0;
  const auto move = [&](std::size_t k, const Vec3<S>& t) {
    if (is_zero(t)) return;
    slide(mechanism, k, t);
    ++moved;
  };
  std::vector<std::vector<std::size_t>> children(size);
  for (std::size_t k = 1; k < size; ++k)
    children[static_cast<std::size_t>(mechanism.bodies[k].parent)].push_back(k);
  if (towards == SlideTowards::base) {
    for (std::size_t k = size; k-- > 1;) {
      if (children[k].size() == 1)
        move(k, to_shorten_child(mechanism.bodies[k], mechanism.bodies[children[k][0]]));
    }
  }
  for (std::size_t k = 1; k < size; ++k) {
    if (towards == SlideTowards::tips || children[k].size() != 1)
      move(k, to_shorten_own(mechanism.bodies[k]));
  }
  return moved;
}

template void slide(Mechanism<Exact>&, std::size_t, const Vec3<Exact>&);
template void slide(Mechanism<Expr>&, std::size_t, const Vec3<Expr>&);
template int slide_frames(Mechanism<Exact>&, SlideTowards);
template int slide_frames(Mechanism<Expr>&, SlideTowards);

}  // namespace anholon
