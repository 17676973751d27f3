// SPDX-License-Identifier: MIT
#pragma once

// The mass matrix by composite rigid bodies, Walker and Orin 1982 (Featherstone 2008, Table 6.2), with three
// savings: the second moment in place of the inertia matrix and turns about coordinate axes as one step
// (second_moment.hpp); joints that are parallel to their parent's joint turn by the sum of the angles and
// share its axes (joint_frames.hpp), so that no quantity is turned twice about the same axis; and the trace
// across a joint's axis, which turns do not change, is carried along them.

#include <vector>

#include "anholon/joint_frames.hpp"
#include "anholon/matrix.hpp"

namespace anholon {

/// Each body with all that hangs on it.
template <class S>
struct CompositeBodies {
  MassMoments<S> whole;                // about the reference body's origin, in its axes
  std::vector<MassMoments<S>> joined;  // per body but the first: about its origin, in its joint frame
  std::vector<S> about_axis;           // inertia about the body's coordinate axis Body::axis
};

/// Moments of the composite bodies. With u = p . h across the axis, the inertia about an axis grows by 2 u +
/// m p^2 when the axis moves by p: the first u is also what the child's wrench needs there.
template <class S>
CompositeBodies<S> composite_bodies(const RigidTree<S>& tree, const JointFrames<S>& frames) {
  std::vector<MassMoments<S>> in_body;  // own moments and those of children that are not parallel
  for (std::size_t k = 0; k < tree.size(); ++k) in_body.push_back(tree.moments(k));
  CompositeBodies<S> result{{}, std::vector<MassMoments<S>>(tree.size()), std::vector<S>(tree.size(), S(0))};
  for (std::size_t k = tree.size(); k-- > 1;) {
    tree.mechanism().section(tree.body(k).name + ": composite body");
    const int x = (tree.body(k).axis + 1) % 3;
    const int y = (tree.body(k).axis + 2) % 3;
    const MassMoments<S>& own = in_body[k];
    MassMoments<S>& joined = result.joined[k];  // holds the parallel children
    result.about_axis[k] = (own.second(x, x) + own.second(y, y)) + result.about_axis[k];
    joined = MassMoments<S>{own.mass, frames.turn(k).apply(own.first), turned(frames.turn(k), own.second)} +
             joined;
    const std::size_t parent = tree.parent_of(k);
    const Vec3<S>& p = frames.offset(k);
    if (frames.is_parallel(k)) {
      const MassMoments<S> moved = joined.moved(p);
      const S here = p[x] * joined.first[x] + p[y] * joined.first[y];
      const S there = p[x] * moved.first[x] + p[y] * moved.first[y];
      result.about_axis[parent] = result.about_axis[parent] + ((result.about_axis[k] + here) + there);
      result.joined[parent] = result.joined[parent] + moved;
    } else {
      const Mat3<S>& R = tree.body(k).R;
      const MassMoments<S> in_parent{joined.mass, R * joined.first, turned(R, joined.second)};
      in_body[parent] = in_parent.moved(p) + in_body[parent];
    }
  }
  result.whole = in_body[0];
  return result;
}

/// Wrench about its origin that a body of these moments needs for the angular acceleration wd and
/// acceleration a.
template <class S>
Spatial<S> inertial_wrench(const MassMoments<S>& b, const Vec3<S>& a, const Vec3<S>& wd) {
  const Vec3<S> N = inertia_matrix(b.second) * wd;
  return {b.mass * a + cross(wd, b.first), cross(b.first, a) + N};
}

/// Unit acceleration of a joint in its body's frame: (a, wd).
template <class S>
Spatial<S> joint_axis(const Body<S>& b) {
  Spatial<S> s;
  if (b.kind == JointKind::revolute || b.kind == JointKind::helical) s.angular[b.axis] = S(1);
  if (b.kind == JointKind::prismatic) s.linear[b.axis] = S(1);
  if (b.kind == JointKind::helical) s.linear[b.axis] = b.pitch;
  return s;
}

/// Mass matrix in the order (free components of the reference body's twist, coordinates). Needs position().
template <class S>
Matrix<S> composite_mass_matrix(const RigidTree<S>& tree) {
  const Mechanism<S>& mechanism = tree.mechanism();
  const auto base = free_components(mechanism.group);
  const int n = static_cast<int>(base.size());
  Matrix<S> M(n + mechanism.coordinates, n + mechanism.coordinates);
  const JointFrames<S> frames(tree);
  const CompositeBodies<S> composite = composite_bodies(tree, frames);
  for (std::size_t k = 1; k < tree.size(); ++k) {
    if (!tree.moves(k)) continue;
    const Body<S>& body = tree.body(k);
    mechanism.section(body.name + ": mass matrix");
    const Spatial<S> s = joint_axis(body);
    Spatial<S> f = inertial_wrench(composite.joined[k], s.linear, s.angular);
    if (body.kind == JointKind::revolute) f.angular[body.axis] = composite.about_axis[k];
    for (std::size_t i = k; i > 0; i = tree.parent_of(i)) {
      S entry = tree.joint_force(tree.body(i), f);
      if (i == k && !vanishes(body.armature)) entry = entry + body.armature;
      tree.for_each_share(k, [&](int ck, const S& share_k) {
        tree.for_each_share(i, [&](int ci, const S& share_i) {
          const S x = share_k * share_i * entry;
          M(n + ck, n + ci) = M(n + ck, n + ci) + x;
          if (i != k) M(n + ci, n + ck) = M(n + ci, n + ck) + x;
        });
      });
      f = frames.to_parent(i, f);
    }
    tree.for_each_share(k, [&](int ck, const S& share) {
      for (int c = 0; c < n; ++c) {
        const S x = M(n + ck, c) + share * f[base[static_cast<std::size_t>(c)]];
        M(n + ck, c) = M(c, n + ck) = x;
      }
    });
  }
  for (int c = 0; c < n; ++c) {
    Spatial<S> e;
    e[base[static_cast<std::size_t>(c)]] = S(1);
    const Spatial<S> f = inertial_wrench(composite.whole, e.linear, e.angular);
    for (int i = 0; i <= c; ++i) M(c, i) = M(i, c) = f[base[static_cast<std::size_t>(i)]];
  }
  return M;
}

}  // namespace anholon
