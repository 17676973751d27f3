// SPDX-License-Identifier: MIT
#pragma once

// The mass matrix by composite rigid bodies, Walker and Orin 1982 (Featherstone 2008, Table 6.2), with the
// second moment in place of the inertia matrix and turns about coordinate axes as one step
// (second_moment.hpp).

#include <vector>

#include "anholon/matrix.hpp"
#include "anholon/rigid_tree.hpp"

namespace anholon {

/// Moments of each body with all that hangs on it, about its origin. Needs position().
template <class S>
std::vector<MassMoments<S>> composite_moments(const RigidTree<S>& tree) {
  std::vector<MassMoments<S>> composite;
  for (std::size_t k = 0; k < tree.size(); ++k) composite.push_back(tree.moments(k));
  for (std::size_t k = tree.size(); k-- > 1;) {
    tree.mechanism().section(tree.body(k).name + ": composite body");
    const JointTransform<S>& joint = tree.joint(k);
    const MassMoments<S>& own = composite[k];
    const MassMoments<S> turned_moments{own.mass, joint.to_parent(own.first),
                                        turned(joint.R, turned(joint.rotation, own.second))};
    MassMoments<S>& parent = composite[tree.parent_of(k)];
    parent = turned_moments.moved(joint.offset) + parent;
  }
  return composite;
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
  const std::vector<MassMoments<S>> composite = composite_moments(tree);
  for (std::size_t k = 1; k < tree.size(); ++k) {
    if (!tree.moves(k)) continue;
    mechanism.section(tree.body(k).name + ": mass matrix");
    const Spatial<S> s = joint_axis(tree.body(k));
    Spatial<S> f = inertial_wrench(composite[k], s.linear, s.angular);
    for (std::size_t i = k; i > 0; i = tree.parent_of(i)) {
      const S entry = tree.joint_force(tree.body(i), f);
      tree.for_each_share(k, [&](int ck, const S& share_k) {
        tree.for_each_share(i, [&](int ci, const S& share_i) {
          const S x = share_k * share_i * entry;
          M(n + ck, n + ci) = M(n + ck, n + ci) + x;
          if (i != k) M(n + ci, n + ck) = M(n + ci, n + ck) + x;
        });
      });
      f = tree.joint(i).to_parent(f);
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
    const Spatial<S> f = inertial_wrench(composite[0], e.linear, e.angular);
    for (int i = 0; i <= c; ++i) M(c, i) = M(i, c) = f[base[static_cast<std::size_t>(i)]];
  }
  return M;
}

}  // namespace anholon
