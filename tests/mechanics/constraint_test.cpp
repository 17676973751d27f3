// SPDX-License-Identifier: GPL-2.0-or-later
//
// Kinds of constraints that the shipped robots do not have, and coordinates driven by torque beside others
// driven by motion, against the full equations with multipliers.
#include <gtest/gtest.h>

#include "derive/derive.hpp"
#include "mechanics/robots.hpp"

namespace anholon::constraint_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

Model shipped(const std::string& name) {
  return read_model(fmt::format("{}/models/{}/{}.toml", ANHOLON_SOURCE_DIR, name, name));
}

std::string rotor(const std::string& parent, const std::string& axis, const std::string& coordinate,
                  const Cloud& masses, const std::string& joint = "") {
  return body("rotor_" + coordinate, parent, masses,
              fmt::format("joint = {{ kind = \"revolute\", axis = {}, coordinate = \"{}\"{} }}", axis,
                          coordinate, joint));
}
const std::string active = ", drive = \"active\"";

/// A planar base with a driven rotor on it; contacts to be added.
Robot base_and_rotor() {
  Robot robot;
  robot.witness.masses = [](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    add(points, g, cloud(0)), add(points, g * turned({0, 0, 1}, r[0]), cloud(1));
    return points;
  };
  return robot;
}

// Two parallel wheels on one axle: one row is redundant altogether, m = m° = 1 of 2 rows, and the wheels
// share the side force.
TEST(Constraint, RedundantAltogetherSharesItsForceEqually) {
  const Model model = read_model_text(
      header("SE2") + body("cart", "", cloud(0)) + rotor("cart", "[0, 0, 1]", "a", cloud(1), active) +
          "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"cart\"\npoint = [0.2, 0.3, 0]\n"
          "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"cart\"\npoint = [0.2, -0.3, 0]\n",
      "twin.toml");
  Robot robot = base_and_rotor();
  robot.contacts = [](const Pose& g, const std::vector<Jet>&, const Jet&) {
    return std::vector<Contact>{blade(g, 0.2L), blade(g, 0.2L)};
  };
  expect_reduced_motion_of(model, robot);
  const auto derivation = derive(model);
  EXPECT_EQ(derivation->reduction.ranks.rows, 2);
  EXPECT_EQ(derivation->reduction.ranks.m, 1);
  EXPECT_EQ(derivation->reduction.ranks.m_locked, 1);
}

// Three wheels on axles through one point, turned by two drives: every velocity of the base is fixed by that
// of the drives.
TEST(Constraint, OfADifferentialDriveLeavesNothingToTheDynamics) {
  const auto wheel = [](const std::string& name, double y) {
    return body(name, "cart", {},
                fmt::format("inertia = {{ mass = 0.4, about_com = {{ xx = 0.01, yy = 0.02, zz = 0.01 }} "
                            "}}\npose = {{ translation = "
                            "[0.1, {}, 0] }}\njoint = {{ kind = \"revolute\", axis = [0, 1, 0], coordinate = "
                            "\"{}_turn\", drive = \"active\" }}",
                            y, name));
  };
  const Model model = read_model_text(
      header("SE2") + body("cart", "", cloud(0)) + wheel("left", 0.3) + wheel("right", -0.3) +
          "[[constraint]]\nkind = \"rolling\"\nwheel = \"left\"\nradius = 0.15\n"
          "[[constraint]]\nkind = \"rolling\"\nwheel = \"right\"\nradius = 0.15\n"
          "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"cart\"\npoint = [0.1, 0, 0]\n",
      "drive.toml");
  Robot robot;
  const auto hub = [](const Pose& g, Real y) { return g * moved({0.1L, y, 0}); };
  robot.witness.masses = [hub](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    const Cloud wheel = cloud_of(0.4, {0, 0, 0}, {0.01, 0.02, 0.01, 0, 0, 0});
    add(points, g, cloud(0));
    add(points, hub(g, 0.3L) * turned({0, 1, 0}, r[0]), wheel),
        add(points, hub(g, -0.3L) * turned({0, 1, 0}, r[1]), wheel);
    return points;
  };
  robot.contacts = [hub](const Pose& g, const std::vector<Jet>& r, const Jet&) {
    return std::vector<Contact>{{axis_of(g, 0), hub(g, 0.3L).p, Jet(0.15L) * r[0], {}, {}},
                                {axis_of(g, 0), hub(g, -0.3L).p, Jet(0.15L) * r[1], {}, {}},
                                blade(g, 0.1L)};
  };
  expect_reduced_motion_of(model, robot);
  expect_hybrid_motion_of(model, robot, {"left_turn"});
  expect_hybrid_motion_of(model, robot, {"left_turn", "right_turn"});
}

// A row whose direction in the body turns with the place and with time.
TEST(Constraint, MayDependOnPlaceAndTime) {
  const Model model = read_model_text(
      header("SE2", "[parameters]\nl = { value = 0.7, unit = \"m\" }\nT = { value = 1.3, unit = \"s\" }") +
          body("cart", "", cloud(0)) + rotor("cart", "[0, 0, 1]", "a", cloud(1), active) +
          "[[constraint]]\nrow = \"cos(p_X/l)*V_Y - sin(p_Y/l + t/T + a)*V_X + l*exp(-p_X/l)/5*(Omega_Z + "
          "dot(a))\"\n",
      "place.toml");
  Robot robot = base_and_rotor();
  robot.contacts = [](const Pose& g, const std::vector<Jet>& r, const Jet& t) {
    const Jet x = g.p[0] * Jet(1 / 0.7L), y = g.p[1] * Jet(1 / 0.7L);
    Pose axes = g;
    axes.p = Vector();
    const Vector direction = axes * Vector(-sin(y + t * Jet(1 / 1.3L) + r[0]), cos(x), 0);
    const Vector about(0, 0,
                       Jet(0.14L) * exp(-x));  // of the rotor, whose angular velocity is Omega_Z + a_dot
    return std::vector<Contact>{{direction, g.p, {}, about, g * turned({0, 0, 1}, r[0])}};
  };
  expect_reduced_motion_of(model, robot);
}

// A point of a tumbling body kept at its height, and a second row about the world's vertical.
TEST(Constraint, MayDependOnOrientation) {
  const Model model = read_model_text(
      header("SE3", "gravity = [0, 0, -9.81]") + body("hull", "", cloud(0)) +
          rotor("hull", "[0, 0, 1]", "a", cloud(1), active) +
          rotor("hull", "[0.6, 0, 0.8]", "b", cloud(2), ", stiffness = 2.5") +
          "[[constraint]]\nrow = \"R_ZX*(V_X + 0.3*Omega_Y) + R_ZY*(V_Y - 0.3*Omega_X) + R_ZZ*V_Z\"\n"
          "[[constraint]]\nrow = \"R_ZX*Omega_X + R_ZY*Omega_Y + R_ZZ*Omega_Z\"\n",
      "height.toml");
  Robot robot;
  robot.witness.gravity = {0, 0, -9.81L};
  robot.witness.masses = [](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    add(points, g, cloud(0)), add(points, g * turned({0, 0, 1}, r[0]), cloud(1));
    add(points, g * turned({0.6L, 0, 0.8L}, r[1]), cloud(2));
    return points;
  };
  robot.witness.potential = [](const Pose&, const std::vector<Jet>& r) { return Jet(1.25L) * r[1] * r[1]; };
  robot.contacts = [](const Pose& g, const std::vector<Jet>&, const Jet&) {
    return std::vector<Contact>{{{0, 0, 1}, g * Vector(0, 0, 0.3L), {}, {}, {}}, {{}, {}, {}, {0, 0, 1}, g}};
  };
  expect_reduced_motion_of(model, robot, true);
}

// Suslov's and Veselova's problems with rotors: no turn about an axis of the body, or of the world.
TEST(Constraint, OfRotationMayBeFixedInTheBodyOrInTheWorld) {
  for (const bool in_world : {false, true}) {
    SCOPED_TRACE(in_world);
    const Model model =
        read_model_text(header("SO3", "gravity = [1.5, 0, -9]") + body("hull", "", cloud(0)) +
                            rotor("hull", "[0, 0, 1]", "a", cloud(1), active) +
                            fmt::format("[[constraint]]\nrow = \"{}\"\n",
                                        in_world ? "R_ZX*Omega_X + R_ZY*Omega_Y + R_ZZ*Omega_Z"
                                                 : "2*Omega_X - Omega_Y/3 + 0.5*Omega_Z"),
                        "top.toml");
    Robot robot = base_and_rotor();
    robot.witness.gravity = {1.5L, 0, -9};
    robot.contacts = [in_world](const Pose& g, const std::vector<Jet>&, const Jet&) {
      return std::vector<Contact>{
          {{}, {}, {}, in_world ? Vector(0, 0, 1) : g * Vector(2, -1 / 3.0L, 0.5L), g}};
    };
    expect_reduced_motion_of(model, robot, in_world);
  }
}

// A trailer on a free hitch beside a sprung rotor: H_pe is not zero, and one passive rate is free while the
// other follows the cart.
TEST(Constraint, MayRuleOnePassiveCoordinateAndLeaveAnother) {
  const Model model = read_model_text(
      header("SE2") + body("cart", "", cloud(0)) + rotor("cart", "[0, 0, 1]", "a", cloud(1), active) +
          rotor("cart", "[0, 0, 1]", "s", cloud(2), ", stiffness = 3, rest = 0.4, damping = 0.2") +
          body("trailer", "cart", cloud(1),
               "pose = { translation = [-0.3, 0, 0] }\njoint = { kind = \"revolute\", axis = [0, 0, -1], "
               "coordinate = \"h\", range = [-1.2, 1.2] }") +
          "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"cart\"\n"
          "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"trailer\"\npoint = [-0.5, 0, 0]\n",
      "mixed.toml");
  Robot robot;
  const auto hitched = [](const Pose& g, const std::vector<Jet>& r) {
    return g * moved({-0.3L, 0, 0}) * turned({0, 0, -1}, r[2]);
  };
  robot.witness.masses = [hitched](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    add(points, g, cloud(0)), add(points, g * turned({0, 0, 1}, r[0]), cloud(1)),
        add(points, g * turned({0, 0, 1}, r[1]), cloud(2));
    add(points, hitched(g, r), cloud(1));
    return points;
  };
  robot.witness.potential = [](const Pose&, const std::vector<Jet>& r) {
    const Jet stretch = r[1] - Jet(0.4L);
    return Jet(1.5L) * stretch * stretch;
  };
  robot.witness.forces = [](const Sample& s) {
    return std::vector<Real>{0, 0, 0, 0, -0.2L * s.state.r_dot[1], 0};
  };
  robot.contacts = [hitched](const Pose& g, const std::vector<Jet>& r, const Jet&) {
    return std::vector<Contact>{blade(g, 0), blade(hitched(g, r), -0.5L)};
  };
  expect_reduced_motion_of(model, robot);
}

TEST(HybridDrive, TakesTorquesInSomeJointsAndMotionInOthers) {
  expect_hybrid_motion_of(shipped("arm6"), arm6(), {"r2", "r5"});
  expect_hybrid_motion_of(shipped("free_chain"), free_chain(), {"r2"});
  expect_hybrid_motion_of(shipped("wheeled_snake3"), wheeled_snake(3), {"r1"});
  expect_hybrid_motion_of(shipped("trailer"), trailer(), {"r2"});
}

// With m > m° the torque-driven joints take over what made the system over-constrained.
TEST(HybridDrive, FreesAnOverConstrainedRobot) {
  expect_hybrid_motion_of(shipped("mobile_pendulum"), mobile_pendulum(), {"r1"});
  expect_hybrid_motion_of(shipped("wheeled_snake5"), wheeled_snake(5), {"r1"});
  expect_hybrid_motion_of(shipped("wheeled_snake5"), wheeled_snake(5), {"r2", "r3"});
}

}  // namespace
}  // namespace anholon::constraint_test
