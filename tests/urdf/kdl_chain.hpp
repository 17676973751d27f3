// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A mechanism whose joints follow each other as a chain of the Orocos Kinematics and Dynamics Library.

#include <kdl/chain.hpp>

#include "urdf/central_inertia.hpp"

namespace anholon::testing {

inline KDL::Vector vector(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

/// The bodies of a mechanism whose joints follow each other; side branches on fixed joints must be massless.
inline KDL::Chain chain_of(const Mechanism<double>& m) {
  KDL::Chain chain;
  for (std::size_t k = 1; k < m.bodies.size(); ++k) {
    const Body<double>& b = m.bodies[k];
    const auto& R = b.R.m;
    const KDL::Frame tip(KDL::Rotation(R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]), vector(b.p));
    const KDL::Vector axis = vector(b.R * unit<double>(b.axis));
    const KDL::Joint joint = b.kind == JointKind::fixed ? KDL::Joint(b.name, KDL::Joint::None)
                             : b.kind == JointKind::prismatic
                                 ? KDL::Joint(b.name, vector(b.p), axis, KDL::Joint::TransAxis)
                                 : KDL::Joint(b.name, vector(b.p), axis, KDL::Joint::RotAxis);
    Vec3<double> c;
    const Mat3<double> I = central_inertia(b, c);
    chain.addSegment(KDL::Segment(
        b.name, joint, tip,
        KDL::RigidBodyInertia(b.mass, vector(c),
                              KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)))));
  }
  return chain;
}

/// Keeps the bodies on the way to the last joint and its fixed followers in a row.
inline bool is_chain(const Mechanism<double>& m) {
  for (std::size_t k = 1; k < m.bodies.size(); ++k) {
    if (m.bodies[k].parent != static_cast<int>(k) - 1) return false;
  }
  return true;
}

}  // namespace anholon::testing
