// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A mechanism as a skeleton of DART (Dynamic Animation and Robotics Toolkit).

#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <vector>

#include "urdf/central_inertia.hpp"

namespace anholon::testing {

inline Eigen::Vector3d eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
inline Eigen::Matrix3d eigen(const Mat3<double>& m) {
  Eigen::Matrix3d r;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r(i, j) = m(i, j);
  }
  return r;
}

/// The skeleton, and where DART keeps each of our velocities (eta linear first, then r).
struct DartSkeleton {
  dart::dynamics::SkeletonPtr skeleton;
  std::vector<std::size_t> at;

  explicit DartSkeleton(const Mechanism<double>& m) : skeleton(dart::dynamics::Skeleton::create("robot")) {
    using namespace dart::dynamics;
    skeleton->setGravity(eigen(m.gravity));
    const bool free = m.group == GroupKind::SE3;
    std::vector<BodyNode*> nodes;
    std::vector<Joint*> joint_of(static_cast<std::size_t>(m.coordinates), nullptr);
    for (const Body<double>& b : m.bodies) {
      BodyNode* parent = b.parent < 0 ? nullptr : nodes[static_cast<std::size_t>(b.parent)];
      Joint* joint = nullptr;
      BodyNode* node = nullptr;
      const auto add = [&]<class Kind>(Kind**) {
        std::tie(joint, node) = skeleton->createJointAndBodyNodePair<Kind>(parent);
        joint->setName(b.name);
        node->setName(b.name);
      };
      if (b.parent < 0 && free) {
        add(static_cast<FreeJoint**>(nullptr));
      } else if (b.parent < 0 || b.kind == JointKind::fixed) {
        add(static_cast<WeldJoint**>(nullptr));
      } else if (b.kind == JointKind::revolute) {
        add(static_cast<RevoluteJoint**>(nullptr));
        static_cast<RevoluteJoint*>(joint)->setAxis(eigen(unit<double>(b.axis)));
      } else {
        add(static_cast<PrismaticJoint**>(nullptr));
        static_cast<PrismaticJoint*>(joint)->setAxis(eigen(unit<double>(b.axis)));
      }
      if (b.parent >= 0) {
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.linear() = eigen(b.R);
        pose.translation() = eigen(b.p);
        joint->setTransformFromParentBodyNode(pose);
        if (b.coordinate >= 0) joint_of[static_cast<std::size_t>(b.coordinate)] = joint;
      }
      Vec3<double> centre;
      const Mat3<double> I = central_inertia(b, centre);
      Inertia inertia;
      inertia.setMass(b.mass);
      inertia.setLocalCOM(eigen(centre));
      inertia.setMoment(eigen(I));
      if (b.parent >= 0 || free)
        node->setInertia(inertia);  // that of the ground may be none, which DART minds
      nodes.push_back(node);
    }
    if (free) {  // DART has the angular part first
      for (const std::size_t c : {3, 4, 5, 0, 1, 2})
        at.push_back(skeleton->getRootJoint()->getIndexInSkeleton(c));
    }
    for (const Joint* joint : joint_of) at.push_back(joint->getIndexInSkeleton(0));
  }

  /// Positions of the root joint in our order: DART takes the logarithm of the pose.
  static std::vector<double> root_position(const Mat3<double>& R, const Vec3<double>& p) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = eigen(R);
    pose.translation() = eigen(p);
    const Eigen::Vector6d q = dart::dynamics::FreeJoint::convertToPositions(pose);
    return {q[3], q[4], q[5], q[0], q[1], q[2]};
  }
  [[nodiscard]] Eigen::VectorXd theirs(const std::vector<double>& ours) const {
    Eigen::VectorXd v(static_cast<Eigen::Index>(at.size()));
    for (std::size_t i = 0; i < at.size(); ++i) v(static_cast<Eigen::Index>(at[i])) = ours[i];
    return v;
  }
  [[nodiscard]] std::vector<double> ours(const Eigen::VectorXd& theirs) const {
    std::vector<double> v;
    for (const std::size_t i : at) v.push_back(theirs(static_cast<Eigen::Index>(i)));
    return v;
  }
};

}  // namespace anholon::testing
