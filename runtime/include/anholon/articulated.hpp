// SPDX-License-Identifier: MIT
#pragma once

// Forward dynamics by articulated bodies, Featherstone 2008, Table 7.1, in body frames. The
// velocity-dependent terms come from a pass of the Newton-Euler recursion without joint accelerations, so
// that the articulated bodies carry no bias accelerations. The reference body moves as its group allows: its
// own acceleration minus gravity is an unknown, so gravity never enters.

#include <vector>

#include "anholon/composite.hpp"
#include "anholon/factor.hpp"

namespace anholon {

/// [f; N] = [M H; H^T I] [a; wd] about the body's origin.
template <class S>
struct ArticulatedInertia {
  Symmetric3<S> M;
  Mat3<S> H;
  Symmetric3<S> I;

  /// About an origin from which the old one is at p.
  [[nodiscard]] ArticulatedInertia moved(const Vec3<S>& p) const {
    ArticulatedInertia r = *this;
    const auto row = [](const auto& m, int i) { return Vec3<S>{m(i, 0), m(i, 1), m(i, 2)}; };
    for (int i = 0; i < 3; ++i) {  // H' = H - M [p]: rows of M [p] are (row x p)
      const Vec3<S> turned_row = cross(row(M, i), p);
      for (int j = 0; j < 3; ++j) r.H(i, j) = H(i, j) - turned_row[j];
    }
    for (int i = 0; i < 3; ++i) {  // I' = I - H^T [p] + [p] H'
      const Vec3<S> right = cross(Vec3<S>{H(0, i), H(1, i), H(2, i)}, p);
      for (int j = i; j < 3; ++j) {
        const Vec3<S> left = cross(p, Vec3<S>{r.H(0, j), r.H(1, j), r.H(2, j)});
        r.I(i, j) = I(i, j) - right[j] + left[i];
      }
    }
    return r;
  }
};

template <class S>
ArticulatedInertia<S> articulated(const MassMoments<S>& b) {
  ArticulatedInertia<S> r;
  r.M.diagonal = {b.mass, b.mass, b.mass};
  r.H = skew(-b.first);
  const Mat3<S> I = inertia_matrix(b.second);
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) r.I(i, j) = I(i, j);
  }
  return r;
}

template <class S>
ArticulatedInertia<S> operator+(const ArticulatedInertia<S>& a, const ArticulatedInertia<S>& b) {
  return {a.M + b.M, a.H + b.H, a.I + b.I};
}

/// What is left of an articulated inertia when its joint gives way: IA - U U^T / d with U = IA S and d = S^T
/// U + armature.
template <class S>
struct ReleasedJoint {
  Spatial<S> W;  // U / d; S^T W = 1 where there is no armature
  S inverse_d = S(0);
  ArticulatedInertia<S> rest;
};

template <class S>
ReleasedJoint<S> release(const Body<S>& b, const ArticulatedInertia<S>& A) {
  ReleasedJoint<S> r;
  const int z = b.axis;
  Spatial<S> U;
  const bool pure = b.kind != JointKind::helical;
  for (int i = 0; i < 3; ++i) {
    if (b.kind != JointKind::prismatic) U.linear[i] = A.H(i, z), U.angular[i] = A.I(i, z);
    if (b.kind == JointKind::prismatic) U.linear[i] = A.M(i, z), U.angular[i] = A.H(z, i);
    if (!pure)
      U.linear[i] = U.linear[i] + b.pitch * A.M(i, z), U.angular[i] = U.angular[i] + b.pitch * A.H(z, i);
  }
  const bool bare = pure && vanishes(b.armature);  // nothing is left along the joint's own axis
  S d = RigidTree<S>::joint_force(b, U);
  if (!vanishes(b.armature)) d = d + b.armature;
  r.inverse_d = S(1) / d;
  const int own = b.kind == JointKind::prismatic ? z : 3 + z;
  for (int i = 0; i < 6; ++i) r.W[i] = bare && i == own ? S(1) : r.inverse_d * U[i];
  const auto rest = [&](const S& x, int i, int j) {
    return bare && (i == own || j == own) ? S(0) : x - U[i] * r.W[j];
  };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r.rest.H(i, j) = rest(A.H(i, j), i, 3 + j);
    for (int j = i; j < 3; ++j) {
      r.rest.M(i, j) = rest(A.M(i, j), i, j);
      r.rest.I(i, j) = rest(A.I(i, j), 3 + i, 3 + j);
    }
  }
  return r;
}

/// Acceleration of a body and of the coordinates.
template <class S>
struct TreeAcceleration {
  Spatial<S> base;  // (a, wd) of the reference body, the former minus gravity where it is free
  std::vector<S> r_ddot;
};

/// Whether every joint that moves has a coordinate of its own. Needs position().
template <class S>
bool joints_are_independent(const RigidTree<S>& tree) {
  std::vector<char> taken(static_cast<std::size_t>(tree.mechanism().coordinates), 0);
  for (std::size_t k = 1; k < tree.size(); ++k) {
    if (!tree.moves(k)) continue;
    const int c = tree.own_coordinate(k);
    if (c < 0 || taken[static_cast<std::size_t>(c)] != 0) return false;
    taken[static_cast<std::size_t>(c)] = 1;
  }
  return true;
}

/// Accelerations that joint forces and the wrenches of the motion at hand leave. Needs position() and move()
/// with zero accelerations of the coordinates and, for a free reference body, of its frame.
/// @param force  (coordinates) applied generalised forces
/// Every joint must have a coordinate of its own (joints_are_independent).
template <class S>
TreeAcceleration<S> articulated_acceleration(const RigidTree<S>& tree, const std::vector<S>& force) {
  const Mechanism<S>& mechanism = tree.mechanism();
  const std::size_t size = tree.size();
  std::vector<ArticulatedInertia<S>> A;
  std::vector<Spatial<S>> p;
  for (std::size_t k = 0; k < size; ++k) {
    mechanism.section(tree.body(k).name + ": wrench");
    A.push_back(articulated(tree.moments(k)));
    p.push_back(tree.body_wrench(k));
  }
  std::vector<ReleasedJoint<S>> joint(size);
  std::vector<S> own(size, S(0));  // acceleration of the joint if its parent stood still
  for (std::size_t k = size; k-- > 1;) {
    const Body<S>& b = tree.body(k);
    mechanism.section(b.name + ": articulated body");
    if (b.kind == JointKind::fixed) {
      joint[k].rest = A[k];
    } else {
      joint[k] = release(b, A[k]);
      const S tau = force[static_cast<std::size_t>(tree.own_coordinate(k))];
      const S u = tau - tree.joint_force(b, p[k]);
      own[k] = joint[k].inverse_d * u;
      for (int i = 0; i < 6; ++i) p[k][i] = p[k][i] + joint[k].W[i] * u;
      if (vanishes(b.armature)) {  // S^T W = 1
        if (b.kind == JointKind::revolute) p[k].angular[b.axis] = tau;
        if (b.kind == JointKind::prismatic) p[k].linear[b.axis] = tau;
      }
    }
    const JointTransform<S>& x = tree.joint(k);
    const ArticulatedInertia<S>& rest = joint[k].rest;
    const ArticulatedInertia<S> turned_rest{turned(x.R, turned(x.rotation, rest.M)),
                                            turned(x.R, turned(x.rotation, rest.H)),
                                            turned(x.R, turned(x.rotation, rest.I))};
    const std::size_t parent = tree.parent_of(k);
    A[parent] = A[parent] + turned_rest.moved(x.offset);
    const Spatial<S> f = x.to_parent(p[k]);
    p[parent].linear += f.linear;
    p[parent].angular += f.angular;
  }

  TreeAcceleration<S> result;
  const auto free = free_components(mechanism.group);
  const int n = static_cast<int>(free.size());
  if (n > 0) {
    mechanism.section(tree.body(0).name + ": acceleration");
    Matrix<S> M(n, n);
    std::vector<S> f;
    for (int i = 0; i < n; ++i) {
      const int ci = free[static_cast<std::size_t>(i)];
      f.push_back(-p[0][ci]);
      for (int j = 0; j < n; ++j) {
        const int cj = free[static_cast<std::size_t>(j)];
        M(i, j) = ci < 3 && cj < 3     ? A[0].M(ci, cj)
                  : ci >= 3 && cj >= 3 ? A[0].I(ci - 3, cj - 3)
                  : ci < 3             ? A[0].H(ci, cj - 3)
                                       : A[0].H(cj, ci - 3);
      }
    }
    const std::vector<S> a = ltdl(M).solve(f);
    for (int i = 0; i < n; ++i)
      result.base[free[static_cast<std::size_t>(i)]] = a[static_cast<std::size_t>(i)];
  }
  std::vector<Spatial<S>> a(size);
  a[0] = result.base;
  result.r_ddot.assign(static_cast<std::size_t>(mechanism.coordinates), S(0));
  for (std::size_t k = 1; k < size; ++k) {
    const Body<S>& b = tree.body(k);
    mechanism.section(b.name + ": acceleration");
    const JointTransform<S>& x = tree.joint(k);
    const Spatial<S>& parent = a[tree.parent_of(k)];
    a[k] = {x.to_body(parent.linear + cross(parent.angular, x.offset)), x.to_body(parent.angular)};
    if (b.kind == JointKind::fixed) continue;
    S carried = S(0);
    for (int i = 0; i < 6; ++i) carried = carried + joint[k].W[i] * a[k][i];
    const S r_ddot = own[k] - carried;
    result.r_ddot[static_cast<std::size_t>(tree.own_coordinate(k))] = r_ddot;
    if (b.kind != JointKind::prismatic) a[k].angular[b.axis] = a[k].angular[b.axis] + r_ddot;
    if (b.kind == JointKind::prismatic) a[k].linear[b.axis] = a[k].linear[b.axis] + r_ddot;
    if (b.kind == JointKind::helical) a[k].linear[b.axis] = a[k].linear[b.axis] + b.pitch * r_ddot;
  }
  return result;
}

}  // namespace anholon
