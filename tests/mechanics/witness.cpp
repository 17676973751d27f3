// SPDX-License-Identifier: GPL-2.0-or-later
#include "mechanics/witness.hpp"

#include <Eigen/Dense>

#include "anholon/free_dynamics.hpp"
#include "check/evaluate_program.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "reduce/decompositions.hpp"

namespace anholon::test {

Pose base_motion(const State<Real>& s, const std::array<Real, 6>& eta, const std::array<Real, 6>& eta_dot) {
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

Path path(GroupKind group, const State<Real>& s, const std::vector<Real>& v, const std::vector<Real>& v_dot) {
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

std::vector<Real> velocity(GroupKind group, const State<Real>& s) {
  std::vector<Real> v;
  for (const int c : free_components(group)) v.push_back(s.eta[c]);
  v.insert(v.end(), s.r_dot.begin(), s.r_dot.end());
  return v;
}

State<Real> random_position_and_velocity(const Model& model, std::mt19937_64& rng) {
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

Expected expected_dynamics(const Witness& w, GroupKind group, const Sample& sample) {
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

std::pair<Real, Real> energy_rate(const Witness& w, GroupKind group, const Sample& sample,
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

void expect_mechanics_of(const Witness& w, std::uint64_t seed) {
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
