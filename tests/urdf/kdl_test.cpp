// SPDX-License-Identifier: GPL-2.0-or-later

// Arms against the Orocos Kinematics and Dynamics Library, on the very same numbers: its chain is built from
// the mechanism.

#ifdef ANHOLON_HAVE_KDL

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "urdf/kdl_chain.hpp"
#include "urdf/oracle_state.hpp"
#include "urdf/small_robots.hpp"

namespace anholon::kdl_test {
namespace {

void compare(const Model& model) {
  const auto derivation = derive_tree(model);
  const Mechanism<double> mechanism = testing::mechanism_of(model);
  ASSERT_TRUE(testing::is_chain(mechanism));
  const KDL::Chain chain = testing::chain_of(mechanism);
  const unsigned n = chain.getNrOfJoints();
  ASSERT_EQ(n, model.coordinates.size());
  KDL::ChainIdSolver_RNE inverse(chain, KDL::Vector(0, 0, -9.81));
  KDL::ChainFdSolver_RNE forward(chain, KDL::Vector(0, 0, -9.81));
  KDL::ChainDynParam parameters(chain, KDL::Vector(0, 0, -9.81));
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const auto x = testing::random_state<double>(derivation->program, random, [](double v) { return v; });
    KDL::JntArray q(n), qd(n), qdd(n), tau(n), gravity(n);
    for (unsigned i = 0; i < n; ++i)
      q(i) = x.state.r[i], qd(i) = x.state.r_dot[i], qdd(i) = x.acceleration[i];
    const KDL::Wrenches none(chain.getNrOfSegments(), KDL::Wrench::Zero());
    ASSERT_EQ(inverse.CartToJnt(q, qd, qdd, none, tau), 0);
    ASSERT_EQ(parameters.JntToGravity(q, gravity), 0);
    KDL::JntSpaceInertiaMatrix M(n);
    ASSERT_EQ(parameters.JntToMass(q, M), 0);
    KDL::JntArray applied(n), acceleration(n);
    for (unsigned i = 0; i < n; ++i) applied(i) = x.tau[i];
    ASSERT_EQ(forward.CartToJnt(q, qd, applied, none, acceleration), 0);
    const std::vector<double> r_ddot(acceleration.data.data(), acceleration.data.data() + n);
    EXPECT_LT(testing::difference(testing::run(derivation->program, "forward_dynamics", x.inputs), r_ddot),
              1e-12);
    const auto got_tau = testing::run(derivation->program, "inverse_dynamics", x.inputs);
    const auto got_gravity = testing::run(derivation->program, "gravity_forces", x.inputs);
    const auto got_M = testing::run(derivation->program, "mass_matrix", x.inputs);
    const double scale = tau.data.cwiseAbs().maxCoeff() + gravity.data.cwiseAbs().maxCoeff();
    for (unsigned i = 0; i < n; ++i) {
      EXPECT_NEAR(got_tau[i], tau(i), 1e-12 * scale);
      EXPECT_NEAR(got_gravity[i], gravity(i), 1e-12 * scale);
      for (unsigned j = 0; j < n; ++j)
        EXPECT_NEAR(got_M[i * n + j], M(i, j), 1e-12 * M.data.cwiseAbs().maxCoeff());
    }
  }
}

/// The serial arm without dampers and without the fixed link at its base, which KDL's chain has no place for.
std::string frictionless_chain() {
  using testing::joint, testing::link;
  return "<robot name='chain'>\n" + link("base", "3", "0.1 0 0.02") + link("one", "2.5", "0.01 -0.03 0.2") +
         link("two", "2", "0.15 0.02 0.01", "0.1 -0.2 0.3") + link("three", "1.5", "0 0.11 0.05") +
         link("four", "1.1", "0.02 0.01 0.09") + link("five", "0.7", "0.03 -0.02 0.04") +
         link("tool", "0.4", "0 0.01 0.03") +
         joint("j1", "revolute", "base", "one", "0 0 0.3", "0 0 0", "0 0 1") +
         joint("j2", "continuous", "one", "two", "0.05 0.02 0.1", "-1.57079632679 0 0", "0 0 1") +
         joint("j3", "prismatic", "two", "three", "0.2 0.1 -0.05", "0 0.785398163397 0.2", "1 0 0") +
         joint("j4", "revolute", "three", "four", "0.01 0.2 0.03", "1.57079632679 0 3.14159265359",
               "0 -1 0") +
         joint("j5", "revolute", "four", "five", "0.02 0.1 0.3", "0.3 -0.4 0.5", "0.6 0 0.8") +
         joint("weld", "fixed", "five", "tool", "0 0 0.1", "0.2 0.1 -0.3", "0 0 1") + "</robot>\n";
}

TEST(Kdl, ChainOfOurOwn) { compare(read_robot_text(frictionless_chain(), "chain.urdf")); }

TEST(Kdl, Arm7) { compare(testing::shipped_robot("arm7")); }

TEST(Kdl, Iiwa) {
  const std::filesystem::path file = std::filesystem::path(ANHOLON_ROBOTS) / "iiwa.urdf";
  if (std::string(ANHOLON_ROBOTS).empty() || !std::filesystem::exists(file))
    GTEST_SKIP() << "ANHOLON_ROBOTS has no iiwa";
  compare(read_robot(file));
}

}  // namespace
}  // namespace anholon::kdl_test

#endif
