// SPDX-License-Identifier: GPL-2.0-or-later

// The same robot in URDF, SDFormat and MJCF is the same mechanism: exactly, and so are its functions.

#include "robot_files/same_robot.hpp"

#include <gtest/gtest.h>

#include "urdf/oracle_state.hpp"

namespace anholon::same_robot_test {
namespace {

using testing::robot;

Mechanism<Exact> exact_mechanism(const Model& model) {
  return mechanise<Exact>(describe_mechanism(model), {});
}

/// Entries computed on different ways differ by the rounding of 60 digits at most.
void expect_same(const Exact& a, const Exact& b, const std::string& what) {
  EXPECT_LT(abs(a - b), Exact::from_decimal("1e-40")) << what;
}

class SameRobot : public ::testing::TestWithParam<std::string> {};

TEST_P(SameRobot, HasTheSameBodies) {
  const std::string name = GetParam().substr(0, GetParam().find('.'));
  const Model urdf = robot(name + ".urdf"), other = robot(GetParam());
  EXPECT_EQ(other.name, urdf.name);
  EXPECT_EQ(other.group, urdf.group);
  ASSERT_EQ(other.coordinates.size(), urdf.coordinates.size());
  for (std::size_t i = 0; i < urdf.coordinates.size(); ++i) {
    const Coordinate &a = urdf.coordinates[i], &b = other.coordinates[i];
    EXPECT_EQ(b.name, a.name);
    EXPECT_LT(abs(b.lower - a.lower), Exact::from_decimal("1e-15"));  // the URDF has radians, MJCF degrees
    EXPECT_LT(abs(b.upper - a.upper), Exact::from_decimal("1e-15"));
  }
  const Mechanism<Exact> m = exact_mechanism(urdf), n = exact_mechanism(other);
  ASSERT_EQ(n.bodies.size(), m.bodies.size());
  for (std::size_t k = 0; k < m.bodies.size(); ++k) {
    const Body<Exact>&a = m.bodies[k], &b = n.bodies[k];
    EXPECT_EQ(b.name, a.name);
    EXPECT_EQ(b.parent, a.parent);
    EXPECT_EQ(b.kind, a.kind);
    EXPECT_EQ(b.axis, a.axis);
    EXPECT_EQ(b.coordinate, a.coordinate);
    EXPECT_EQ(b.mass, a.mass);
    for (std::size_t i = 0; i < 9; ++i) {
      expect_same(b.R.m[i], a.R.m[i], a.name + " R");
      EXPECT_EQ(b.R.m[i].is_zero(), a.R.m[i].is_zero()) << a.name << i;  // zeros are structural
      expect_same(b.inertia.m[i], a.inertia.m[i], a.name + " inertia");
      EXPECT_EQ(b.inertia.m[i].is_zero(), a.inertia.m[i].is_zero()) << a.name << i;
    }
    for (int i = 0; i < 3; ++i) {
      expect_same(b.p[i], a.p[i], a.name + " p");
      expect_same(b.first_moment[i], a.first_moment[i], a.name + " first moment");
    }
  }
}

TEST_P(SameRobot, HasTheSameFunctions) {
  const std::string name = GetParam().substr(0, GetParam().find('.'));
  TreeRequest request;
  request.search = false;
  request.functions = {"inverse_dynamics", "mass_matrix"};
  const auto urdf = derive_tree(robot(name + ".urdf"), request),
             other = derive_tree(robot(GetParam()), request);
  EXPECT_EQ(other->program.tape.size(), urdf->program.tape.size());
  std::mt19937 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const auto x = testing::random_state<double>(urdf->program, random, [](double v) { return v; });
    for (const std::string& function : request.functions) {
      // the same operations on numbers that may differ in the last place
      EXPECT_LT(testing::difference(testing::run(other->program, function, x.inputs),
                                    testing::run(urdf->program, function, x.inputs)),
                1e-13)
          << function;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SameRobot, ::testing::Values("arm.sdf", "arm.xml", "walker.sdf", "walker.xml"),
                         [](const auto& info) {
                           std::string name = info.param;
                           name[name.find('.')] = '_';
                           return name;
                         });

}  // namespace
}  // namespace anholon::same_robot_test
