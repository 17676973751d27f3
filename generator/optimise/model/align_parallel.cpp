// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/model/align_parallel.hpp"

#include "optimise/model/constants.hpp"

namespace anholon {

template <class S>
void take_axes_of_parent(Mechanism<S>& mechanism, std::size_t k) {
  Body<S>& body = mechanism.bodies[k];
  const Mat3<S> R = body.R;
  const Vec3<S> n = R * unit<S>(body.axis);
  for (int i = 0; i < 3; ++i) {
    if (vanishes(n[i] - S(1))) body.axis = i;
  }
  set_moments(body, moments_in(R, Vec3<S>{}, moments_of(body)));
  body.R_frame = R * body.R_frame;
  body.R = Mat3<S>::identity();
  for (Body<S>& child : mechanism.bodies) {
    if (child.parent != static_cast<int>(k)) continue;
    child.R = R * child.R;
    child.p = R * child.p;
  }
}

namespace {

template <class S>
bool is_quarter_turns(const Mat3<S>& R) {
  for (const S& entry : R.m) {
    if (!vanishes(entry) && !vanishes(entry * entry - S(1))) return false;
  }
  return true;
}

template <class S>
bool is_identity(const Mat3<S>& R) {
  return is_quarter_turns(R) && vanishes(R(0, 0) - S(1)) && vanishes(R(1, 1) - S(1)) &&
         vanishes(R(2, 2) - S(1));
}

}  // namespace

template <class S>
int align_parallel(Mechanism<S>& mechanism) {
  require_rigid_tree(mechanism);
  int changed = 0;
  for (std::size_t k = 1; k < mechanism.bodies.size(); ++k) {
    const Body<S>& body = mechanism.bodies[k];
    const Body<S>& parent = mechanism.bodies[static_cast<std::size_t>(body.parent)];
    if (body.parent == 0 || body.kind != JointKind::revolute || parent.kind != JointKind::revolute) continue;
    if (is_identity(body.R) || !is_quarter_turns(body.R)) continue;
    if (!vanishes(body.R(parent.axis, body.axis) - S(1))) continue;
    take_axes_of_parent(mechanism, k);
    ++changed;
  }
  return changed;
}

template void take_axes_of_parent(Mechanism<Exact>&, std::size_t);
template void take_axes_of_parent(Mechanism<Expr>&, std::size_t);
template int align_parallel(Mechanism<Exact>&);
template int align_parallel(Mechanism<Expr>&);

}  // namespace anholon
