// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Quantities of a tree that need no solution of equations, over any scalar: momentum about the centre of
// mass, Jacobians of frames and the regressor, which is linear in the inertial figures of the bodies.

#include <string>
#include <vector>

#include "anholon/composite.hpp"
#include "anholon/free_dynamics.hpp"

namespace anholon {

template <class S>
struct CentroidalMomentum {
  Spatial<S> momentum;  // linear, and angular about the centre of mass, in world axes
  Vec3<S> centre;       // of mass, in the world
};

/// Momentum of the whole tree (Orin, Goswami and Lee 2013): the rows of a free reference body in the mass
/// matrix give it about that body's origin; it is moved to the centre of mass.
template <class S>
CentroidalMomentum<S> centroidal_momentum(const Mechanism<S>& mechanism, const State<S>& state) {
  Mechanism<S> free = mechanism;
  free.group = GroupKind::SE3;
  RigidTree<S> tree(free);
  tree.position(state.r);
  const MassMoments<S> all = composite_bodies(tree, JointFrames<S>(tree)).whole;
  std::vector<S> velocity;  // M v by one sweep: its first rows are the momentum in the reference body's axes
  for (int row = 0; row < 6; ++row) velocity.push_back(state.eta[row]);
  velocity.insert(velocity.end(), state.r_dot.begin(), state.r_dot.end());
  const std::vector<S> momentum = FreeDynamics<S>(free).mass_times(state, velocity);
  Spatial<S> h;
  for (int row = 0; row < 6; ++row) h[row] = momentum[static_cast<std::size_t>(row)];
  const Vec3<S> arm = (S(1) / all.mass) * all.first;
  h.angular -= cross(arm, h.linear);
  return {{state.R * h.linear, state.R * h.angular}, state.p + state.R * arm};
}

/// Twist of a body's described frame in its own axes, as a matrix on (eta, r_dot), and the bias of its
/// acceleration: d/dt twist = J (eta_dot, r_ddot) + bias.
template <class S>
struct FrameJacobian {
  Matrix<S> J;          // 6 x (n + s)
  std::vector<S> bias;  // 6
};

/// For the bodies with the given indices.
template <class S>
std::vector<FrameJacobian<S>> frame_jacobians(const Mechanism<S>& mechanism, const State<S>& state,
                                              const std::vector<int>& bodies) {
  Recursion<S> recursion(mechanism);
  const int size = velocity_size(mechanism);
  std::vector<FrameJacobian<S>> result(bodies.size());
  const auto in_frame = [&](int body, const Vec3<S>& linear, const Vec3<S>& angular) {
    const Mat3<S>& R = mechanism.bodies[static_cast<std::size_t>(body)].R_frame;
    return Spatial<S>{transposed_times(R, linear), transposed_times(R, angular)};
  };
  recursion.position(state);
  for (FrameJacobian<S>& f : result) f.J = Matrix<S>(6, size);
  for (int c = 0; c < size; ++c) {
    std::vector<S> e(static_cast<std::size_t>(size), S(0));
    e[static_cast<std::size_t>(c)] = S(1);
    State<S> moving = state;
    scatter(mechanism, std::span<const S>(e), moving.eta, moving.r_dot);
    recursion.twists(moving);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const BodyMotion<S>& m = recursion.motion(bodies[b]);
      const Spatial<S> twist = in_frame(bodies[b], m.v, m.w);
      for (int i = 0; i < 6; ++i) result[b].J(i, c) = twist[i];
    }
  }
  recursion.twists(state);
  const std::vector<Spatial<S>> rates = recursion.twist_rates(state);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Spatial<S>& of_body = rates[static_cast<std::size_t>(bodies[b])];
    const Spatial<S> rate = in_frame(bodies[b], of_body.linear, of_body.angular);
    for (int i = 0; i < 6; ++i) result[b].bias.push_back(rate[i]);
  }
  return result;
}

/// Matrix Y of (base wrench, joint forces) = Y pi, where pi lists m, mx, my, mz, Ixx, Iyy, Izz, Ixy, Ixz, Iyz
/// of every body about its origin in the axes of its described frame (Atkeson, An and Hollerbach 1986). Needs
/// position() and move().
template <class S>
Matrix<S> regressor(const RigidTree<S>& tree) {
  const Mechanism<S>& mechanism = tree.mechanism();
  const auto base = free_components(mechanism.group);
  const int n = static_cast<int>(base.size());
  Matrix<S> Y(n + mechanism.coordinates, 10 * static_cast<int>(tree.size()));
  constexpr int entries[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (std::size_t k = 0; k < tree.size(); ++k) {
    mechanism.section(tree.body(k).name + ": regressor");
    const Mat3<S>& R = tree.body(k).R_frame;
    for (int p = 0; p < 10; ++p) {
      MassMoments<S> unit_moments;
      if (p == 0) unit_moments.mass = S(1);
      if (p >= 1 && p < 4) unit_moments.first = R * unit<S>(p - 1);
      if (p >= 4) {
        Mat3<S> I;
        I(entries[p - 4][0], entries[p - 4][1]) = I(entries[p - 4][1], entries[p - 4][0]) = S(1);
        unit_moments.second = turned(R, second_moment(I));
      }
      const int column = 10 * static_cast<int>(k) + p;
      Spatial<S> f = tree.body_wrench(unit_moments, tree.motion(k));
      for (std::size_t i = k; i > 0; i = tree.parent_of(i)) {
        const S force = tree.joint_force(tree.body(i), f);
        tree.for_each_share(
            i, [&](int c, const S& share) { Y(n + c, column) = Y(n + c, column) + share * force; });
        f = tree.joint(i).to_parent(f);
      }
      for (int c = 0; c < n; ++c) Y(c, column) = f[base[static_cast<std::size_t>(c)]];
    }
  }
  return Y;
}

}  // namespace anholon
