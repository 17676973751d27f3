// SPDX-License-Identifier: MIT
#pragma once

// The generalised recursive Newton-Euler algorithm, eqs. (69)-(72): twists and accelerations from the
// reference body to the tips, wrenches back. Modal accelerations are inputs and modal forces outputs, as for
// joints, so that compliant bodies need no articulated step. Written once for every scalar.

#include <cmath>
#include <vector>

#include "anholon/body_wrench.hpp"
#include "anholon/mechanism.hpp"
#include "anholon/second_moment.hpp"
#include "anholon/station.hpp"

namespace anholon {

template <class S>
class Recursion {
 public:
  explicit Recursion(const Mechanism<S>& mechanism)
      : mechanism_(mechanism),
        joints_(mechanism.bodies.size()),
        motions_(mechanism.bodies.size()),
        carriers_(mechanism.bodies.size()),
        wrenches_(mechanism.bodies.size()) {
    for (const Coupling<S>& c : mechanism.couplings)
      coupling_values_.emplace_back(1 + c.on.size() * (1 + c.on.size()), S(0));
    for (const Body<S>& body : mechanism.bodies) has_fluid_ = has_fluid_ || body.fluid.has_value();
    applied_.resize(6, S(0));
    force_.resize(6 + static_cast<std::size_t>(mechanism.coordinates), S(0));
    generalised_.resize(static_cast<std::size_t>(mechanism.coordinates), S(0));
    zeros_.resize(static_cast<std::size_t>(mechanism.coordinates), S(0));
  }

  /// Joint transformations and mass properties at state.r.
  void position(const State<S>& state) {
    using std::cos, std::sin;
    mechanism_.section("joint angles");
    for (std::size_t c = 0; c < mechanism_.couplings.size(); ++c)
      mechanism_.couplings[c].evaluate(state.r, coupling_values_[c]);
    for (std::size_t k = 0; k < mechanism_.bodies.size(); ++k) {
      const Body<S>& body = mechanism_.bodies[k];
      Joint& joint = joints_[k];
      joint.rotation = {body.axis, S(1), S(0)};
      joint.offset = body.p;
      const S q = displacement(body, state);
      if (body.kind == JointKind::revolute || body.kind == JointKind::helical) {
        joint.rotation.c = cos(q);
        joint.rotation.s = sin(q);
      }
      if (body.kind == JointKind::prismatic) joint.offset += body.R * (q * unit<S>(body.axis));
      if (body.kind == JointKind::helical) joint.offset += body.R * (body.pitch * q * unit<S>(body.axis));
      if (!body.modes.empty()) mechanism_.section(body.name + ": inertia in its present shape");
      joint.inertia = inertia_in_shape(body, std::span<const S>(state.r));
      if (body.station.modes.empty()) continue;
      mechanism_.section(body.name + ": station");
      joint.station.place(body.station, std::span<const S>(state.r));
    }
  }

  /// Twists of all bodies, eq. (71). Needs position().
  void twists(const State<S>& state) {
    motions_[0].v = state.eta.linear;
    motions_[0].w = state.eta.angular;
    for (std::size_t k = 1; k < mechanism_.bodies.size(); ++k) {
      const Body<S>& body = mechanism_.bodies[k];
      mechanism_.section(body.name + ": twist");
      if (!body.station.modes.empty()) move_station(k, state);
      const BodyMotion<S>& parent = carrier(k);
      BodyMotion<S>& motion = motions_[k];
      motion.v = to_body(k, parent.v + cross(parent.w, joints_[k].offset));
      motion.w = to_body(k, parent.w);
      const auto [linear, angular] = along_axis(body, rate(body, std::span<const S>(state.r_dot)));
      motion.v[body.axis] = motion.v[body.axis] + linear;
      motion.w[body.axis] = motion.w[body.axis] + angular;
    }
  }

  /// Accelerations of all bodies, eq. (72). Needs twists().
  /// @param eta_dot  derivative of the reference body's twist components
  /// @param r_ddot  (s) second derivatives of the coordinates
  /// @param gravity  whether the bodies fall with the acceleration of gravity taken off
  void accelerations(const State<S>& state, const Spatial<S>& eta_dot, std::span<const S> r_ddot,
                     bool gravity) {
    BodyMotion<S>& base = motions_[0];
    mechanism_.section(mechanism_.bodies[0].name + ": acceleration");
    base.a = eta_dot.linear + cross(base.w, base.v);
    base.gravity = {};
    if (gravity) {
      const Vec3<S> own = transposed_times(state.R, mechanism_.gravity);
      base.a -= own;
      base.gravity = own;
    }
    base.wd = eta_dot.angular;
    complete(base);
    for (std::size_t k = 1; k < mechanism_.bodies.size(); ++k) {
      const Body<S>& body = mechanism_.bodies[k];
      mechanism_.section(body.name + ": acceleration");
      if (!body.station.modes.empty()) accelerate_station(k, state, r_ddot);
      const BodyMotion<S>& parent = carrier(k);
      BodyMotion<S>& motion = motions_[k];
      const auto [linear_rate, angular_rate] = along_axis(body, rate(body, std::span<const S>(state.r_dot)));
      const auto [linear, angular] = along_axis(body, acceleration(body, state, r_ddot));
      const Vec3<S> axis = unit<S>(body.axis);
      const Vec3<S> carried = to_body(k, parent.w);
      motion.a =
          to_body(k, parent.a + parent.U * joints_[k].offset) + S(2) * cross(carried, linear_rate * axis);
      motion.a[body.axis] = motion.a[body.axis] + linear;
      motion.wd = to_body(k, parent.wd) + cross(carried, angular_rate * axis);
      motion.wd[body.axis] = motion.wd[body.axis] + angular;
      if (has_fluid_) motion.gravity = to_body(k, parent.gravity);
      complete(motion);
    }
  }

  /// Rates of the twists' components while eta and r_dot stay what they are, in the order of the bodies: the
  /// bias of their Jacobians. Needs twists().
  ///
  ///   eta_dot_k = Ad eta_dot_parent + ad(eta_k) S_k r_dot_k,    ad(V, W) (v, w) = (W x v + V x w, W x w)
  ///
  /// Other than accelerations less Omega x V, this vanishes term by term where no joint moves.
  [[nodiscard]] std::vector<Spatial<S>> twist_rates(const State<S>& state) const {
    std::vector<Spatial<S>> rates(mechanism_.bodies.size());
    for (std::size_t k = 1; k < rates.size(); ++k) {
      const Body<S>& body = mechanism_.bodies[k];
      mechanism_.section(body.name + ": rate of the twist");
      const Spatial<S>& parent = rates[static_cast<std::size_t>(body.parent)];
      const BodyMotion<S>& motion = motions_[k];
      const auto [linear_rate, angular_rate] = along_axis(body, rate(body, std::span<const S>(state.r_dot)));
      const auto [linear, angular] = along_axis(body, acceleration(body, state, no_acceleration()));
      const Vec3<S> axis = unit<S>(body.axis);
      rates[k].linear = to_body(k, parent.linear + cross(parent.angular, joints_[k].offset)) +
                        cross(motion.w, linear_rate * axis) + cross(motion.v, angular_rate * axis);
      rates[k].angular = to_body(k, parent.angular) + cross(motion.w, angular_rate * axis);
      rates[k].linear[body.axis] = rates[k].linear[body.axis] + linear;
      rates[k].angular[body.axis] = rates[k].angular[body.axis] + angular;
    }
    return rates;
  }

  /// Forces that the motion needs beyond those that are applied. Needs accelerations().
  /// @param applied  whether user wrenches, springs, dampers and generalised forces act
  /// Afterwards base_wrench() is f_reac and generalised_forces() is tau of eq. (28), one for every
  /// coordinate.
  void wrenches(const State<S>& state, std::span<const S> r_ddot, bool applied) {
    for (S& force : generalised_) force = S(0);
    for (std::size_t k = 0; k < mechanism_.bodies.size(); ++k) {
      const Body<S>& body = mechanism_.bodies[k];
      mechanism_.section(body.name + ": wrench");
      wrenches_[k] =
          body_wrench(body, joints_[k].inertia, motions_[k], std::span<const S>(state.r_dot), r_ddot, modal_);
      for (std::size_t j = 0; j < modal_.size(); ++j) add_force(body.modes[j].coordinate, modal_[j]);
      if (!body.fluid) continue;
      mechanism_.section(body.name + ": wrench of the fluid");
      const Spatial<S> moved = fluid_wrench(*body.fluid, motions_[k]);
      wrenches_[k].linear += moved.linear;
      wrenches_[k].angular += moved.angular;
    }
    if (applied && !mechanism_.wrenches.empty()) {
      for_each_applied_wrench(state, [this](const AppliedWrench<S>& of, const Spatial<S>& wrench) {
        Spatial<S>& sum = wrenches_[static_cast<std::size_t>(of.body)];
        sum.linear -= wrench.linear;
        sum.angular -= wrench.angular;
      });
    }
    for (std::size_t k = mechanism_.bodies.size(); k-- > 1;) {
      const Body<S>& body = mechanism_.bodies[k];
      mechanism_.section(body.name + ": joint force");
      project(body, wrenches_[k], rotor_force(body, state, r_ddot));
      const Vec3<S> force = to_parent(k, wrenches_[k].linear);
      const Vec3<S> moment = to_parent(k, wrenches_[k].angular) + cross(joints_[k].offset, force);
      Spatial<S>& parent = wrenches_[static_cast<std::size_t>(body.parent)];
      if (body.station.modes.empty()) {
        parent.linear += force;
        parent.angular += moment;
        continue;
      }
      const StationFrame<S>& station = joints_[k].station;
      const Spatial<S> pull = {station.from(force), station.from(moment)};
      station.modal_forces(pull, [this](int coordinate, const S& x) { add_force(coordinate, x); });
      parent.linear += pull.linear;
      parent.angular += pull.angular + cross(station.offset(), pull.linear);
    }
    base_wrench_ = wrenches_[0];
    if (applied && mechanism_.generalised_forces) {
      mechanism_.section("springs, dampers and generalised forces");
      mechanism_.generalised_forces(state, force_);
      for (int i = 0; i < 6; ++i) base_wrench_[i] = base_wrench_[i] - force_[static_cast<std::size_t>(i)];
      for (std::size_t i = 0; i < generalised_.size(); ++i) generalised_[i] = generalised_[i] - force_[6 + i];
    }
  }

  /// Kinetic energy of the armatures. Needs position().
  [[nodiscard]] S rotor_energy(const State<S>& state) const {
    S energy = S(0);
    for (const Body<S>& body : mechanism_.bodies) {
      if (vanishes(body.armature)) continue;
      const S speed = rate(body, std::span<const S>(state.r_dot));
      energy = energy + body.armature * (speed * speed) / S(2);
    }
    return energy;
  }

  /// Power of the applied wrenches: of those that drive, and lost to those that dissipate. Needs twists().
  std::pair<S, S> applied_wrench_powers(const State<S>& state) {
    S driving = S(0), lost = S(0);
    for_each_applied_wrench(state, [&](const AppliedWrench<S>& of, const Spatial<S>& wrench) {
      const BodyMotion<S>& k = motions_[static_cast<std::size_t>(of.body)];
      if (of.dissipates) {
        lost = lost - dot(wrench.linear, k.v) - dot(wrench.angular, k.w);
      } else {
        driving = driving + dot(wrench.linear, k.v) + dot(wrench.angular, k.w);
      }
    });
    return {driving, lost};
  }

  [[nodiscard]] const Spatial<S>& base_wrench() const { return base_wrench_; }
  [[nodiscard]] const std::vector<S>& generalised_forces() const { return generalised_; }
  [[nodiscard]] const BodyMotion<S>& motion(int body) const {
    return motions_[static_cast<std::size_t>(body)];
  }
  [[nodiscard]] const BodyInertia<S>& inertia(int body) const {
    return joints_[static_cast<std::size_t>(body)].inertia;
  }
  [[nodiscard]] std::span<const S> no_acceleration() const { return zeros_; }

  /// Orientation and position of every body's frame in the world, eq. (70). Needs position().
  void poses(const State<S>& state, std::vector<Mat3<S>>& R, std::vector<Vec3<S>>& p) const {
    R.assign(mechanism_.bodies.size(), state.R);
    p.assign(mechanism_.bodies.size(), state.p);
    for (std::size_t k = 1; k < mechanism_.bodies.size(); ++k) {
      const auto parent = static_cast<std::size_t>(mechanism_.bodies[k].parent);
      mechanism_.section(mechanism_.bodies[k].name + ": pose");
      R[k] = R[parent];
      p[k] = p[parent];
      if (!mechanism_.bodies[k].station.modes.empty()) {
        p[k] += R[k] * joints_[k].station.offset();
        R[k] = R[k] * joints_[k].station.rotation();
      }
      p[k] += R[k] * joints_[k].offset;
      R[k] = R[k] * mechanism_.bodies[k].R * joints_[k].rotation.matrix();
    }
  }

 private:
  struct Joint {
    AxisRotation<S> rotation;
    Vec3<S> offset;  // of the body's origin in the frame of parent or station
    BodyInertia<S> inertia;
    StationFrame<S> station;
  };

  /// Motion of the frame that body k's pose is given in: its parent's, or that of its station.
  [[nodiscard]] const BodyMotion<S>& carrier(std::size_t k) const {
    const Body<S>& body = mechanism_.bodies[k];
    return body.station.modes.empty() ? motions_[static_cast<std::size_t>(body.parent)] : carriers_[k];
  }
  void move_station(std::size_t k, const State<S>& state) {
    const BodyMotion<S>& parent = motions_[static_cast<std::size_t>(mechanism_.bodies[k].parent)];
    const StationFrame<S>& station = joints_[k].station;
    const Spatial<S> own = station.velocity(std::span<const S>(state.r_dot));
    carriers_[k].v = station.to(parent.v + cross(parent.w, station.offset()) + own.linear);
    carriers_[k].w = station.to(parent.w + own.angular);
  }
  void accelerate_station(std::size_t k, const State<S>& state, std::span<const S> r_ddot) {
    const BodyMotion<S>& parent = motions_[static_cast<std::size_t>(mechanism_.bodies[k].parent)];
    const StationFrame<S>& station = joints_[k].station;
    const Spatial<S> velocity = station.velocity(std::span<const S>(state.r_dot));
    const Spatial<S> own = station.acceleration(std::span<const S>(state.r_dot), r_ddot);
    carriers_[k].a = station.to(parent.a + parent.U * station.offset() +
                                S(2) * cross(parent.w, velocity.linear) + own.linear);
    carriers_[k].wd = station.to(parent.wd + cross(parent.w, velocity.angular) + own.angular);
    if (has_fluid_) carriers_[k].gravity = station.to(parent.gravity);
    complete(carriers_[k]);
  }

  [[nodiscard]] Vec3<S> to_body(std::size_t k, const Vec3<S>& v) const {
    return joints_[k].rotation.apply_inverse(transposed_times(mechanism_.bodies[k].R, v));
  }
  [[nodiscard]] Vec3<S> to_parent(std::size_t k, const Vec3<S>& v) const {
    return mechanism_.bodies[k].R * joints_[k].rotation.apply(v);
  }
  [[nodiscard]] S displacement(const Body<S>& body, const State<S>& state) const {
    if (body.coordinate >= 0) return state.r[static_cast<std::size_t>(body.coordinate)];
    return body.coupling >= 0 ? coupling_values_[static_cast<std::size_t>(body.coupling)][0] : S(0);
  }
  /// First derivative of the displacement along r_dot.
  [[nodiscard]] S rate(const Body<S>& body, std::span<const S> r_dot) const {
    if (body.coordinate >= 0) return r_dot[static_cast<std::size_t>(body.coordinate)];
    S sum = S(0);
    if (body.coupling < 0) return sum;
    const Coupling<S>& c = mechanism_.couplings[static_cast<std::size_t>(body.coupling)];
    const auto& value = coupling_values_[static_cast<std::size_t>(body.coupling)];
    for (std::size_t i = 0; i < c.on.size(); ++i)
      sum = sum + value[1 + i] * r_dot[static_cast<std::size_t>(c.on[i])];
    return sum;
  }
  [[nodiscard]] S acceleration(const Body<S>& body, const State<S>& state, std::span<const S> r_ddot) const {
    S sum = rate(body, r_ddot);
    if (body.coupling < 0) return sum;
    const Coupling<S>& c = mechanism_.couplings[static_cast<std::size_t>(body.coupling)];
    const auto& value = coupling_values_[static_cast<std::size_t>(body.coupling)];
    for (std::size_t i = 0; i < c.on.size(); ++i) {
      for (std::size_t j = 0; j < c.on.size(); ++j) {
        sum = sum + value[1 + c.on.size() * (1 + i) + j] * (state.r_dot[static_cast<std::size_t>(c.on[i])] *
                                                            state.r_dot[static_cast<std::size_t>(c.on[j])]);
      }
    }
    return sum;
  }
  /// (translation along, rotation about) the axis for a joint rate or acceleration.
  [[nodiscard]] std::pair<S, S> along_axis(const Body<S>& body, const S& x) const {
    switch (body.kind) {
      case JointKind::revolute:
        return {S(0), x};
      case JointKind::prismatic:
        return {x, S(0)};
      case JointKind::helical:
        return {body.pitch * x, x};
      case JointKind::fixed:
        break;
    }
    return {S(0), S(0)};
  }
  void add_force(int coordinate, const S& force) {
    S& sum = generalised_[static_cast<std::size_t>(coordinate)];
    sum = sum + force;
  }
  /// What the armature of a joint needs; zero where there is none.
  [[nodiscard]] S rotor_force(const Body<S>& body, const State<S>& state, std::span<const S> r_ddot) const {
    if (vanishes(body.armature)) return S(0);
    return body.armature * acceleration(body, state, r_ddot);
  }
  /// Adds the joint's share of a wrench, and what its armature needs, to the coordinates that move it.
  void project(const Body<S>& body, const Spatial<S>& wrench, const S& rotor_force) {
    S force = S(0);
    if (body.kind == JointKind::revolute) force = wrench.angular[body.axis];
    if (body.kind == JointKind::prismatic) force = wrench.linear[body.axis];
    if (body.kind == JointKind::helical)
      force = wrench.angular[body.axis] + body.pitch * wrench.linear[body.axis];
    if (!vanishes(body.armature)) force = force + rotor_force;
    if (body.coordinate >= 0) add_force(body.coordinate, force);
    if (body.coupling < 0) return;
    const Coupling<S>& c = mechanism_.couplings[static_cast<std::size_t>(body.coupling)];
    for (std::size_t i = 0; i < c.on.size(); ++i)
      add_force(c.on[i], coupling_values_[static_cast<std::size_t>(body.coupling)][1 + i] * force);
  }
  /// Calls f(applied wrench, wrench about the body's origin in its axes) for every one.
  template <class F>
  void for_each_applied_wrench(const State<S>& state, const F& f) {
    poses(state, orientation_, position_);
    mechanism_.section("applied wrenches");
    for (const AppliedWrench<S>& w : mechanism_.wrenches) {
      const auto k = static_cast<std::size_t>(w.body);
      const Mat3<S> from = w.in_world_axes ? orientation_[k].transposed() : w.axes;
      const Spatial<S> velocity = {transposed_times(from, motions_[k].v + cross(motions_[k].w, w.point)),
                                   transposed_times(from, motions_[k].w)};
      w.evaluate(state, velocity, applied_);
      const Vec3<S> force = from * Vec3<S>{applied_[0], applied_[1], applied_[2]};
      const Vec3<S> torque = from * Vec3<S>{applied_[3], applied_[4], applied_[5]};
      f(w, Spatial<S>{force, torque + cross(w.point, force)});
    }
  }

  const Mechanism<S>& mechanism_;
  bool has_fluid_ = false;
  std::vector<Joint> joints_;
  std::vector<BodyMotion<S>> motions_, carriers_;  // of bodies; of the stations that they hang on
  std::vector<Spatial<S>> wrenches_;
  std::vector<std::vector<S>> coupling_values_;
  std::vector<S> applied_, force_, generalised_, zeros_, modal_;
  std::vector<Mat3<S>> orientation_;
  std::vector<Vec3<S>> position_;
  Spatial<S> base_wrench_;
};

}  // namespace anholon
