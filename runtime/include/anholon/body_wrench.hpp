// SPDX-License-Identifier: MIT
#pragma once

// What the motion of one body needs: its wrench about its origin and its modal forces. Rigid bodies take the
// form of Khalil and Kleinfinger 1987 with U = [wd] + [w][w]; compliant bodies add the rows of eq. (69),
// exact for the linear displacement field p = X + sum_j phi_j r_ej (terms of second order in r_e kept).

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
  Vec3<S> first_moment;                // m s
  Mat3<S> inertia;                     // I, about the origin
  std::vector<Mat3<S>> position_mode;  // integral of p phi_j^T dm
};

/// m s = m s_0 + sum S_j r_ej; I and C_j follow from the integrals of p p^T and p phi_j^T.
template <class S>
BodyInertia<S> inertia_in_shape(const Body<S>& body, std::span<const S> r) {
  BodyInertia<S> k{body.mass, body.first_moment, body.inertia, {}};
  const auto shape = [&](std::size_t j) { return r[static_cast<std::size_t>(body.modes[j].coordinate)]; };
  const auto add_second_moment = [&](const S& factor,
                                     const Mat3<S>& p) {  // I += factor (tr(p + p^T) 1 - (p + p^T)) / 2
    const S trace = p(0, 0) + p(1, 1) + p(2, 2);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const S symmetric = (p(i, j) + p(j, i)) / S(2);
        k.inertia(i, j) = k.inertia(i, j) + factor * (i == j ? trace - symmetric : -symmetric);
      }
    }
  };
  for (std::size_t j = 0; j < body.modes.size(); ++j) {
    k.first_moment += shape(j) * body.modes[j].S_j;
    add_second_moment(S(2) * shape(j), body.modes[j].X_phi);
    Mat3<S> p_phi = body.modes[j].X_phi;
    for (std::size_t l = 0; l < body.modes.size(); ++l) {
      const Mat3<S>& phi_phi = body.modes[l].phi_phi[j];  // integral of phi_l phi_j^T
      p_phi = p_phi + shape(l) * phi_phi;
      if (l == j) add_second_moment(shape(j) * shape(j), phi_phi);
      if (l < j) add_second_moment(S(2) * shape(l) * shape(j), phi_phi);
    }
    k.position_mode.push_back(p_phi);
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

  Vec3<S> S_rate, S_acceleration;
  Mat3<S> position_rate;  // integral of p d_dot^T
  for (std::size_t j = 0; j < body.modes.size(); ++j) {
    const Mode<S>& mode = body.modes[j];
    const S rate = r_dot[static_cast<std::size_t>(mode.coordinate)];
    const S acceleration = r_ddot[static_cast<std::size_t>(mode.coordinate)];
    S_rate += rate * mode.S_j;
    S_acceleration += acceleration * mode.S_j;
    position_rate = position_rate + rate * shape.position_mode[j];
    f.angular += acceleration * axial(shape.position_mode[j]);
  }
  f.linear += S(2) * cross(k.w, S_rate) + S_acceleration;
  const S trace = position_rate(0, 0) + position_rate(1, 1) + position_rate(2, 2);
  f.angular += S(2) * (trace * k.w - transposed_times(position_rate, k.w));  // 2 int p x (w x d_dot)

  for (std::size_t j = 0; j < body.modes.size(); ++j) {
    S force = dot(body.modes[j].S_j, k.a);
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) force = force + k.U(row, col) * shape.position_mode[j](col, row);
    }
    for (std::size_t l = 0; l < body.modes.size(); ++l) {
      const auto other = static_cast<std::size_t>(body.modes[l].coordinate);
      const Mat3<S>& phi_phi = body.modes[l].phi_phi[j];
      force = force + S(2) * (r_dot[other] * dot(k.w, axial(phi_phi)));  // 2 w . int d_dot x phi_j
      force = force + (phi_phi(0, 0) + phi_phi(1, 1) + phi_phi(2, 2)) * r_ddot[other];
    }
    modal_force[j] = force;
  }
  return f;
}

/// Kinetic energy of a body, from its twist and modal rates.
template <class S>
S kinetic_energy(const Body<S>& body, const BodyInertia<S>& shape, const BodyMotion<S>& k,
                 std::span<const S> r_dot) {
  S twice = shape.mass * dot(k.v, k.v) + S(2) * dot(k.v, cross(k.w, shape.first_moment)) +
            dot(k.w, shape.inertia * k.w);
  for (std::size_t j = 0; j < body.modes.size(); ++j) {
    const S rate = r_dot[static_cast<std::size_t>(body.modes[j].coordinate)];
    twice = twice + S(2) * rate * (dot(k.v, body.modes[j].S_j) + dot(k.w, axial(shape.position_mode[j])));
    for (std::size_t l = 0; l < body.modes.size(); ++l) {
      const Mat3<S>& phi_phi = body.modes[l].phi_phi[j];
      twice = twice + rate * r_dot[static_cast<std::size_t>(body.modes[l].coordinate)] *
                          (phi_phi(0, 0) + phi_phi(1, 1) + phi_phi(2, 2));
    }
  }
  return twice / S(2);
}

}  // namespace anholon
