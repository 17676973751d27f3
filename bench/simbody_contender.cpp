// SPDX-License-Identifier: GPL-2.0-or-later
#include <memory>

#include "contenders.hpp"
#include "layout.hpp"
#include "motion.hpp"
#include "simbody_engine.hpp"
#include "simulate/cpu_time.hpp"

namespace anholon::bench {
namespace {

using Joint = SimbodyBody::Joint;

std::array<double, 3> numbers(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

std::vector<SimbodyBody> bodies_of(const Mechanism<double>& m) {
  std::vector<SimbodyBody> bodies;
  for (const Body<double>& b : m.bodies) {
    SimbodyBody& s = bodies.emplace_back();
    s.parent = b.parent;
    s.joint = b.parent < 0                     ? m.group == GroupKind::SE3 ? Joint::free : Joint::ground
              : b.kind == JointKind::revolute  ? Joint::pin
              : b.kind == JointKind::prismatic ? Joint::slider
                                               : Joint::weld;
    s.axis = numbers(unit<double>(b.axis));
    s.R = b.R.m;
    s.p = numbers(b.p);
    s.mass = b.mass;
    if (b.mass != 0) s.centre = numbers((1 / b.mass) * b.first_moment);
    const Mat3<double>& I = b.inertia;
    s.inertia = {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
  }
  return bodies;
}

/// Simbody takes all velocities of a free base in ground axes, the angular part first.
struct Twin {
  explicit Twin(const Robot& r) : robot(r), engine(bodies_of(r.mechanism), numbers(r.mechanism.gravity)) {
    const Mechanism<double>& m = r.mechanism;
    layout.free_base = layout.linear_in_world = layout.angular_in_world = m.group == GroupKind::SE3;
    if (layout.free_base) {
      for (const std::size_t c : {3, 4, 5, 0, 1, 2}) layout.at.push_back(engine.first_velocity(0) + c);
    }
    body_of.resize(static_cast<std::size_t>(m.coordinates));
    for (std::size_t k = 0; k < m.bodies.size(); ++k) {
      if (m.bodies[k].coordinate >= 0) body_of[static_cast<std::size_t>(m.bodies[k].coordinate)] = k;
    }
    for (const std::size_t k : body_of) layout.at.push_back(engine.first_velocity(k));
    for (const Sample& s : r.samples) {
      std::vector<double> q(engine.positions(), 0.0);
      if (layout.free_base) {
        for (std::size_t c = 0; c < 4; ++c) q[engine.first_position(0) + c] = s.quaternion_wxyz[c];
      }
      for (std::size_t i = 0; i < body_of.size(); ++i) q[engine.first_position(body_of[i])] = s.state.r[i];
      engine.add(q, layout.velocity(s), layout.acceleration(s), layout.force(s));
    }
  }
  [[nodiscard]] Layout::Entry result() const {
    return [this](std::size_t i) { return engine.result(i); };
  }

  const Robot& robot;
  SimbodyEngine engine;
  Layout layout;
  std::vector<std::size_t> body_of;  // each coordinate moves
};

}  // namespace

std::vector<Contender> simbody_contenders(const Robot& robot, const std::string& function) {
  const auto twin = std::make_shared<Twin>(robot);
  const std::size_t n = robot.samples.size();
  if (function == "inverse_dynamics")
    return {contender(
        "Simbody, calcResidualForce", n, [twin](std::size_t i) { twin->engine.inverse_dynamics(i); },
        [twin](std::size_t i) { return twin->layout.our_force(twin->robot.samples[i], twin->result()); })};
  if (function == "forward_dynamics")
    return {contender(
        "Simbody, calcAcceleration", n, [twin](std::size_t i) { twin->engine.forward_dynamics(i); },
        [twin](std::size_t i) {
          return twin->layout.our_acceleration(twin->robot.samples[i], twin->result());
        })};
  if (function == "mass_matrix")
    return {contender(
        "Simbody, calcM", n, [twin](std::size_t i) { twin->engine.mass_matrix(i); },
        [twin](std::size_t i) {
          return twin->layout.our_matrix(twin->robot.samples[i], [twin](std::size_t r, std::size_t c) {
            return twin->engine.entry(r, c);
          });
        })};
  return {};
}

MotionRun simbody_motion(const Robot& robot, double duration, double accuracy) {
  Twin twin(robot);
  std::vector<double> q, u;
  MotionRun run;
  const double start = cpu_now();
  run.evaluations = twin.engine.fall(0, duration, accuracy, q, u);
  run.cpu_seconds = cpu_now() - start;
  if (twin.layout.free_base) {
    const double* const at = q.data() + twin.engine.first_position(0);
    const double* const rates = u.data() + twin.engine.first_velocity(0);
    const std::array<double, 4> quaternion = {at[0], at[1], at[2], at[3]};
    const Vec3<double> angular =
        transposed_times(rotation(quaternion), Vec3<double>{rates[0], rates[1], rates[2]});
    run.end = free_base(quaternion, {at[4], at[5], at[6]}, {rates[3], rates[4], rates[5]}, angular);
  }
  for (const std::size_t k : twin.body_of) {
    run.end.position.push_back(q[twin.engine.first_position(k)]);
    run.end.velocity.push_back(u[twin.engine.first_velocity(k)]);
  }
  return run;
}

}  // namespace anholon::bench
