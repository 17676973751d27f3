// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A second description of a small robot, by the positions of its masses: what the blocks of eq. (1), the
// energies and the power must be, from d'Alembert's principle on the masses alone. Every description is tried
// at 100 random states, by the recursion in double and in long double, and by the derived program.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "anholon/free_dynamics.hpp"
#include "anholon/reduction.hpp"
#include "check/evaluate_program.hpp"
#include "describe/mechanise.hpp"
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
inline Pose base_motion(const State<Real>& s, const std::array<Real, 6>& eta,
                        const std::array<Real, 6>& eta_dot) {
  const auto hat = [](const Real* w) {
    return std::array<std::array<Real, 3>, 3>{{{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}}};
  };
  const auto W = hat(&eta[3]);
  const auto W_dot = hat(&eta_dot[3]);
  Pose g;
  for (std::size_t i = 0; i < 3; ++i) {
    g.p[i] = s.p[static_cast<int>(i)];
    const auto R = [&](std::size_t k) { return Real(s.R.m[3 * i + k]); };
    for (std::size_t j = 0; j < 3; ++j) {
      g.R[i][j] = Jet(R(j), 0, 0);
      g.p[i].d += R(j) * eta[j];
      g.p[i].dd += R(j) * eta_dot[j];
      for (std::size_t k = 0; k < 3; ++k) {
        g.R[i][j].d += R(k) * W[k][j];
        g.R[i][j].dd += R(k) * W_dot[k][j];
        g.p[i].dd += R(k) * W[k][j] * eta[j];
        for (std::size_t l = 0; l < 3; ++l) g.R[i][j].dd += R(k) * W[k][l] * W[l][j];
      }
    }
  }
  return g;
}

/// Pose and shape along a motion with velocity v and acceleration v_dot (n + s).
struct Path {
  Pose g;
  std::vector<Jet> r;
};
inline Path path(GroupKind group, const State<Real>& s, const std::vector<Real>& v,
                 const std::vector<Real>& v_dot) {
  std::array<Real, 6> eta{}, eta_dot{};
  const auto components = free_components(group);
  for (std::size_t i = 0; i < components.size(); ++i) {
    eta[static_cast<std::size_t>(components[i])] = v[i];
    eta_dot[static_cast<std::size_t>(components[i])] = v_dot[i];
  }
  Path p{base_motion(s, eta, eta_dot), {}};
  for (std::size_t i = 0; i < s.r.size(); ++i)
    p.r.emplace_back(s.r[i], v[components.size() + i], v_dot[components.size() + i]);
  return p;
}

inline std::vector<Real> velocity(GroupKind group, const State<Real>& s) {
  std::vector<Real> v;
  for (const int c : free_components(group)) v.push_back(s.eta[c]);
  v.insert(v.end(), s.r_dot.begin(), s.r_dot.end());
  return v;
}

/// A state within the group: angles to +-3 rad, lengths to +-0.5 m, rates to +-2.
inline State<Real> random_position_and_velocity(const Model& model, std::mt19937_64& rng) {
  const auto uniform = [&](double bound) {
    return std::uniform_real_distribution<double>(-bound, bound)(rng);
  };
  State<Real> s;
  s.t = uniform(5);
  const GroupKind group = model.group;
  if (group == GroupKind::SE2) {
    const Real angle = uniform(3);
    s.R.m = {std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1};
  } else if (group == GroupKind::SE3 || group == GroupKind::SO3) {
    const Eigen::Quaternion<Real> q(uniform(1), uniform(1), uniform(1), uniform(1));
    const Eigen::Matrix<Real, 3, 3> R = q.normalized().toRotationMatrix();
    for (int i = 0; i < 9; ++i) s.R.m[static_cast<std::size_t>(i)] = R(i / 3, i % 3);
  }
  for (const int c : free_components(group)) {
    if (c < 3) s.p[c] = uniform(1);
    s.eta[c] = uniform(2);
  }
  for (const Coordinate& c : model.coordinates) {
    s.r.push_back(uniform(c.is_angle ? 3 : 0.5));
    s.r_dot.push_back(uniform(2));
  }
  return s;
}

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
      if (!(error <= worst)) worst = error;
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
  for (const auto& [name, b] : blocks) errors.add(by + " " + name, b.first, b.second);
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

inline Expected expected_dynamics(const Witness& w, GroupKind group, const Sample& sample) {
  const State<Real>& s = sample.state;
  const std::vector<Real> v = velocity(group, s);
  const std::size_t size = v.size();
  const std::vector<Real> rest(size, 0);
  std::vector<std::vector<MassPoint>> columns;
  std::vector<Path> directions;
  for (std::size_t k = 0; k < size; ++k) {
    std::vector<Real> e = rest;
    e[k] = 1;
    directions.push_back(path(group, s, e, rest));
    columns.push_back(w.masses(directions[k].g, directions[k].r));
  }
  const Path moving = path(group, s, v, rest);
  const std::vector<MassPoint> points = w.masses(moving.g, moving.r);

  Expected x;
  x.M.assign(size, rest);
  x.force = x.non_conservative = rest;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Real m = points[q].mass;
    for (std::size_t c = 0; c < 3; ++c) {
      const Jet& at = points[q].at[c];
      x.kinetic += m * at.d * at.d / 2;
      x.gravity -= m * w.gravity[c] * at.x;
      for (std::size_t i = 0; i < size; ++i) {
        const Real J_i = columns[i][q].at[c].d;
        x.force[i] += m * J_i * (w.gravity[c] - at.dd);
        for (std::size_t j = 0; j < size; ++j) x.M[i][j] += m * J_i * columns[j][q].at[c].d;
      }
    }
  }
  if (w.potential) {
    x.potential = w.potential(moving.g, moving.r).x;
    for (std::size_t i = 0; i < size; ++i) x.force[i] -= w.potential(directions[i].g, directions[i].r).d;
  }
  if (w.forces) x.non_conservative = w.forces(sample);
  if (w.loads) {
    const std::vector<Load> loads = w.loads(sample, w.loaded_frames(moving.g, moving.r));
    for (std::size_t i = 0; i < size; ++i) {
      const std::vector<Pose> frames = w.loaded_frames(directions[i].g, directions[i].r);
      for (std::size_t l = 0; l < loads.size(); ++l) {
        const auto turn = angular_velocity(frames[l]);
        for (std::size_t c = 0; c < 3; ++c)
          x.non_conservative[i] += loads[l].force[c].x * frames[l].p[c].d + loads[l].torque[c].x * turn[c];
      }
    }
  }
  for (std::size_t i = 0; i < size; ++i) x.force[i] += x.non_conservative[i];
  return x;
}

/// d(T + V)/dt of the masses along a motion, and the size of its terms.
inline std::pair<Real, Real> energy_rate(const Witness& w, GroupKind group, const Sample& sample,
                                         const std::vector<Real>& v_dot) {
  const Path p = path(group, sample.state, velocity(group, sample.state), v_dot);
  Real rate = 0, size = 0;
  const auto add_term = [&](Real x) { rate += x, size += std::abs(x); };
  for (const MassPoint& point : w.masses(p.g, p.r)) {
    for (std::size_t c = 0; c < 3; ++c) {
      add_term(point.mass * point.at[c].d * point.at[c].dd);
      add_term(-point.mass * w.gravity[c] * point.at[c].d);
    }
  }
  if (w.potential) add_term(w.potential(p.g, p.r).d);
  return {rate, size};
}

/// Of the natural scale, 1e-13 in double (measured: worst 1.3e-15) and 2e-17 in long double (measured: worst
/// 1.9e-18). Some hundred operations of half an ulp each, 1.1e-16 or 5.4e-20; the second bound sees a wrong
/// term that double's rounding would hide.
inline void expect_mechanics_of(const Witness& w, std::uint64_t seed = 20130922) {
  const Model model = read_model_text(w.description, "witness.toml");
  const MechanismDescription description = describe_mechanism(model);
  std::vector<double> parameters;
  std::vector<Real> long_parameters;
  for (const Parameter& p : model.parameters) {
    parameters.push_back(p.value.to_double());
    long_parameters.push_back(FromExact<Real>{}(p.value));
  }
  const Mechanism<double> mechanism = mechanise<double>(description, parameters);
  const Mechanism<Real> long_mechanism = mechanise<Real>(description, long_parameters);
  FreeDynamics<double> dynamics(mechanism);
  FreeDynamics<Real> long_dynamics(long_mechanism);
  DeriveRequest request;
  request.functions = {"kinematics", "reduced_velocities", "free_dynamics", "energies"};
  request.closed_forms = false;  // that search is tried on the shipped models
  const auto derivation = derive(model, request);
  const auto call = interpreting_caller<double>(derivation->program, parameters);
  const std::size_t n = free_components(model.group).size();

  std::mt19937_64 rng(seed);
  BlockErrors errors, long_errors;
  for (int i = 0; i < 100; ++i) {
    Sample sample;
    sample.state = random_position_and_velocity(model, rng);
    const Expected x = expected_dynamics(w, model.group, sample);
    EvaluationInput<double> input;
    input.state = rounded(sample.state);
    const Matrix<double> M = dynamics.mass_matrix(input.state);
    const std::vector<double> force = dynamics.forces(input.state);
    add_dynamics(errors, "recursion", n, x.M, x.force, M, force);
    add_dynamics(long_errors, "recursion in long double", n, x.M, x.force,
                 long_dynamics.mass_matrix(sample.state), long_dynamics.forces(sample.state));
    const Evaluated<double> e = evaluate_program(model, *derivation, call, input);
    add_dynamics(errors, "program", n, x.M, x.force, e.M, e.force);

    const auto energies = dynamics.energies(input.state);
    const Real dissipated = w.dissipated_power ? w.dissipated_power(sample) : 0;
    const auto add_energies = [&](const std::string& by, double kinetic, double gravity, double elastic,
                                  double power) {
      errors.add(by + " kinetic energy", {x.kinetic}, std::vector{kinetic});
      errors.add(by + " energy of gravity", {x.gravity}, std::vector{gravity});
      errors.add(by + " elastic energy", {x.potential}, std::vector{elastic});
      errors.add(by + " dissipated power", {dissipated}, std::vector{power});
    };
    add_energies("recursion", energies.kinetic, energies.gravity, energies.elastic,
                 energies.dissipated_power);
    add_energies("program", e.kinetic, e.gravity, e.elastic, e.dissipated_power);

    // d(T + V)/dt = power of what is not conservative, along the free motion that the recursion gives
    const Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> M_dense = to_eigen(M).cast<Real>();
    const Eigen::Matrix<Real, Eigen::Dynamic, 1> v_dot =
        M_dense.ldlt().solve(to_eigen(force).cast<Real>().eval());
    const auto [rate, size] =
        energy_rate(w, model.group, sample, {v_dot.data(), v_dot.data() + v_dot.size()});
    const std::vector<Real> v = velocity(model.group, sample.state);
    Real power = 0;
    for (std::size_t k = 0; k < v.size(); ++k) power += x.non_conservative[k] * v[k];
    EXPECT_NEAR(static_cast<double>(rate), static_cast<double>(power),
                1e-13 * static_cast<double>(size + std::abs(power)))
        << i;
  }
  errors.expect_below(1e-13L);
  long_errors.expect_below(2e-17L);
}

}  // namespace anholon::test
