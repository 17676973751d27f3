// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The shipped robots written down a second time: their masses by homogeneous transforms, their contacts by
// the velocity of the contact point. Numbers are typed from the robots' data sheets, not read from the
// descriptions.

#include "mechanics/full_equations.hpp"

namespace anholon::test {

/// Signed masses that have a given mass, mass centre and inertia about it (xx, yy, zz, xy, xz, yz): the
/// second moments P = tr(I)/2 1 - I lie on pairs of points at +-1 m, which the centre balances. Energies are
/// linear in the masses.
inline Cloud cloud_of(double mass, const std::array<double, 3>& com, const std::array<double, 6>& I) {
  const double half_trace = (I[0] + I[1] + I[2]) / 2;
  std::array<double, 3> P = {half_trace - I[0], half_trace - I[1], half_trace - I[2]};
  Cloud cloud;
  double pairs = 0;
  const auto add_pair = [&](double second_moment, const std::array<double, 3>& e) {
    if (second_moment == 0) return;
    for (const double side : {1.0, -1.0})
      cloud.push_back({second_moment / 2, com[0] + side * e[0], com[1] + side * e[1], com[2] + side * e[2]});
    pairs += second_moment;
  };
  for (int k = 0; k < 3; ++k) {  // P_ij (e_i + e_j)(e_i + e_j)^T brings P_ij to the diagonal as well
    const std::size_t i = k == 2 ? 1 : 0, j = k == 0 ? 1 : 2;
    std::array<double, 3> e{};
    e[i] = e[j] = 1;
    const double P_ij = -I[3 + static_cast<std::size_t>(k)];
    add_pair(P_ij, e);
    P[i] -= P_ij, P[j] -= P_ij;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<double, 3> e{};
    e[i] = 1;
    add_pair(P[i], e);
  }
  cloud.push_back({mass - pairs, com[0], com[1], com[2]});
  return cloud;
}
inline Cloud planar(double mass, double x, double J) { return cloud_of(mass, {x, 0, 0}, {0, 0, J, 0, 0, 0}); }

inline Vector axis_of(const Pose& frame, std::size_t column) {
  return {frame.R[0][column], frame.R[1][column], frame.R[2][column]};
}
/// A blade or passive wheel along the frame's x axis at (x, 0, 0).
inline Contact blade(const Pose& frame, Real x) { return {axis_of(frame, 1), frame * Vector(x, 0, 0), {}}; }

inline Robot double_pendulum() {
  Robot robot;
  robot.witness.gravity = {0, 0, -9.81L};
  robot.witness.masses = [](const Pose&, const std::vector<Jet>& r) {
    const Pose upper = turned({0, 1, 0}, r[0]);
    const Pose lower = upper * moved({0, 0, -0.6L}) * turned({0, 1, 0}, r[1]);
    std::vector<MassPoint> points;
    add(points, upper, cloud_of(1.4, {0, 0, -0.28}, {0, 0.045, 0, 0, 0, 0}));
    add(points, lower, cloud_of(0.9, {0, 0, -0.22}, {0, 0.018, 0, 0, 0, 0}));
    return points;
  };
  return robot;
}

inline Robot arm6() {
  Robot robot;
  robot.witness.gravity = {0, 0, -9.81L};
  robot.witness.masses = [](const Pose&, const std::vector<Jet>& r) {
    const Pose waist = turned({0, 0, 1}, r[0]);
    const Pose upper_arm = waist * moved({0, 0, 0.36L}) * turned({0, 1, 0}, r[1]);
    const Pose forearm = upper_arm * moved({0, 0, 0.42L}) * turned({0, 1, 0}, r[2]);
    const Pose wrist_roll = forearm * moved({0, 0, 0.4L}) * turned({0, 0, 1}, r[3]);
    const Pose wrist_pitch = wrist_roll * turned({0, 1, 0}, r[4]);
    const Pose hand = wrist_pitch * turned({0, 0, 1}, r[5]);
    std::vector<MassPoint> points;
    add(points, waist, cloud_of(4.2, {0, -0.03, 0.28}, {0.041, 0.039, 0.012, 0, 0, 0.002}));
    add(points, upper_arm, cloud_of(4, {0, 0.05, 0.21}, {0.072, 0.071, 0.009, 0, 0, -0.004}));
    add(points, forearm, cloud_of(2.7, {0.01, -0.02, 0.14}, {0.03, 0.031, 0.005, 0, 0.001, 0}));
    add(points, wrist_roll, cloud_of(1.3, {0, 0, -0.05}, {0.0042, 0.004, 0.0015, 0, 0, 0}));
    add(points, wrist_pitch, cloud_of(0.9, {0, 0.01, 0.02}, {0.0016, 0.0013, 0.0012, 0, 0, 0}));
    add(points, hand, cloud_of(1.5, {0, 0, 0.15}, {0.003, 0.003, 0.0018, 0, 0, 0}));
    return points;
  };
  const auto friction = [](const Sample& s) {
    std::vector<Real> Q(6, 0);
    for (std::size_t i = 0; i < 3; ++i) Q[i] = -0.4L * s.state.r_dot[i];
    return Q;
  };
  robot.witness.forces = friction;
  return robot;
}

inline Robot free_chain() {
  Robot robot;
  robot.witness.masses = [](const Pose& g, const std::vector<Jet>& r) {
    const double J_1 = 3.5 * 0.25 / 12, J_2 = 2 * 0.25 / 12;  // m l^2 / 12
    const Pose first = g * moved({0.35L, 0, 0}) * turned({0, 0, 1}, r[0]);
    const Pose second = first * moved({0.5L, 0, 0}) * turned({1, 0, 0}, M_PIl / 2) * turned({0, 0, 1}, r[1]);
    std::vector<MassPoint> points;
    add(points, g, cloud_of(12, {0.02, -0.01, 0.03}, {0.31, 0.52, 0.6, 0.02, -0.015, 0.01}));
    add(points, first, cloud_of(3.5, {0.25, 0, 0}, {0.006, J_1, J_1, 0, 0, 0}));
    add(points, second, cloud_of(2, {0.25, 0, 0}, {0.003, J_2, J_2, 0, 0, 0}));
    return points;
  };
  return robot;
}

/// A chain of links in the plane, an axle of passive wheels at the middle of each.
inline Robot wheeled_snake(std::size_t links) {
  static constexpr double a = 0.11, m = 0.6, J = 0.0031;
  const auto frames = [links](const Pose& g, const std::vector<Jet>& r) {
    std::vector<Pose> list = {g};
    for (std::size_t i = 1; i < links; ++i)
      list.push_back(list.back() * moved({i == 1 ? Real(-a) : Real(-2 * a), 0, 0}) *
                     turned({0, 0, 1}, r[i - 1]));
    return list;
  };
  Robot robot;
  robot.witness.masses = [frames](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    const auto list = frames(g, r);
    for (std::size_t i = 0; i < list.size(); ++i) add(points, list[i], planar(m, i == 0 ? 0 : -a, J));
    return points;
  };
  robot.contacts = [frames](const Pose& g, const std::vector<Jet>& r, const Jet&) {
    std::vector<Contact> contacts;
    const auto list = frames(g, r);
    for (std::size_t i = 0; i < list.size(); ++i) contacts.push_back(blade(list[i], i == 0 ? 0 : -a));
    return contacts;
  };
  return robot;
}

inline Robot trailer() {
  const auto hitched = [](const Pose& g, const std::vector<Jet>& r) {
    return g * moved({-0.12L, 0, 0}) * turned({0, 0, 1}, r[0]);
  };
  Robot robot;
  robot.witness.masses = [hitched](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    add(points, g, planar(5, 0.08, 0.21));
    add(points, hitched(g, r), planar(2.5, -0.35, 0.06));
    add(points, g * turned({0, 0, 1}, r[1]), planar(0, 0, 0.05));
    return points;
  };
  robot.witness.forces = [](const Sample& s) {
    return std::vector<Real>{0, 0, 0, -0.02L * s.state.r_dot[0], 0};
  };
  robot.contacts = [hitched](const Pose& g, const std::vector<Jet>& r, const Jet&) {
    return std::vector<Contact>{blade(g, 0), blade(hitched(g, r), -0.4L)};
  };
  return robot;
}

/// Cart on two wheels with a hanging bob; the description drives both wheels or the front one.
inline Robot mobile_pendulum() {
  Robot robot;
  robot.witness.gravity = {0, 0, -9.81L};
  robot.witness.masses = [](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    points.push_back({3.2L, g.p});
    for (const std::size_t i : {0, 1})
      add(points, g * moved({i == 0 ? 0.3L : -0.3L, 0, 0}) * turned({0, 1, 0}, r[i]),
          cloud_of(0.45, {0, 0, 0}, {0, 0.0037, 0, 0, 0, 0}));
    points.push_back({0.75L, g * Vector(Jet(0.8L) * sin(r[2]), 0, Jet(-0.8L) * cos(r[2]))});
    return points;
  };
  robot.contacts = [](const Pose& g, const std::vector<Jet>& r, const Jet&) {
    return std::vector<Contact>{{{1, 0, 0}, g.p, Jet(0.12L) * r[0]}, {{1, 0, 0}, g.p, Jet(0.12L) * r[1]}};
  };
  return robot;
}

}  // namespace anholon::test
