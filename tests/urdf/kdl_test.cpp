// SPDX-License-Identifier: GPL-2.0-or-later

// Arms against the Orocos Kinematics and Dynamics Library, on the very same numbers: its chain is built from
// the mechanism.

#ifdef ANHOLON_HAVE_KDL

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "derive/tree_functions.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_urdf.hpp"
#include "urdf/random_state.hpp"
#include "urdf/small_robots.hpp"

namespace anholon {
namespace {

KDL::Vector vector(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

/// The bodies of a mechanism whose joints follow each other; side branches on fixed joints must be massless.
KDL::Chain chain_of(const Mechanism<double>& m) {
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
    const Vec3<double> c = b.mass == 0 ? Vec3<double>{} : (1 / b.mass) * b.first_moment;
    const double square = dot(c, c);
    const auto central = [&](int i, int j) {
      return b.inertia(i, j) - b.mass * ((i == j ? square : 0.0) - c[i] * c[j]);
    };
    chain.addSegment(KDL::Segment(
        b.name, joint, tip,
        KDL::RigidBodyInertia(b.mass, vector(c),
                              KDL::RotationalInertia(central(0, 0), central(1, 1), central(2, 2),
                                                     central(0, 1), central(0, 2), central(1, 2)))));
  }
  return chain;
}

/// Keeps the bodies on the way to the last joint and its fixed followers in a row.
bool is_chain(const Mechanism<double>& m) {
  for (std::size_t k = 1; k < m.bodies.size(); ++k) {
    if (m.bodies[k].parent != static_cast<int>(k) - 1) return false;
  }
  return true;
}

void compare(const Model& model) {
  const auto derivation = derive_tree(model);
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), std::vector<double>{});
  ASSERT_TRUE(is_chain(mechanism));
  const KDL::Chain chain = chain_of(mechanism);
  const unsigned n = chain.getNrOfJoints();
  ASSERT_EQ(n, model.coordinates.size());
  KDL::ChainIdSolver_RNE inverse(chain, KDL::Vector(0, 0, -9.81));
  KDL::ChainDynParam parameters(chain, KDL::Vector(0, 0, -9.81));
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const auto x = testing::random_state<double>(derivation->program, random, [](double v) { return v; });
    KDL::JntArray q(n), qd(n), qdd(n), tau(n), gravity(n);
    for (unsigned i = 0; i < n; ++i)
      q(i) = x.state.r[i], qd(i) = x.state.r_dot[i], qdd(i) = x.acceleration[i];
    ASSERT_EQ(inverse.CartToJnt(q, qd, qdd, KDL::Wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero()), tau),
              0);
    ASSERT_EQ(parameters.JntToGravity(q, gravity), 0);
    KDL::JntSpaceInertiaMatrix M(n);
    ASSERT_EQ(parameters.JntToMass(q, M), 0);
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

TEST(Kdl, ChainOfOurOwn) { compare(read_urdf_text(frictionless_chain(), "chain.urdf")); }

TEST(Kdl, Iiwa) {
  const std::filesystem::path file = std::filesystem::path(ANHOLON_ROBOTS) / "iiwa.urdf";
  if (std::string(ANHOLON_ROBOTS).empty() || !std::filesystem::exists(file))
    GTEST_SKIP() << "ANHOLON_ROBOTS has no iiwa";
  compare(read_urdf(file));
}

}  // namespace
}  // namespace anholon

#endif
