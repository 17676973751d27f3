// SPDX-License-Identifier: GPL-2.0-or-later
//
// Springs, dampers, friction, user forces, potentials and wrenches against their power on the masses.
#include <gtest/gtest.h>

#include "mechanics/witness.hpp"

namespace anholon::force_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

/// A free base with a slide and, on it, a hinge about an oblique axis: coordinates x, b.
Witness slide_and_hinge(const std::string& root_lines, const std::string& slide_lines,
                        const std::string& hinge_lines, const std::string& tail) {
  Witness w;
  w.description =
      header("SE3", root_lines) + body("base", "", cloud(0)) +
      body("slide", "base", cloud(1),
           fmt::format("pose = {{ translation = [0.2, 0.1, 0], rotation = {{ axis = \"z\", angle = 0.8 }} "
                       "}}\njoint = {{ kind = "
                       "\"prismatic\", axis = [0, -0.6, 0.8], coordinate = \"x\", range = [-1, 1]{} }}",
                       slide_lines)) +
      body("hinge", "slide", cloud(2),
           fmt::format("pose = {{ translation = [0, 0.3, -0.1], rotation = {{ axis = \"x\", angle = -0.5 }} "
                       "}}\njoint = {{ kind = "
                       "\"revolute\", axis = [\"2/3\", \"2/3\", \"-1/3\"], coordinate = \"b\"{} }}",
                       hinge_lines)) +
      tail;
  w.masses = [](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    const Pose slide = g * moved({0.2L, 0.1L, 0}) * turned({0, 0, 1}, 0.8L) *
                       moved({0, Jet(-0.6L) * r[0], Jet(0.8L) * r[0]});
    const Pose hinge = slide * moved({0, 0.3L, -0.1L}) * turned({1, 0, 0}, -0.5L) *
                       turned({2 / 3.0L, 2 / 3.0L, -1 / 3.0L}, r[1]);
    add(points, g, cloud(0)), add(points, slide, cloud(1)), add(points, hinge, cloud(2));
    return points;
  };
  w.loaded_frames = [](const Pose& g, const std::vector<Jet>& r) {  // base, slide, hinge
    const Pose slide = g * moved({0.2L, 0.1L, 0}) * turned({0, 0, 1}, 0.8L) *
                       moved({0, Jet(-0.6L) * r[0], Jet(0.8L) * r[0]});
    const Pose hinge = slide * moved({0, 0.3L, -0.1L}) * turned({1, 0, 0}, -0.5L) *
                       turned({2 / 3.0L, 2 / 3.0L, -1 / 3.0L}, r[1]);
    return std::vector<Pose>{g, slide, hinge};
  };
  return w;
}

TEST(Spring, PullsTowardsItsRest) {
  Witness w =
      slide_and_hinge("[parameters]\nk = { value = 35, unit = \"N/m\" }\nx0 = { value = 0.2, unit = \"m\" }",
                      ", stiffness = \"k\", rest = \"x0\"", ", stiffness = 1.75", "");
  w.potential = [](const Pose&, const std::vector<Jet>& r) {
    const Jet stretch = r[0] - Jet(0.2L);
    return Jet(17.5L) * stretch * stretch + Jet(0.875L) * r[1] * r[1];
  };
  expect_mechanics_of(w);
}

TEST(Damper, TakesThePowerOfItsRate) {
  Witness w = slide_and_hinge("", ", damping = 2.5", ", damping = 0.4", "");
  w.forces = [](const Sample& s) {
    return std::vector<Real>{0, 0, 0, 0, 0, 0, -2.5L * s.state.r_dot[0], -0.4L * s.state.r_dot[1]};
  };
  w.dissipated_power = [](const Sample& s) {
    return 2.5L * s.state.r_dot[0] * s.state.r_dot[0] + 0.4L * s.state.r_dot[1] * s.state.r_dot[1];
  };
  expect_mechanics_of(w);
}

TEST(Friction, SaturatesAtItsForce) {
  Witness w = slide_and_hinge("", ", friction = { force = 3.5, velocity = 0.2 }",
                              ", friction = { torque = 1.1, velocity = 0.05 }", "");
  w.forces = [](const Sample& s) {
    return std::vector<Real>{0,
                             0,
                             0,
                             0,
                             0,
                             0,
                             -3.5L * std::tanh(Real(s.state.r_dot[0]) / 0.2L),
                             -1.1L * std::tanh(Real(s.state.r_dot[1]) / 0.05L)};
  };
  w.dissipated_power = [forces = w.forces](const Sample& s) {
    const std::vector<Real> F = forces(s);
    return -F[6] * s.state.r_dot[0] - F[7] * s.state.r_dot[1];
  };
  expect_mechanics_of(w);
}

TEST(UserForce, ActsOnItsCoordinateOrComponent) {
  Witness w = slide_and_hinge(
      "[parameters]\nF = { value = 2, unit = \"N\" }\nu = { value = 1.5, unit = \"m/s\" }\nl = { value = "
      "0.5, unit = \"m\" }",
      "", "",
      "[[force]]\ncoordinate = \"x\"\nforce = \"F*cos(b)*(1 + (V_Y/u)^2) - F*dot(x)/u\"\n"
      "[[force]]\ncoordinate = \"b\"\nforce = \"-F*l*sin(3*t) + F*x*R_XY\"\n"
      "[[force]]\ncoordinate = \"b\"\nforce = \"0.25\"\n"
      "[[force]]\ncomponent = \"V_Z\"\nforce = \"-F*V_Z/u + F*l*dot(b)/u\"\n"
      "[[force]]\ncomponent = \"Omega_X\"\nforce = \"F*p_X*l*Omega_Y/u\"\n");
  w.forces = [](const Sample& sample) {
    const State<Real>& s = sample.state;
    const Real F = 2, u = 1.5L, l = 0.5L, x = s.r[0], b = s.r[1], dx = s.r_dot[0], db = s.r_dot[1];
    const Real V_Y = s.eta.linear.y, V_Z = s.eta.linear.z;
    return std::vector<Real>{0,
                             0,
                             -F * V_Z / u + F * l * db / u,
                             F * s.p.x * l * s.eta.angular.y / u,
                             0,
                             0,
                             F * std::cos(b) * (1 + (V_Y / u) * (V_Y / u)) - F * dx / u,
                             -F * l * std::sin(3 * Real(s.t)) + F * x * s.R.m[1] + 0.25L};
  };
  expect_mechanics_of(w);
}

TEST(Potential, ActsOnShapeAndPoseByItsGradient) {
  Witness w = slide_and_hinge(
      "potential = \"k/2*(p_X - x)^2 + k*p_Y*x*sin(b) + W*R_ZX*R_YX - W*exp(x/l)*R_XZ + W*cos(b)\"\n"
      "[parameters]\nk = { value = 14, unit = \"N/m\" }\nl = { value = 0.5, unit = \"m\" }\nW = { value = "
      "2.5, unit = \"J\" }",
      "", "", "");
  w.potential = [](const Pose& g, const std::vector<Jet>& r) {
    const Jet k = 14, W = 2.5L;
    const Jet apart = g.p[0] - r[0];
    return k * Jet(0.5L) * apart * apart + k * g.p[1] * r[0] * sin(r[1]) + W * g.R[2][0] * g.R[1][0] -
           W * exp(r[0] * Jet(2)) * g.R[0][2] + W * cos(r[1]);
  };
  expect_mechanics_of(w);
}

// D = c/2 (x_dot - l b_dot)^2 + e/2 (V_Y + x_dot)^2 + f V_X^4: (21) with velocities of both kinds, and one of
// fourth order, whose power is four times itself.
TEST(Dissipation, ActsByItsGradientInTheVelocities) {
  Witness w = slide_and_hinge(
      "dissipation = \"c/2*(dot(x) - l*dot(b))^2 + e/2*cos(b)^2*(V_Y + dot(x))^2 + f*V_X^4\"\n"
      "[parameters]\nc = { value = 3, unit = \"N s/m\" }\nl = { value = 0.5, unit = \"m\" }\n"
      "e = { value = 1.5, unit = \"N s/m\" }\nf = { value = 0.3, unit = \"kg s/m^2\" }",
      "", "", "");
  const auto forces = [](const Sample& sample) {
    const State<Real>& s = sample.state;
    const Real dx = s.r_dot[0], db = s.r_dot[1], V_X = s.eta.linear.x, V_Y = s.eta.linear.y;
    const Real slip = dx - 0.5L * db, c = std::cos(Real(s.r[1])), drag = 1.5L * c * c * (V_Y + dx);
    return std::vector<Real>{-1.2L * V_X * V_X * V_X, -drag, 0, 0, 0, 0, -3 * slip - drag, 1.5L * slip};
  };
  w.forces = forces;
  w.dissipated_power = [forces](const Sample& sample) {
    const std::vector<Real> v = velocity(GroupKind::SE3, sample.state), F = forces(sample);
    Real power = 0;
    for (std::size_t i = 0; i < v.size(); ++i) power -= v[i] * F[i];
    return power;
  };
  expect_mechanics_of(w);
}

Vector world(const Pose& frame, const Vector& components) {  // turns, does not shift
  Pose turn = frame;
  turn.p = Vector();
  return turn * components;
}
Vector moment(const Vector& arm, const Vector& force) {
  return {arm[1] * force[2] - arm[2] * force[1], arm[2] * force[0] - arm[0] * force[2],
          arm[0] * force[1] - arm[1] * force[0]};
}

TEST(Wrench, InBodyAxesFollowsTheDescribedFrameOfTheBody) {
  Witness w = slide_and_hinge(
      "[parameters]\nF = { value = 4, unit = \"N\" }\nl = { value = 0.5, unit = \"m\" }", "", "",
      "[[force]]\nbody = \"hinge\"\npoint = [0.1, -0.2, \"l\"]\nforce = [\"F*sin(b)\", \"-2*F\", \"F*x/l\"]\n"
      "torque = [0, \"F*l*cos(t)\", \"F*l\"]\n"
      "[[force]]\nbody = \"slide\"\naxes = \"body\"\nforce = [0, \"F*R_XX\", \"F\"]\n"
      "[[force]]\nbody = \"base\"\npoint = [\"l\", 0, 0.3]\nforce = [\"-F\", 0, \"F*sin(3*t)\"]\n");
  w.loads = [](const Sample& sample, const std::vector<Pose>& frames) {
    const State<Real>& s = sample.state;
    const Real F = 4, l = 0.5L, x = s.r[0], b = s.r[1];
    const auto at_point = [](const Pose& frame, const Vector& point, const Vector& force,
                             const Vector& torque) {
      return Load{world(frame, force), world(frame, torque + moment(point, force))};
    };
    return std::vector<Load>{at_point(frames[0], {l, 0, 0.3L}, {-F, 0, F * std::sin(3 * Real(s.t))}, {}),
                             at_point(frames[1], {}, {0, F * s.R.m[0], F}, {}),
                             at_point(frames[2], {0.1L, -0.2L, l}, {F * std::sin(b), -2 * F, F * x / l},
                                      {0, F * l * std::cos(Real(s.t)), F * l})};
  };
  expect_mechanics_of(w);
}

TEST(Wrench, InWorldAxesKeepsItsDirection) {
  Witness w = slide_and_hinge(
      "[parameters]\nF = { value = 4, unit = \"N\" }\nl = { value = 0.5, unit = \"m\" }", "", "",
      "[[force]]\nbody = \"hinge\"\naxes = \"world\"\npoint = [0.1, -0.2, \"l\"]\nforce = [\"F*p_X/l\", "
      "\"-2*F\", \"F*x/l\"]\n"
      "torque = [\"F*l\", 0, \"F*l*sin(t)\"]\n"
      "[[force]]\nbody = \"base\"\naxes = \"world\"\ntorque = [0, \"F*l\", 0]\n"
      "[[force]]\nbody = \"slide\"\naxes = \"world\"\npoint = [0, \"l\", 0]\nforce = [0, 0, \"-3*F\"]\n");
  w.loads = [](const Sample& sample, const std::vector<Pose>& frames) {
    const State<Real>& s = sample.state;
    const Real F = 4, l = 0.5L, x = s.r[0];
    const auto at_point = [](const Pose& frame, const Vector& point, const Vector& force,
                             const Vector& torque) {
      return Load{force, torque + moment(world(frame, point), force)};
    };
    return std::vector<Load>{at_point(frames[0], {}, {}, {0, F * l, 0}),
                             at_point(frames[1], {0, l, 0}, {0, 0, -3 * F}, {}),
                             at_point(frames[2], {0.1L, -0.2L, l}, {F * s.p.x / l, -2 * F, F * x / l},
                                      {F * l, 0, F * l * std::sin(Real(s.t))})};
  };
  expect_mechanics_of(w);
}

TEST(Gravity, PullsAlongTheWorldsAxesWhateverTheBaseDoes) {
  Witness w = slide_and_hinge(
      "gravity = [\"-gamma*sin(slope)\", 0, \"-gamma*cos(slope)\"]\n[parameters]\n"
      "gamma = { value = 9.81, unit = \"m/s^2\" }\nslope = { value = 0.3, unit = \"rad\" }",
      "", "", "");
  w.gravity = {-9.81L * std::sin(0.3L), 0, -9.81L * std::cos(0.3L)};
  expect_mechanics_of(w);
}

}  // namespace
}  // namespace anholon::force_test
