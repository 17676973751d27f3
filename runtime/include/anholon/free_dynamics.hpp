// SPDX-License-Identifier: MIT
#pragma once

// The blocks of eq. (1) by sweeps of the recursion (section V.B), the rows of eq. (2), and the energies.
// Velocities and forces are vectors of size n + s: the free components of the reference twist, then every
// coordinate in declared order.

#include <utility>
#include <vector>

#include "anholon/matrix.hpp"
#include "anholon/recursion.hpp"

namespace anholon {

/// n + s
template <class S>
int velocity_size(const Mechanism<S>& mechanism) {
  return static_cast<int>(free_components(mechanism.group).size()) + mechanism.coordinates;
}

/// Splits a velocity or acceleration vector of size n + s into twist and coordinates.
template <class S>
void scatter(const Mechanism<S>& mechanism, std::span<const S> v, Spatial<S>& eta, std::vector<S>& r_dot) {
  const auto components = free_components(mechanism.group);
  eta = {};
  for (std::size_t i = 0; i < components.size(); ++i) eta[components[i]] = v[i];
  r_dot.assign(v.begin() + static_cast<std::ptrdiff_t>(components.size()), v.end());
}

template <class S>
class FreeDynamics {
 public:
  explicit FreeDynamics(const Mechanism<S>& mechanism) : mechanism_(mechanism), recursion_(mechanism) {}

  /// Generalised forces (n + s) that an acceleration v_dot (n + s) needs at a state: M v_dot - (f, Q).
  std::vector<S> inverse_dynamics(const State<S>& state, std::span<const S> v_dot) {
    scatter(mechanism_, v_dot, eta_dot_, r_ddot_);
    recursion_.position(state);
    recursion_.twists(state);
    recursion_.accelerations(state, eta_dot_, r_ddot_, true);
    recursion_.wrenches(state, r_ddot_, true);
    return gathered();
  }

  /// (f, Q) of eq. (1): all zero accelerations, with the minus sign of eq. (28).
  std::vector<S> forces(const State<S>& state) {
    const std::vector<S> zero(static_cast<std::size_t>(velocity_size(mechanism_)), S(0));
    std::vector<S> h = inverse_dynamics(state, zero);
    for (S& x : h) x = -x;
    return h;
  }

  /// M x: one sweep at rest, without gravity or applied forces.
  std::vector<S> mass_times(const State<S>& state, std::span<const S> x) {
    State<S> rest = at_rest(state);
    scatter(mechanism_, x, eta_dot_, r_ddot_);
    recursion_.position(rest);
    recursion_.twists(rest);
    recursion_.accelerations(rest, eta_dot_, r_ddot_, false);
    recursion_.wrenches(rest, r_ddot_, false);
    return gathered();
  }

  /// Mass matrix of eq. (1), column by column; the upper triangle mirrors the lower one.
  Matrix<S> mass_matrix(const State<S>& state) {
    const int size = velocity_size(mechanism_);
    Matrix<S> M(size, size);
    for (int k = 0; k < size; ++k) {
      std::vector<S> e(static_cast<std::size_t>(size), S(0));
      e[static_cast<std::size_t>(k)] = S(1);
      const std::vector<S> column = mass_times(state, e);
      for (int i = k; i < size; ++i) M(i, k) = M(k, i) = column[static_cast<std::size_t>(i)];
    }
    return M;
  }

  /// (A, B) of eq. (2) with B for all coordinates in declared order, rows x (n + s), and the bias (A_dot,
  /// B_dot) v.
  std::pair<Matrix<S>, std::vector<S>> constraints(const State<S>& state) {
    const int size = velocity_size(mechanism_);
    const int rows = static_cast<int>(mechanism_.rows.size());
    Matrix<S> G(rows, size);
    std::vector<S> bias(mechanism_.rows.size(), S(0));
    recursion_.position(state);
    bool declared = false;
    for (int i = 0; i < rows; ++i) {
      const ConstraintRow<S>& row = mechanism_.rows[static_cast<std::size_t>(i)];
      declared = declared || !row.terms.empty();
      if (!row.written) continue;
      std::vector<S> values(7 + static_cast<std::size_t>(mechanism_.coordinates), S(0));
      row.written(state, values);
      const auto components = free_components(mechanism_.group);
      int column = 0;
      for (const int c : components) G(i, column++) = values[static_cast<std::size_t>(c)];
      for (int c = 0; c < mechanism_.coordinates; ++c)
        G(i, column++) = values[static_cast<std::size_t>(6 + c)];
      bias[static_cast<std::size_t>(i)] = values.back();
    }
    if (!declared) return {G, bias};

    for (int k = 0; k < size; ++k) {  // coefficients: row values of unit velocities
      std::vector<S> e(static_cast<std::size_t>(size), S(0));
      e[static_cast<std::size_t>(k)] = S(1);
      State<S> moving = state;
      scatter(mechanism_, std::span<const S>(e), moving.eta, moving.r_dot);
      recursion_.twists(moving);
      for (int i = 0; i < rows; ++i) {
        const ConstraintRow<S>& row = mechanism_.rows[static_cast<std::size_t>(i)];
        for (const RowTerm<S>& term : row.terms) {
          const BodyMotion<S>& body = recursion_.motion(term.body);
          G(i, k) = G(i, k) + dot(term.linear, body.v) + dot(lever(term), body.w);
        }
      }
    }
    recursion_.twists(state);
    recursion_.accelerations(state, Spatial<S>{}, recursion_.no_acceleration(), false);
    for (int i = 0; i < rows; ++i) {
      const ConstraintRow<S>& row = mechanism_.rows[static_cast<std::size_t>(i)];
      for (const RowTerm<S>& term : row.terms) {
        const BodyMotion<S>& body = recursion_.motion(term.body);
        S& sum = bias[static_cast<std::size_t>(i)];  // the derivative of v's components is a - w x v
        sum = sum + dot(term.linear, body.a - cross(body.w, body.v)) + dot(lever(term), body.wd);
      }
    }
    return {G, bias};
  }

  /// Values of the conditions on the position and their derivatives by the velocities, conditions x (n + s).
  std::pair<std::vector<S>, Matrix<S>> conditions(const State<S>& state) const {
    const int count = mechanism_.conditions;
    const std::size_t width = 7 + static_cast<std::size_t>(mechanism_.coordinates);
    std::vector<S> written(static_cast<std::size_t>(count) * width, S(0));
    if (count > 0) mechanism_.position_conditions(state, written);
    std::vector<S> values;
    Matrix<S> slopes(count, velocity_size(mechanism_));
    for (int i = 0; i < count; ++i) {
      const std::span<const S> row =
          std::span<const S>(written).subspan(static_cast<std::size_t>(i) * width, width);
      values.push_back(row[0]);
      int column = 0;
      for (const int c : free_components(mechanism_.group))
        slopes(i, column++) = row[1 + static_cast<std::size_t>(c)];
      for (int c = 0; c < mechanism_.coordinates; ++c)
        slopes(i, column++) = row[static_cast<std::size_t>(7 + c)];
    }
    return {values, slopes};
  }

  struct Energies {
    S kinetic, gravity, elastic, dissipated_power, applied_power;  // J, J, J, W, W
  };
  /// Kinetic energy of bodies and fluid; potential of gravity and buoyancy (zero at the world's origin);
  /// user, spring and modal energy; power lost to the dissipation function and to forces that dissipate;
  /// power of the other forces and wrenches.
  Energies energies(const State<S>& state) {
    Energies e{S(0), S(0), S(0), S(0), S(0)};
    recursion_.position(state);
    recursion_.twists(state);
    recursion_.poses(state, R_, p_);
    for (std::size_t k = 0; k < mechanism_.bodies.size(); ++k) {
      const int body = static_cast<int>(k);
      mechanism_.section(mechanism_.bodies[k].name + ": energy");
      const BodyInertia<S>& inertia = recursion_.inertia(body);
      e.kinetic = e.kinetic + kinetic_energy(mechanism_.bodies[k], inertia, recursion_.motion(body),
                                             std::span<const S>(state.r_dot));
      e.gravity = e.gravity - dot(mechanism_.gravity, inertia.mass * p_[k] + R_[k] * inertia.first_moment);
      if (!mechanism_.bodies[k].fluid) continue;
      const AddedMass<S>& fluid = *mechanism_.bodies[k].fluid;
      e.kinetic = e.kinetic + kinetic_energy(fluid, recursion_.motion(body));
      e.gravity =
          e.gravity + dot(mechanism_.gravity, fluid.displaced * p_[k] + R_[k] * fluid.displaced_moment);
    }
    e.kinetic = e.kinetic + recursion_.rotor_energy(state);
    if (mechanism_.user_energies) {
      std::vector<S> user(3, S(0));
      mechanism_.user_energies(state, user);
      e.elastic = user[0];
      e.dissipated_power = user[1];
      e.applied_power = user[2];
    }
    if (!mechanism_.wrenches.empty()) {
      const auto [driving, lost] = recursion_.applied_wrench_powers(state);
      e.applied_power = e.applied_power + driving;
      e.dissipated_power = e.dissipated_power + lost;
    }
    return e;
  }

  /// Poses of the described body frames in the world.
  void poses(const State<S>& state, std::vector<Mat3<S>>& R, std::vector<Vec3<S>>& p) {
    recursion_.position(state);
    recursion_.poses(state, R, p);
    for (std::size_t k = 0; k < R.size(); ++k) R[k] = R[k] * mechanism_.bodies[k].R_frame;
  }

 private:
  static Vec3<S> lever(const RowTerm<S>& term) { return term.angular + cross(term.point, term.linear); }

  State<S> at_rest(const State<S>& state) const {
    State<S> rest = state;
    rest.eta = {};
    rest.r_dot.assign(state.r.size(), S(0));
    return rest;
  }

  [[nodiscard]] std::vector<S> gathered() const {
    std::vector<S> forces;
    for (const int c : free_components(mechanism_.group)) forces.push_back(recursion_.base_wrench()[c]);
    forces.insert(forces.end(), recursion_.generalised_forces().begin(),
                  recursion_.generalised_forces().end());
    return forces;
  }

  const Mechanism<S>& mechanism_;
  Recursion<S> recursion_;
  Spatial<S> eta_dot_;
  std::vector<S> r_ddot_;
  std::vector<Mat3<S>> R_;
  std::vector<Vec3<S>> p_;
};

}  // namespace anholon
