// SPDX-License-Identifier: MIT
#pragma once

// What the motion of one body needs: its wrench about its origin and its modal forces. Rigid bodies take the
// form of Khalil and Kleinfinger 1987 with U = [wd] + [w][w]; compliant bodies add the rows of eq. (69).
// These are the equations of Lagrange for
//
//   T = m v^2/2 + v . (w x m s) + w . I w/2
//       + sum_j r_dot_j (v . S_j + w . C_j) + sum_jl m_jl r_dot_j r_dot_l/2
//
// with m s, I, S_j and C_j as polynomials of the shape: whatever these keep, the energy balance holds.

#include <span>
#include <vector>

#include "anholon/mechanism.hpp"

namespace anholon {

/// Velocity and acceleration of a body's frame, in its own axes.
template <class S>
struct BodyMotion {
  Vec3<S> v;                // velocity of the origin, m/s
  Vec3<S> w;                // angular velocity, rad/s
  Vec3<S> a;                // acceleration of the origin minus gravity (not the derivative of v), m/s^2
  Vec3<S> gravity;          // acceleration of gravity that a has taken off; kept where there is a fluid
  Vec3<S> wd;               // derivative of w
  Vec3<S> square, product;  // (w_x^2, w_y^2, w_z^2), (w_y w_z, w_z w_x, w_x w_y)
  Mat3<S> U;                // [wd] + [w][w]
};

/// Completes U from w and wd.
template <class S>
void complete(BodyMotion<S>& k) {
  k.square = {k.w.x * k.w.x, k.w.y * k.w.y, k.w.z * k.w.z};
  k.product = {k.w.y * k.w.z, k.w.z * k.w.x, k.w.x * k.w.y};
  k.U(0, 0) = -(k.square.y + k.square.z);
  k.U(1, 1) = -(k.square.x + k.square.z);
  k.U(2, 2) = -(k.square.x + k.square.y);
  k.U(0, 1) = k.product.z - k.wd.z;
  k.U(1, 0) = k.product.z + k.wd.z;
  k.U(0, 2) = k.product.y + k.wd.y;
  k.U(2, 0) = k.product.y - k.wd.y;
  k.U(1, 2) = k.product.x - k.wd.x;
  k.U(2, 1) = k.product.x + k.wd.x;
}

/// Mass properties of a body in its present shape.
template <class S>
struct BodyInertia {
  S mass = S(0);
  Vec3<S> first_moment;      // m s
  Mat3<S> inertia;           // I, about the origin
  std::vector<Vec3<S>> S_j;  // derivative of m s by r_j
  std::vector<Mat3<S>>
      N_j;  // integral of p (dp/dr_j)^T dm; C_j is its axial vector, dI/dr_j its symmetric part
};

/// S_j and N_j are linear in the shape; m s and the integral of p p^T are quadratic and follow from the means
/// of S_j and N_j between no deformation and the present one.
template <class S>
BodyInertia<S> inertia_in_shape(const Body<S>& body, std::span<const S> r) {
  BodyInertia<S> k{body.mass, body.first_moment, body.inertia, {}, {}};
  const auto shape = [&](std::size_t j) { return r[static_cast<std::size_t>(body.modes[j].coordinate)]; };
  for (std::size_t j = 0; j < body.modes.size(); ++j) {
    const Mode<S>& mode = body.modes[j];
    Vec3<S> S_change;
    Mat3<S> N_change;
    for (std::size_t l = 0; l < body.modes.size(); ++l) {
      S_change += shape(l) * mode.S_jl[l];
      N_change = N_change + shape(l) * mode.N_jl[l];
    }
    const Vec3<S> half_change = (S(1) / S(2)) * S_change;
    k.first_moment += shape(j) * (mode.S_j + half_change);
    Mat3<S> P;  // symmetric part of 2 N_j + N_change
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) {
        const S change = row == col ? N_change(row, row) : (N_change(row, col) + N_change(col, row)) / S(2);
        P(row, col) = mode.N_j(row, col) + mode.N_j(col, row) + change;
      }
    }
    const S trace = P(0, 0) + P(1, 1) + P(2, 2);
    for (int row = 0; row < 3; ++row) {  // I = tr 1 - P of P, the integral of p p^T
      for (int col = 0; col < 3; ++col) {
        const S entry = row == col ? trace - P(row, row) : -P(row, col);
        k.inertia(row, col) = k.inertia(row, col) + shape(j) * entry;
      }
    }
    k.S_j.push_back(mode.S_j + S_change);
    k.N_j.push_back(mode.N_j + N_change);
  }
  return k;
}

/// I wd + w x (I w), reusing U.
template <class S>
Vec3<S> rotational_moment(const Mat3<S>& I, const BodyMotion<S>& k) {
  const Mat3<S>& U = k.U;
  return {I(0, 0) * k.wd.x + (I(2, 2) - I(1, 1)) * k.product.x - I(0, 1) * U(2, 0) + I(0, 2) * U(1, 0) +
              I(1, 2) * (k.square.y - k.square.z),
          I(1, 1) * k.wd.y + (I(0, 0) - I(2, 2)) * k.product.y - I(1, 2) * U(0, 1) + I(0, 1) * U(2, 1) +
              I(0, 2) * (k.square.z - k.square.x),
          I(2, 2) * k.wd.z + (I(1, 1) - I(0, 0)) * k.product.z - I(0, 2) * U(1, 2) + I(1, 2) * U(0, 2) +
              I(0, 1) * (k.square.x - k.square.y)};
}

/// Wrench about the body's origin that its motion needs, without gravity if k.a carries it.
/// @param r_dot, r_ddot  all coordinates of the mechanism
/// @param modal_force  (modes of the body) written in full: generalised force that each mode needs
template <class S>
Spatial<S> body_wrench(const Body<S>& body, const BodyInertia<S>& shape, const BodyMotion<S>& k,
                       std::span<const S> r_dot, std::span<const S> r_ddot, std::vector<S>& modal_force) {
  Spatial<S> f;
  f.linear = shape.mass * k.a + k.U * shape.first_moment;  // m a + U m s
  f.angular =
      cross(shape.first_moment, k.a) + rotational_moment(shape.inertia, k);  // m s x a + I wd + w x I w
  modal_force.assign(body.modes.size(), S(0));
  if (body.modes.empty()) return f;

  Vec3<S> S_rate, S_acceleration, convected;
  Mat3<S> position_rate;  // integral of p p_dot^T
  const auto rate = [&](std::size_t j) { return r_dot[static_cast<std::size_t>(body.modes[j].coordinate)]; };
  const auto acceleration = [&](std::size_t j) {
    return r_ddot[static_cast<std::size_t>(body.modes[j].coordinate)];
  };
  for (std::size_t j = 0; j < body.modes.size(); ++j) {
    const Mode<S>& mode = body.modes[j];
    S_rate += rate(j) * shape.S_j[j];
    S_acceleration += acceleration(j) * shape.S_j[j];
    position_rate = position_rate + rate(j) * shape.N_j[j];
    f.angular += acceleration(j) * axial(shape.N_j[j]);
    for (std::size_t l = 0; l <= j; ++l) {  // second derivatives of the points along the rates
      const S product = rate(j) * rate(l);
      const Vec3<S> moment = axial(mode.N_jl[l]);
      convected += (l == j ? product : S(2) * product) * mode.S_jl[l];
      f.angular += product * (l == j ? moment : moment + axial(body.modes[l].N_jl[j]));
    }
  }
  f.linear += S(2) * cross(k.w, S_rate) + S_acceleration + convected;
  const S trace = position_rate(0, 0) + position_rate(1, 1) + position_rate(2, 2);
  f.angular += S(2) * (trace * k.w - transposed_times(position_rate, k.w));  // 2 int p x (w x p_dot)

  for (std::size_t j = 0; j < body.modes.size(); ++j) {
    const Mode<S>& mode = body.modes[j];
    S force = dot(shape.S_j[j], k.a);
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) force = force + k.U(row, col) * shape.N_j[j](col, row);
    }
    for (std::size_t l = 0; l < body.modes.size(); ++l) {
      if (l != j) {  // 2 w . int dp/dr_l x dp/dr_j
        const Vec3<S> gyroscopic = axial(mode.N_jl[l]) - axial(body.modes[l].N_jl[j]);
        force = force + rate(l) * dot(k.w, gyroscopic);
      }
      force = force + mode.m_jl[l] * acceleration(l);
    }
    modal_force[j] = force;
  }
  return f;
}

/// Wrench about the body's origin that the motion needs because of the fluid, buoyancy included.
template <class S>
Spatial<S> fluid_wrench(const AddedMass<S>& fluid, const BodyMotion<S>& k) {
  const Spatial<S> at = fluid.impulse(k.v, k.w);
  const Spatial<S> rate = fluid.impulse(k.a + k.gravity - cross(k.w, k.v), k.wd);
  return {rate.linear + cross(k.w, at.linear) + fluid.displaced * k.gravity,
          rate.angular + cross(k.w, at.angular) + cross(k.v, at.linear) +
              cross(fluid.displaced_moment, k.gravity)};
}

/// Kinetic energy of the fluid around a body.
template <class S>
S kinetic_energy(const AddedMass<S>& fluid, const BodyMotion<S>& k) {
  const Spatial<S> at = fluid.impulse(k.v, k.w);
  return (dot(k.v, at.linear) + dot(k.w, at.angular)) / S(2);
}

/// Kinetic energy of a body, from its twist and modal rates.
template <class S>
S kinetic_energy(const Body<S>& body, const BodyInertia<S>& shape, const BodyMotion<S>& k,
                 std::span<const S> r_dot) {
  S twice = shape.mass * dot(k.v, k.v) + S(2) * dot(k.v, cross(k.w, shape.first_moment)) +
            dot(k.w, shape.inertia * k.w);
  for (std::size_t j = 0; j < body.modes.size(); ++j) {
    const Mode<S>& mode = body.modes[j];
    const S& rate = r_dot[static_cast<std::size_t>(mode.coordinate)];
    twice = twice + S(2) * rate * (dot(k.v, shape.S_j[j]) + dot(k.w, axial(shape.N_j[j])));
    for (std::size_t l = 0; l < body.modes.size(); ++l)
      twice = twice + rate * r_dot[static_cast<std::size_t>(body.modes[l].coordinate)] * mode.m_jl[l];
  }
  return twice / S(2);
}

}  // namespace anholon
