// SPDX-License-Identifier: GPL-2.0-or-later
#include "robot.hpp"

#include <cmath>
#include <random>

#include "describe/mechanise.hpp"
#include "describe/read_robot.hpp"
#include "optimise/model/merge_fixed.hpp"

namespace anholon::bench {
namespace {

Vec3<double> numbers(const Vec3<Exact>& v) { return {v.x.to_double(), v.y.to_double(), v.z.to_double()}; }
Mat3<double> numbers(const Mat3<Exact>& m) {
  Mat3<double> r;
  for (std::size_t i = 0; i < 9; ++i) r.m[i] = m.m[i].to_double();
  return r;
}

/// Merged in exact numbers, then rounded.
Mechanism<double> merged_mechanism(const Model& model) {
  const MechanismDescription description = describe_mechanism(model);
  Mechanism<double> result = mechanise<double>(description, std::vector<double>{});
  Mechanism<Exact> exact = mechanise<Exact>(description, std::vector<Exact>{});
  merge_fixed(exact);
  result.bodies.clear();
  for (const Body<Exact>& b : exact.bodies) {
    Body<double> body;
    body.name = b.name, body.parent = b.parent, body.kind = b.kind, body.axis = b.axis;
    body.coordinate = b.coordinate, body.coupling = b.coupling, body.pitch = b.pitch.to_double();
    body.R = numbers(b.R), body.p = numbers(b.p), body.R_frame = numbers(b.R_frame);
    body.mass = b.mass.to_double(), body.first_moment = numbers(b.first_moment);
    body.inertia = numbers(b.inertia);
    result.bodies.push_back(std::move(body));
  }
  return result;
}

std::array<double, 4> random_quaternion(std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::array<double, 4> q{};
  double square = 0;
  for (double& x : q) x = normal(random), square += x * x;
  for (double& x : q) x /= std::sqrt(square);
  return q;
}

/// No peer is asked for springs, dampers, friction and armatures.
Model read_without_forces(const std::filesystem::path& file, const RobotOptions& options) {
  Model model = read_robot(file, options);
  model.potential = model.dissipation = 0;
  model.forces.clear();
  for (BodyDescription& b : model.bodies) b.joint.armature = 0;
  return model;
}

}  // namespace

Mat3<double> rotation(const std::array<double, 4>& wxyz) {
  const auto& [a, b, c, d] = wxyz;
  return {{1 - 2 * (c * c + d * d), 2 * (b * c - a * d), 2 * (b * d + a * c),  //
           2 * (b * c + a * d), 1 - 2 * (b * b + d * d), 2 * (c * d - a * b),  //
           2 * (b * d - a * c), 2 * (c * d + a * b), 1 - 2 * (b * b + c * c)}};
}

Robot load_robot(const std::filesystem::path& urdf, bool floating, std::size_t count) {
  RobotOptions options;
  options.floating = floating;
  Robot robot{urdf.stem().string(), read_without_forces(urdf, options), {}, {}, {}};
  options.symbolic_inertia = true;
  robot.symbolic = read_without_forces(urdf, options);
  robot.mechanism = merged_mechanism(robot.model);

  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit_interval(0, 1);
  const auto between = [&](double lower, double upper) {
    return lower + (upper - lower) * unit_interval(random);
  };
  for (std::size_t i = 0; i < count; ++i) {
    Sample s;
    if (floating) {
      s.quaternion_wxyz = random_quaternion(random);
      s.state.R = rotation(s.quaternion_wxyz);
      for (int j = 0; j < 6; ++j) s.state.eta[j] = between(-2, 2), s.eta_dot[j] = between(-3, 3);
    }
    for (const Coordinate& c : robot.model.coordinates) {
      s.state.r.push_back(between(c.lower.to_double(), c.upper.to_double()));
      s.state.r_dot.push_back(between(-2, 2));
      s.r_ddot.push_back(between(-3, 3));
      s.tau.push_back(between(-10, 10));
    }
    robot.samples.push_back(std::move(s));
  }
  return robot;
}

}  // namespace anholon::bench
