// SPDX-License-Identifier: GPL-2.0-or-later

// Floating robots against DART (Dynamic Animation and Robotics Toolkit), on the very same numbers: its
// skeleton is built from the mechanism. DART runs its own recursions, composite and articulated bodies.

#ifdef ANHOLON_HAVE_DART

#include <gtest/gtest.h>

#include "urdf/dart_skeleton.hpp"
#include "urdf/oracle_state.hpp"
#include "urdf/small_robots.hpp"

namespace anholon::dart_test {
namespace {

/// Largest relative differences over random states, by function.
struct Worst {
  double inverse_dynamics = 0, mass_matrix = 0, forward_dynamics = 0;
};

Worst differences(const Model& model) {
  const auto derivation = derive_tree(model);
  const Mechanism<double> mechanism = testing::mechanism_of(model);
  const testing::DartSkeleton twin(mechanism);
  const bool free = mechanism.group == GroupKind::SE3;
  Worst worst;
  std::mt19937 random(11);
  for (int trial = 0; trial < 20; ++trial) {
    const auto x = testing::random_state<double>(derivation->program, random, [](double v) { return v; });
    std::vector<double> position, velocity;
    if (free) {
      position = testing::DartSkeleton::root_position(x.state.R, x.state.p);
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
    for (const std::size_t i : twin.at) {
      for (const std::size_t j : twin.at)
        entries.push_back(M(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
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
}  // namespace anholon::dart_test

#endif
