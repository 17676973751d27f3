// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A second description of a small robot, by the positions of its masses: what the blocks of eq. (1), the
// energies and the power must be, from d'Alembert's principle on the masses alone. Every description is tried
// at 100 random states, by the recursion in double and in long double, and by the derived program.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "anholon/matrix.hpp"
#include "anholon/mechanism.hpp"
#include "describe/read_model.hpp"
#include "mechanics/jet.hpp"

namespace anholon::test {

struct MassPoint {
  Real mass;
  Vector at;  // in the world
};

/// Position and velocity of a robot. The numbers are doubles, but for the rotation, which is orthonormal to
/// the last digit.
struct Sample {
  State<Real> state;
};

struct Load {
  Vector force, torque;  // in the world, the force at the frame's origin
};

struct Witness {
  std::string description;
  std::function<std::vector<MassPoint>(const Pose& g, const std::vector<Jet>& r)> masses;
  std::array<Real, 3> gravity{};
  std::function<Jet(const Pose& g, const std::vector<Jet>& r)> potential;  // all but gravity
  /// Generalised forces on (eta, r_dot) besides those of potential and loads.
  std::function<std::vector<Real>(const Sample&)> forces;
  std::function<Real(const Sample&)> dissipated_power;
  std::function<std::vector<Pose>(const Pose& g, const std::vector<Jet>& r)> loaded_frames;
  std::function<std::vector<Load>(const Sample&, const std::vector<Pose>& frames)> loads;
};

// ---- descriptions of bodies
// -------------------------------------------------------------------------------------

/// Masses fixed in a body: (mass, x, y, z).
using Cloud = std::vector<std::array<double, 4>>;

inline void add(std::vector<MassPoint>& to, const Pose& body, const Cloud& cloud) {
  for (const auto& [m, x, y, z] : cloud) to.push_back({m, body * Vector(x, y, z)});
}

/// The inertia of a cloud as the value of the key `inertia`.
inline std::string inertia(const Cloud& cloud, bool about_com = true) {
  Real mass = 0;
  std::array<Real, 3> first{};
  for (const auto& [m, x, y, z] : cloud) {
    const std::array<Real, 3> at = {x, y, z};
    mass += m;
    for (std::size_t i = 0; i < 3; ++i) first[i] += Real(m) * at[i];
  }
  std::array<Real, 3> origin{};
  if (about_com) {
    for (std::size_t i = 0; i < 3; ++i) origin[i] = first[i] / mass;
  }
  std::array<std::array<Real, 3>, 3> I{};
  for (const auto& [m, x, y, z] : cloud) {
    const std::array<Real, 3> at = {x - origin[0], y - origin[1], z - origin[2]};
    const Real square = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) I[i][j] += Real(m) * ((i == j ? square : 0) - at[i] * at[j]);
    }
  }
  const auto text = [](Real x) { return fmt::format("{:.21g}", x); };
  const std::array<Real, 3>& at = about_com ? origin : first;
  return fmt::format(
      "{{ mass = {}, {} = [{}, {}, {}], {} = {{ xx = {}, yy = {}, zz = {}, xy = {}, xz = {}, yz = {} }} }}",
      text(mass), about_com ? "com" : "first_moment", text(at[0]), text(at[1]), text(at[2]),
      about_com ? "about_com" : "about_origin", text(I[0][0]), text(I[1][1]), text(I[2][2]), text(I[0][1]),
      text(I[0][2]), text(I[1][2]));
}

inline std::string header(const std::string& group, const std::string& rest = "") {
  return fmt::format("anholon = 1\nname = \"witness\"\ngroup = \"{}\"\n{}\n", group, rest);
}
/// @param rest  further lines: pose, joint, beam
inline std::string body(const std::string& name, const std::string& parent, const Cloud& cloud,
                        const std::string& rest = "", bool about_com = true) {
  std::string text = fmt::format("[[body]]\nname = \"{}\"\n", name);
  if (!parent.empty()) text += fmt::format("parent = \"{}\"\n", parent);
  if (!cloud.empty()) text += fmt::format("inertia = {}\n", inertia(cloud, about_com));
  return text + rest + "\n";
}

/// Three clouds that have no symmetry.
inline const Cloud& cloud(std::size_t i) {
  static const std::vector<Cloud> clouds = {
      {{1.2, 0.3, -0.1, 0.2}, {0.7, -0.2, 0.25, 0.1}, {0.9, 0.05, 0.15, -0.35}, {0.4, -0.3, -0.2, -0.1}},
      {{0.5, 0.4, 0.1, 0}, {0.8, 0.1, -0.3, 0.15}, {0.3, -0.15, 0.2, 0.3}, {0.6, 0.2, 0.05, -0.25}},
      {{0.25, -0.1, 0.3, 0.2}, {0.35, 0.25, 0.2, -0.1}, {0.45, 0.1, -0.2, 0.25}, {0.2, 0.3, -0.05, 0.05}}};
  return clouds[i % clouds.size()];
}

// ---- motions
// ----------------------------------------------------------------------------------------------------

/// The reference body moving with eta + t eta_dot: R_ddot = R (W W + W_dot), p_ddot = R (V_dot + Omega x V).
Pose base_motion(const State<Real>& s, const std::array<Real, 6>& eta, const std::array<Real, 6>& eta_dot);

/// Pose and shape along a motion with velocity v and acceleration v_dot (n + s).
struct Path {
  Pose g;
  std::vector<Jet> r;
};
Path path(GroupKind group, const State<Real>& s, const std::vector<Real>& v, const std::vector<Real>& v_dot);

std::vector<Real> velocity(GroupKind group, const State<Real>& s);

/// A state within the group: angles to +-3 rad, lengths to +-0.5 m, rates to +-2.
State<Real> random_position_and_velocity(const Model& model, std::mt19937_64& rng);

// ---- comparison
// -------------------------------------------------------------------------------------------------

/// Errors of blocks over their natural scale: the largest magnitude in the block at that state, but not below
/// the median of these over the states.
class BlockErrors {
 public:
  template <class T>
  void add(const std::string& block, const std::vector<Real>& want, const std::vector<T>& have) {
    ASSERT_EQ(want.size(), have.size()) << block;
    if (want.empty()) return;
    Entry e;
    for (std::size_t i = 0; i < want.size(); ++i) {
      e.size = std::max(e.size, std::abs(want[i]));
      const Real error = std::abs(want[i] - static_cast<Real>(have[i]));
      if (!(error <= e.error)) e.error = error;  // keeps a NaN
    }
    blocks_[block].push_back(e);
  }
  [[nodiscard]] Real worst(const std::string& block) const {
    const std::vector<Entry>& entries = blocks_.at(block);
    std::vector<Real> sizes;
    for (const Entry& e : entries) {
      if (e.size > 0) sizes.push_back(e.size);
    }
    std::sort(sizes.begin(), sizes.end());
    const Real median = sizes.empty() ? 1 : sizes[sizes.size() / 2];
    Real worst = 0;
    for (const Entry& e : entries) {
      const Real error = e.error / std::max(median, e.size);
      if (error > worst || std::isnan(error)) worst = error;
    }
    return worst;
  }
  void expect_below(Real tolerance) const {
    for (const auto& [block, entries] : blocks_) EXPECT_LT(worst(block), tolerance) << block;
  }

 private:
  struct Entry {
    Real size = 0, error = 0;
  };
  std::map<std::string, std::vector<Entry>> blocks_;
};

/// Blocks of the velocity space (eta, r_dot): the parts of M and of the forces have their own units.
template <class T>
void add_dynamics(BlockErrors& errors, const std::string& by, std::size_t n,
                  const std::vector<std::vector<Real>>& M, const std::vector<Real>& force,
                  const Matrix<T>& have_M, const std::vector<T>& have_force) {
  const std::size_t size = force.size();
  ASSERT_EQ(have_M.rows(), static_cast<int>(size));
  ASSERT_EQ(have_force.size(), size);
  std::map<std::string, std::pair<std::vector<Real>, std::vector<T>>> blocks;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      auto& [want, have] = blocks[i < n && j < n ? "M_eta_eta" : i < n || j < n ? "M_r_eta" : "m_rr"];
      want.push_back(M[i][j]);
      have.push_back(have_M(static_cast<int>(i), static_cast<int>(j)));
    }
    auto& [want, have] = blocks[i < n ? "f" : "Q"];
    want.push_back(force[i]);
    have.push_back(have_force[i]);
  }
  for (const auto& [name, b] : blocks) errors.add(fmt::format("{} {}", by, name), b.first, b.second);
}

inline State<double> rounded(const State<Real>& s) {
  State<double> r;
  const auto to_double = [](Real x) { return static_cast<double>(x); };
  for (std::size_t i = 0; i < 9; ++i) r.R.m[i] = to_double(s.R.m[i]);
  for (int i = 0; i < 3; ++i) r.p[i] = to_double(s.p[i]);
  for (int i = 0; i < 6; ++i) r.eta[i] = to_double(s.eta[i]);
  for (const Real x : s.r) r.r.push_back(to_double(x));
  for (const Real x : s.r_dot) r.r_dot.push_back(to_double(x));
  r.t = to_double(s.t);
  return r;
}

/// What d'Alembert's principle gives at a state.
struct Expected {
  std::vector<std::vector<Real>> M;
  std::vector<Real> force;             // (f, Q)
  std::vector<Real> non_conservative;  // its part from `forces` and loads
  Real kinetic = 0, gravity = 0, potential = 0;
};

Expected expected_dynamics(const Witness& w, GroupKind group, const Sample& sample);

/// d(T + V)/dt of the masses along a motion, and the size of its terms.
std::pair<Real, Real> energy_rate(const Witness& w, GroupKind group, const Sample& sample,
                                  const std::vector<Real>& v_dot);

/// Of the natural scale, 1e-13 in double (measured: worst 1.3e-15) and 2e-17 in long double (measured: worst
/// 1.9e-18). Some hundred operations of half an ulp each, 1.1e-16 or 5.4e-20; the second bound sees a wrong
/// term that double's rounding would hide.
void expect_mechanics_of(const Witness& w, std::uint64_t seed = 20130922);

}  // namespace anholon::test
