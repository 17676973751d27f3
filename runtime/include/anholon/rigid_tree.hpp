// SPDX-License-Identifier: MIT
#pragma once

// Dynamics of a tree of rigid bodies in as few operations as are known: the recursion of Luh, Walker and Paul
// about joint frames, in the form of Khalil and Kleinfinger 1987 with U = [wd] + [w][w], and two steps beyond
// it:
//
// - The second derivative of a joint's axis n is U n, the same in the parent and in the body. One column of U
//   comes from the parent's by the turn of a vector, and the others follow from it and w; wd is never formed
//   across the axis.
// - The body's moment is taken from the second moment Sigma (second_moment.hpp), where Sigma_nn = 0 after
//   regrouping.
//
// Bodies have no modes here. What the tape does not need, it does not keep; numbers pay for all components.

#include <cmath>
#include <stdexcept>
#include <vector>

#include "anholon/mechanism.hpp"
#include "anholon/second_moment.hpp"

namespace anholon {

/// A joint at a position: x_parent = R (rotation x + ...) + offset.
template <class S>
struct JointTransform {
  Mat3<S> R;
  AxisRotation<S> rotation;
  Vec3<S> offset;         // of the body's origin in the parent's frame
  S displacement = S(0);  // of the joint, rad or m

  [[nodiscard]] Vec3<S> to_body(const Vec3<S>& v) const {
    return rotation.apply_inverse(transposed_times(R, v));
  }
  [[nodiscard]] Vec3<S> to_parent(const Vec3<S>& v) const { return R * rotation.apply(v); }
  /// A wrench about the body's origin as one about the parent's.
  [[nodiscard]] Spatial<S> to_parent(const Spatial<S>& f) const {
    const Vec3<S> force = to_parent(f.linear);
    return {force, to_parent(f.angular) + cross(offset, force)};
  }
};

template <class S>
class RigidTree {
 public:
  struct Motion {
    Vec3<S> w;        // angular velocity, rad/s
    Vec3<S> a;        // acceleration of the origin minus gravity, m/s^2
    Mat3<S> U;        // [wd] + [w][w]
    Vec3<S> squares;  // of w
    /// wd about coordinate axis j, from U.
    [[nodiscard]] S angular_acceleration(int j) const {
      const int i = (j + 1) % 3;
      const int k = (j + 2) % 3;
      return vanishes(known_wd[j]) ? U(k, i) - w[i] * w[k] : known_wd[j];
    }
    Vec3<S> known_wd;  // components that are at hand; zero where they are not
  };

  explicit RigidTree(const Mechanism<S>& mechanism) : mechanism_(mechanism) {
    for (const Body<S>& body : mechanism.bodies) {
      if (!body.modes.empty()) throw std::invalid_argument("body '" + body.name + "' is not rigid");
      moments_.push_back({body.mass, body.first_moment, second_moment(body.inertia)});
    }
    for (const Coupling<S>& c : mechanism.couplings)
      couplings_.emplace_back(1 + c.on.size() * (1 + c.on.size()), S(0));
    joints_.resize(mechanism.bodies.size());
    rotor_force_.assign(mechanism.bodies.size(), S(0));
    motions_.resize(mechanism.bodies.size());
  }

  /// Joint transformations at r.
  void position(const std::vector<S>& r) {
    using std::cos, std::sin;
    mechanism_.section("joint angles");
    for (std::size_t c = 0; c < couplings_.size(); ++c) mechanism_.couplings[c].evaluate(r, couplings_[c]);
    for (std::size_t k = 0; k < size(); ++k) {
      const Body<S>& b = body(k);
      const S q = displacement(b, r);
      JointTransform<S>& joint = joints_[k];
      joint = {b.R, {b.axis, S(1), S(0)}, b.p, q};
      if (turns(b)) joint.rotation.c = cos(q), joint.rotation.s = sin(q);
      if (b.kind == JointKind::prismatic) joint.offset += b.R * (q * unit<S>(b.axis));
      if (b.kind == JointKind::helical) joint.offset += b.R * (b.pitch * q * unit<S>(b.axis));
    }
  }

  /// Motion of the reference body: angular velocity, its derivative, acceleration of the origin minus
  /// gravity.
  void move_base(const Vec3<S>& w, const Vec3<S>& wd, const Vec3<S>& a) {
    Motion& base = motions_[0];
    base.w = w;
    base.a = a;
    base.known_wd = wd;
    base.squares = {w.x * w.x, w.y * w.y, w.z * w.z};
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      const S product = w[j] * w[k];
      base.U(i, i) = -(base.squares[j] + base.squares[k]);
      base.U(k, j) = product + wd[i];
      base.U(j, k) = product - wd[i];
    }
  }

  /// Motions of all bodies for the rates and accelerations of the coordinates. Needs position() and
  /// move_base().
  void move(const std::vector<S>& r_dot, const std::vector<S>& r_ddot) {
    for (std::size_t k = 1; k < size(); ++k) {
      const Body<S>& b = body(k);
      mechanism_.section(b.name + ": motion");
      const Motion& parent = motions_[parent_of(k)];
      Motion& m = motions_[k];
      const S rate = joint_rate(b, r_dot);
      const S acceleration = joint_rate(b, r_ddot) + coupling_bias(b, r_dot);
      if (!vanishes(b.armature)) rotor_force_[k] = b.armature * acceleration;
      const int n = b.axis;
      m.a = joints_[k].to_body(parent.a + parent.U * joints_[k].offset);
      m.w = joints_[k].to_body(parent.w);
      if (b.kind == JointKind::prismatic || b.kind == JointKind::fixed) {
        carry(joints_[k], parent, m);
      } else {
        turn(b, k, parent, rate, acceleration, m);
      }
      if (b.kind != JointKind::prismatic && b.kind != JointKind::helical) continue;
      const S along = b.kind == JointKind::helical ? b.pitch : S(1);
      m.a += cross(m.w, (S(2) * along * rate) * unit<S>(n));  // the axis part of w drops out
      m.a[n] = m.a[n] + along * acceleration;
    }
  }

  /// Wrench about its origin that the motion of a body needs.
  [[nodiscard]] Spatial<S> body_wrench(std::size_t k) const { return body_wrench(moments_[k], motions_[k]); }
  [[nodiscard]] static Spatial<S> body_wrench(const MassMoments<S>& b, const Motion& m) {
    return {b.mass * m.a + m.U * b.first, cross(b.first, m.a) + rotational_moment(b.second, m)};
  }

  /// Wrenches from the tips to the reference body; the forces of the coordinates, and what armatures need of
  /// them, are added up.
  /// @param wrench  (bodies) what each body needs; written over with what each joint transmits
  /// @param force  (coordinates) is added to
  void transmit(std::vector<Spatial<S>>& wrench, std::vector<S>& force) const {
    for (std::size_t k = size(); k-- > 1;) {
      mechanism_.section(body(k).name + ": joint force");
      S f_joint = joint_force(body(k), wrench[k]);
      if (!vanishes(body(k).armature)) f_joint = f_joint + rotor_force_[k];
      add_force(k, f_joint, force);
      const Spatial<S> f = joints_[k].to_parent(wrench[k]);
      wrench[parent_of(k)].linear += f.linear;
      wrench[parent_of(k)].angular += f.angular;
    }
  }

  /// Joint forces for the motions at hand, and the base wrench.
  std::vector<S> inverse_dynamics(Spatial<S>& base_wrench) const {
    std::vector<S> force(static_cast<std::size_t>(mechanism_.coordinates), S(0));
    std::vector<Spatial<S>> wrench(size());
    for (std::size_t k = 0; k < size(); ++k) {
      mechanism_.section(body(k).name + ": wrench");
      wrench[k] = body_wrench(k);
    }
    transmit(wrench, force);
    base_wrench = wrench[0];
    return force;
  }

  [[nodiscard]] std::size_t size() const { return mechanism_.bodies.size(); }
  [[nodiscard]] const Mechanism<S>& mechanism() const { return mechanism_; }
  [[nodiscard]] const Body<S>& body(std::size_t k) const { return mechanism_.bodies[k]; }
  [[nodiscard]] std::size_t parent_of(std::size_t k) const {
    return static_cast<std::size_t>(body(k).parent);
  }
  [[nodiscard]] const JointTransform<S>& joint(std::size_t k) const { return joints_[k]; }
  [[nodiscard]] const MassMoments<S>& moments(std::size_t k) const { return moments_[k]; }
  [[nodiscard]] const Motion& motion(std::size_t k) const { return motions_[k]; }
  [[nodiscard]] bool moves(std::size_t k) const { return body(k).coordinate >= 0 || body(k).coupling >= 0; }
  /// The coordinate whose rate is that of body k's joint, where no other coordinate moves it; else -1. Needs
  /// position().
  [[nodiscard]] int own_coordinate(std::size_t k) const {
    int coordinate = -1;
    int shares = 0;
    for_each_share(k, [&](int c, const S& share) {
      ++shares;
      if (vanishes(share - S(1))) coordinate = c;
    });
    return shares == 1 ? coordinate : -1;
  }

  /// Component of a wrench that does work on the joint.
  [[nodiscard]] static S joint_force(const Body<S>& b, const Spatial<S>& f) {
    switch (b.kind) {
      case JointKind::revolute:
        return f.angular[b.axis];
      case JointKind::prismatic:
        return f.linear[b.axis];
      case JointKind::helical:
        return f.angular[b.axis] + b.pitch * f.linear[b.axis];
      case JointKind::fixed:
        break;
    }
    return S(0);
  }
  /// Adds a joint's force to the coordinates that move it.
  void add_force(std::size_t k, const S& f, std::vector<S>& force) const {
    for_each_share(k, [&](int c, const S& share) {
      S& sum = force[static_cast<std::size_t>(c)];
      sum = sum + share * f;
    });
  }
  /// Calls use(coordinate, d displacement / d coordinate) for what moves body k's joint.
  template <class Use>
  void for_each_share(std::size_t k, const Use& use) const {
    const Body<S>& b = body(k);
    if (b.coordinate >= 0) use(b.coordinate, S(1));
    if (b.coupling < 0) return;
    const Coupling<S>& c = mechanism_.couplings[static_cast<std::size_t>(b.coupling)];
    for (std::size_t i = 0; i < c.on.size(); ++i)
      use(c.on[i], couplings_[static_cast<std::size_t>(b.coupling)][1 + i]);
  }

 private:
  static bool turns(const Body<S>& b) {
    return b.kind == JointKind::revolute || b.kind == JointKind::helical;
  }

  /// The parent's angular motion in the body's axes.
  static void carry(const JointTransform<S>& joint, const Motion& parent, Motion& m) {
    Mat3<S> half;  // rows of U R: each column of (U R)^T is turned
    for (int i = 0; i < 3; ++i) {
      const Vec3<S> row = joint.to_body({parent.U(i, 0), parent.U(i, 1), parent.U(i, 2)});
      for (int j = 0; j < 3; ++j) half(i, j) = row[j];
    }
    for (int j = 0; j < 3; ++j) {
      const Vec3<S> column = joint.to_body({half(0, j), half(1, j), half(2, j)});
      for (int i = 0; i < 3; ++i) m.U(i, j) = column[i];
    }
    m.known_wd = {};
    for (int i = 0; i < 3; ++i) m.squares[i] = m.w[i] * m.w[i];
  }

  /// Adds the joint's own turning, with the column of U along the axis as a vector fixed to parent and body.
  void turn(const Body<S>& b, std::size_t k, const Motion& parent, const S& rate, const S& acceleration,
            Motion& m) const {
    const int z = b.axis;
    const int x = (z + 1) % 3;
    const int y = (z + 2) % 3;
    const Vec3<S> n = b.R * unit<S>(z);  // the axis in the parent
    const Vec3<S> column = joints_[k].to_body(parent.U * n);
    S about_axis = S(0);
    for (int j = 0; j < 3; ++j) {
      if (!vanishes(n[j])) about_axis = about_axis + n[j] * parent.angular_acceleration(j);
    }
    m.w[z] = m.w[z] + rate;
    m.known_wd = {};
    m.known_wd[z] = about_axis + acceleration;
    const S twice = m.w[z] + m.w[z];
    const S product = m.w[x] * m.w[y];
    m.squares = {m.w.x * m.w.x, m.w.y * m.w.y, m.w.z * m.w.z};
    m.U(x, z) = column[x];
    m.U(y, z) = column[y];
    m.U(z, z) = column[z];
    m.U(z, x) = m.w[x] * twice - column[x];
    m.U(z, y) = m.w[y] * twice - column[y];
    m.U(y, x) = product + m.known_wd[z];
    m.U(x, y) = product - m.known_wd[z];
    m.U(x, x) = -(m.squares[y] + m.squares[z]);
    m.U(y, y) = -(m.squares[x] + m.squares[z]);
  }

  /// integral of X x (U X) dm: component i is Sigma_jj U_kj - Sigma_kk U_jk + ... for (i, j, k) cyclic.
  static Vec3<S> rotational_moment(const Symmetric3<S>& Sigma, const Motion& m) {
    Vec3<S> N;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      N[i] = Sigma(j, j) * m.U(k, j) - Sigma(k, k) * m.U(j, k) + Sigma(i, j) * m.U(k, i) -
             Sigma(i, k) * m.U(j, i) + Sigma(j, k) * (m.squares[k] - m.squares[j]);
    }
    return N;
  }

  [[nodiscard]] S displacement(const Body<S>& b, const std::vector<S>& r) const {
    if (b.coordinate >= 0) return r[static_cast<std::size_t>(b.coordinate)];
    return b.coupling >= 0 ? couplings_[static_cast<std::size_t>(b.coupling)][0] : S(0);
  }
  [[nodiscard]] S joint_rate(const Body<S>& b, const std::vector<S>& r_dot) const {
    S sum = S(0);
    for_each_share(static_cast<std::size_t>(&b - mechanism_.bodies.data()),
                   [&](int c, const S& share) { sum = sum + share * r_dot[static_cast<std::size_t>(c)]; });
    return sum;
  }
  /// Second derivative of a coupled displacement along the rates.
  [[nodiscard]] S coupling_bias(const Body<S>& b, const std::vector<S>& r_dot) const {
    S sum = S(0);
    if (b.coupling < 0) return sum;
    const Coupling<S>& c = mechanism_.couplings[static_cast<std::size_t>(b.coupling)];
    const auto& value = couplings_[static_cast<std::size_t>(b.coupling)];
    for (std::size_t i = 0; i < c.on.size(); ++i) {
      for (std::size_t j = 0; j < c.on.size(); ++j)
        sum = sum + value[1 + c.on.size() * (1 + i) + j] *
                        (r_dot[static_cast<std::size_t>(c.on[i])] * r_dot[static_cast<std::size_t>(c.on[j])]);
    }
    return sum;
  }

  const Mechanism<S>& mechanism_;
  std::vector<MassMoments<S>> moments_;
  std::vector<std::vector<S>> couplings_;
  std::vector<JointTransform<S>> joints_;
  std::vector<Motion> motions_;
  std::vector<S> rotor_force_;  // that the armature of each joint needs for the motion at hand
};

}  // namespace anholon
