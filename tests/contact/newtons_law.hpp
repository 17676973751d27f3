// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Newton's law for a whole robot: what its contact forces add up to.

#include <functional>
#include <string>
#include <vector>

#include "anholon/free_dynamics.hpp"
#include "describe/model.hpp"
#include "number/exact.hpp"

namespace anholon::test {

/// Sum of the contact forces, less the rate of the momentum, plus the weight, in world axes, N: zero.
/// The momentum is that of the mass matrix, its rate a central difference with an error of 1e-36.
///
/// @param acceleration  (6 + s) of the twist and of all coordinates
/// @param carrier       of a contact: the body in whose axes its rows x, y and z are
inline Vec3<Exact> unbalanced_force(const Model& model, const Mechanism<Exact>& mechanism,
                                    const State<Exact>& state, const std::vector<Exact>& acceleration,
                                    const std::vector<Exact>& lambda,
                                    const std::function<std::size_t(const std::string&)>& carrier) {
  FreeDynamics<Exact> dynamics(mechanism);
  const auto momentum = [&](const Exact& h) {
    State<Exact> s = state;
    s.R = state.R + h * (state.R * skew(state.eta.angular));
    std::vector<Exact> v;
    for (int c = 0; c < 6; ++c) v.push_back(state.eta[c] + h * acceleration[static_cast<std::size_t>(c)]);
    for (std::size_t i = 0; i < s.r.size(); ++i) {
      s.r[i] += h * state.r_dot[i];
      v.push_back(state.r_dot[i] + h * acceleration[6 + i]);
    }
    const std::vector<Exact> p = dynamics.mass_times(s, v);
    return s.R * Vec3<Exact>{p[0], p[1], p[2]};
  };
  const Exact h = Exact::from_decimal("1e-18");
  Vec3<Exact> sum = (Exact(-1) / (h + h)) * (momentum(h) - momentum(-h));
  Exact mass = 0;
  for (const auto& body : mechanism.bodies) mass += body.mass;
  sum += mass * mechanism.gravity;
  std::vector<Mat3<Exact>> R;
  std::vector<Vec3<Exact>> p;
  dynamics.poses(state, R, p);
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const std::string& row = model.rows[i].name;
    if (row.find("_turn_") != std::string::npos) continue;  // a moment
    sum += R[carrier(model.rows[i].contact)] * (lambda[i] * unit<Exact>(row.back() - 'x'));
  }
  return sum;
}

}  // namespace anholon::test
