// SPDX-License-Identifier: GPL-2.0-or-later

// Floating robots against DART (Dynamic Animation and Robotics Toolkit), on the very same numbers: its
// skeleton is built from the mechanism. DART runs its own recursions, composite and articulated bodies.

#ifdef ANHOLON_HAVE_DART

#include <gtest/gtest.h>

#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>

#include "urdf/oracle_state.hpp"
#include "urdf/small_robots.hpp"

namespace anholon {
namespace {

using namespace dart::dynamics;

Eigen::Vector3d vector(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
Eigen::Matrix3d matrix(const Mat3<double>& m) {
  Eigen::Matrix3d r;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r(i, j) = m(i, j);
  }
  return r;
}

/// A mechanism as a skeleton, and where DART keeps each of our velocities (eta linear first, then r).
struct Twin {
  SkeletonPtr skeleton;
  std::vector<Eigen::Index> at;

  explicit Twin(const Mechanism<double>& m) : skeleton(Skeleton::create("twin")) {
    skeleton->setGravity(vector(m.gravity));
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
        static_cast<RevoluteJoint*>(joint)->setAxis(vector(unit<double>(b.axis)));
      } else {
        add(static_cast<PrismaticJoint**>(nullptr));
        static_cast<PrismaticJoint*>(joint)->setAxis(vector(unit<double>(b.axis)));
      }
      if (b.parent >= 0) {
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.linear() = matrix(b.R);
        pose.translation() = vector(b.p);
        joint->setTransformFromParentBodyNode(pose);
        if (b.coordinate >= 0) joint_of[static_cast<std::size_t>(b.coordinate)] = joint;
      }
      Vec3<double> centre;
      const Mat3<double> I = testing::central_inertia(b, centre);
      Inertia inertia;
      inertia.setMass(b.mass);
      inertia.setLocalCOM(vector(centre));
      inertia.setMoment(matrix(I));
      node->setInertia(inertia);
      nodes.push_back(node);
    }
    if (free) {  // DART has the angular part first
      for (const std::size_t c : {3, 4, 5, 0, 1, 2})
        at.push_back(static_cast<Eigen::Index>(skeleton->getRootJoint()->getIndexInSkeleton(c)));
    }
    for (const Joint* joint : joint_of) at.push_back(static_cast<Eigen::Index>(joint->getIndexInSkeleton(0)));
  }
  [[nodiscard]] Eigen::VectorXd theirs(const std::vector<double>& ours) const {
    Eigen::VectorXd v(static_cast<Eigen::Index>(at.size()));
    for (std::size_t i = 0; i < at.size(); ++i) v(at[i]) = ours[i];
    return v;
  }
  [[nodiscard]] std::vector<double> ours(const Eigen::VectorXd& theirs) const {
    std::vector<double> v;
    for (const Eigen::Index i : at) v.push_back(theirs(i));
    return v;
  }
};

/// Largest relative differences over random states, by function.
struct Worst {
  double inverse_dynamics = 0, mass_matrix = 0, forward_dynamics = 0;
};

Worst differences(const Model& model) {
  const auto derivation = derive_tree(model);
  const Mechanism<double> mechanism = testing::mechanism_of(model);
  const Twin twin(mechanism);
  const bool free = mechanism.group == GroupKind::SE3;
  Worst worst;
  std::mt19937 random(11);
  for (int trial = 0; trial < 20; ++trial) {
    const auto x = testing::random_state<double>(derivation->program, random, [](double v) { return v; });
    std::vector<double> position(free ? 6 : 0, 0.0), velocity;
    if (free) {  // a pose without rounding on the way: DART's root frame is set, ours is given the same
                 // numbers
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = matrix(x.state.R);
      pose.translation() = vector(x.state.p);
      const Eigen::Vector6d q = FreeJoint::convertToPositions(pose);
      position = {q[3], q[4], q[5], q[0], q[1], q[2]};
      for (int i = 0; i < 6; ++i) velocity.push_back(x.state.eta[i]);
    }
    position.insert(position.end(), x.state.r.begin(), x.state.r.end());
    velocity.insert(velocity.end(), x.state.r_dot.begin(), x.state.r_dot.end());
    twin.skeleton->setPositions(twin.theirs(position));
    twin.skeleton->setVelocities(twin.theirs(velocity));

    twin.skeleton->setAccelerations(twin.theirs(x.acceleration));
    twin.skeleton->computeInverseDynamics();
    worst.inverse_dynamics =
        std::max(worst.inverse_dynamics,
                 testing::difference(testing::run(derivation->program, "inverse_dynamics", x.inputs),
                                     twin.ours(twin.skeleton->getForces())));
    const Eigen::MatrixXd& M = twin.skeleton->getMassMatrix();
    std::vector<double> entries;
    for (const Eigen::Index i : twin.at) {
      for (const Eigen::Index j : twin.at) entries.push_back(M(i, j));
    }
    worst.mass_matrix =
        std::max(worst.mass_matrix,
                 testing::difference(testing::run(derivation->program, "mass_matrix", x.inputs), entries));

    std::vector<double> force(free ? 6 : 0, 0.0);
    force.insert(force.end(), x.tau.begin(), x.tau.end());
    twin.skeleton->setForces(twin.theirs(force));
    twin.skeleton->computeForwardDynamics();
    worst.forward_dynamics =
        std::max(worst.forward_dynamics,
                 testing::difference(testing::run(derivation->program, "forward_dynamics", x.inputs),
                                     twin.ours(twin.skeleton->getAccelerations())));
  }
  return worst;
}

void expect_agreement(const Model& model) {
  const Worst worst = differences(model);
  EXPECT_LT(worst.inverse_dynamics, 1e-12);
  EXPECT_LT(worst.mass_matrix, 1e-12);
  EXPECT_LT(worst.forward_dynamics, 1e-12);
  std::printf("inverse dynamics %.1e, mass matrix %.1e, forward dynamics %.1e\n", worst.inverse_dynamics,
              worst.mass_matrix, worst.forward_dynamics);
}

TEST(Dart, Arm7) { expect_agreement(testing::shipped_robot("arm7")); }
TEST(Dart, Quadruped) { expect_agreement(testing::shipped_robot("quadruped")); }
TEST(Dart, Humanoid) { expect_agreement(testing::shipped_robot("humanoid")); }

}  // namespace
}  // namespace anholon

#endif
