// SPDX-License-Identifier: GPL-2.0-or-later
#include "mechanics/full_equations.hpp"

#include <Eigen/Dense>

#include "anholon/reduction.hpp"
#include "check/evaluate_program.hpp"

namespace anholon::test {

Equations equations(const Robot& robot, GroupKind group, const Sample& sample) {
  const Expected x = expected_dynamics(robot.witness, group, sample);
  const auto size = static_cast<Eigen::Index>(x.force.size());
  Equations e{Dense(size, size), Dense(0, size), Column(size), Column(0)};
  for (Eigen::Index i = 0; i < size; ++i) {
    e.force(i) = x.force[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < size; ++j)
      e.M(i, j) = x.M[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  if (!robot.contacts) return e;
  const std::vector<Real> rest(static_cast<std::size_t>(size), 0);
  const Path moving = path(group, sample.state, velocity(group, sample.state), rest);
  const std::vector<Contact> contacts = robot.contacts(moving.g, moving.r, Jet(sample.state.t, 1, 0));
  const auto rows = static_cast<Eigen::Index>(contacts.size());
  e.G.setZero(rows, size), e.bias.setZero(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Contact& contact = contacts[static_cast<std::size_t>(i)];
    e.bias(i) = -contact.roll.dd;
    const auto w = angular_velocity(contact.frame), w_dot = angular_acceleration(contact.frame);
    for (std::size_t c = 0; c < 3; ++c) {
      e.bias(i) += contact.direction[c].d * contact.point[c].d + contact.direction[c].x * contact.point[c].dd;
      e.bias(i) += contact.about[c].d * w[c] + contact.about[c].x * w_dot[c];
    }
  }
  for (Eigen::Index k = 0; k < size; ++k) {
    std::vector<Real> unit = rest;
    unit[static_cast<std::size_t>(k)] = 1;
    const Path along = path(group, sample.state, unit, rest);
    const std::vector<Contact> moved = robot.contacts(along.g, along.r, sample.state.t);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Contact& contact = moved[static_cast<std::size_t>(i)];
      e.G(i, k) = -contact.roll.d;
      const auto w = angular_velocity(contact.frame);
      for (std::size_t c = 0; c < 3; ++c)
        e.G(i, k) += contact.direction[c].x * contact.point[c].d + contact.about[c].x * w[c];
    }
  }
  return e;
}

Motion solve_saddle(const Dense& M, const Column& force, const Dense& A, const Column& bias) {
  const Eigen::Index n = M.rows(), rows = A.rows();
  if (n + rows == 0) return {Column(0), Column(0)};
  Dense K = Dense::Zero(n + rows, n + rows);
  K.topLeftCorner(n, n) = M;
  K.topRightCorner(n, rows) = -A.transpose();
  K.bottomLeftCorner(rows, n) = A;
  Column b(n + rows);
  b << force, -bias;
  Eigen::CompleteOrthogonalDecomposition<Dense> solver;
  solver.setThreshold(1e-13L);
  const Column x = solver.compute(K).solve(b);
  return {x.head(n), x.tail(rows)};
}

Dense kernel_of(const Dense& A) {
  if (A.rows() == 0) return Dense::Identity(A.cols(), A.cols());
  const Eigen::JacobiSVD<Dense> svd(A, Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  for (Eigen::Index i = 0; i < svd.singularValues().size(); ++i)
    rank += svd.singularValues()(i) > 1e-12L ? 1 : 0;
  return svd.matrixV().rightCols(A.cols() - rank);
}

Real condition_of(const Dense& A) {
  if (A.size() == 0) return 1;
  const Column sigma = Eigen::JacobiSVD<Dense>(A).singularValues();
  Real least = sigma(0);
  for (const Real s : sigma) {
    if (s > 1e-12L) least = s;
  }
  return sigma(0) / least;
}

Column admissible_motion(const Robot& robot, const Model& model, Sample& sample, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const double low = model.coordinates[c].lower.to_double(), high = model.coordinates[c].upper.to_double();
    sample.state.r[c] = std::uniform_real_distribution<double>(low, high)(rng);
  }
  const Dense Z = kernel_of(equations(robot, model.group, sample).G);
  Column v(Z.rows()), v_dot(Z.rows());
  for (Real& x : v) x = normal(rng);
  v = (Z * (Z.transpose() * v)).eval();
  const auto components = free_components(model.group);
  for (std::size_t k = 0; k < components.size(); ++k)
    sample.state.eta[components[k]] = v(static_cast<Eigen::Index>(k));
  for (std::size_t k = 0; k < sample.state.r_dot.size(); ++k)
    sample.state.r_dot[k] = v(static_cast<Eigen::Index>(components.size() + k));
  const Equations e = equations(robot, model.group, sample);
  for (Real& x : v_dot) x = 3 * normal(rng);
  v_dot = (Z * (Z.transpose() * v_dot)).eval();
  if (e.G.rows() > 0) v_dot += e.G.completeOrthogonalDecomposition().solve(Column(-e.bias));
  return v_dot;
}

void expect_reduced_motion_of(const Model& model, const Robot& robot, bool several_charts) {
  const auto derivation = derive(model);
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const auto call = interpreting_caller<double>(derivation->program, parameters);
  const Partition partition = partition_of(model);
  const auto n = static_cast<std::size_t>(partition.n);
  std::vector<int> every_row;

  EXPECT_EQ(derivation->reduction.charts.size() > 1, several_charts);
  std::mt19937_64 rng(20130922);
  std::normal_distribution<double> normal;
  BlockErrors errors;
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(fmt::format("state {}", i));
    Sample sample{random_position_and_velocity(model, rng)};
    const Column v_dot = admissible_motion(robot, model, sample, rng);
    const Equations e = equations(robot, model.group, sample);
    every_row.clear();
    for (int row = 0; row < e.G.rows(); ++row) every_row.push_back(row);

    EvaluationInput<double> input;
    input.state = rounded(sample.state);
    input.has_acceleration = true;
    input.has_torque = partition.s_a() > 0;
    input.r_ddot.assign(sample.state.r.size(), 0), input.tau.assign(sample.state.r.size(), 0);
    Column actuation = Column::Zero(v_dot.size());
    Column r_a_ddot(partition.s_a());
    for (std::size_t k = 0; k < partition.active.size(); ++k) {
      const int at = partition.active[k];
      input.r_ddot[static_cast<std::size_t>(at) - n] = static_cast<double>(v_dot(at));
      r_a_ddot(static_cast<Eigen::Index>(k)) = input.r_ddot[static_cast<std::size_t>(at) - n];
      actuation(at) = input.tau[static_cast<std::size_t>(at) - n] = normal(rng);
    }
    const Evaluated<double> have = evaluate_program(model, *derivation, call, input);

    // r_a(t) given
    const std::vector<int>&p = partition.passive, &a = partition.active;
    const Dense A = picked(e.G, every_row, p), B = picked(e.G, every_row, a);
    const Motion imposed = solve_saddle(picked(e.M, p, p), picked(e.force, p) - picked(e.M, p, a) * r_a_ddot,
                                        A, e.bias + B * r_a_ddot);
    const Column tau = picked(e.M, a, p) * imposed.acceleration + picked(e.M, a, a) * r_a_ddot -
                       picked(e.force, a) - B.transpose() * imposed.multipliers;
    const Real condition = std::max(Real(1), condition_of(A));
    std::vector<double> passive;
    for (const int at : p) passive.push_back(have.acceleration[static_cast<std::size_t>(at)]);
    add_scaled(errors, "passive accelerations", imposed.acceleration, passive, condition);
    add_scaled(errors, "torques", tau, have.tau_a, condition);
    if (e.G.rows() > 0) add_scaled(errors, "multipliers", imposed.multipliers, have.lambda, condition);

    // torques given
    if (!input.has_torque) continue;
    const Motion free = solve_saddle(e.M, e.force + actuation, e.G, e.bias);
    const Real free_condition = std::max(Real(1), condition_of(e.G));
    add_scaled(errors, "accelerations, torques given", free.acceleration, have.free_acceleration,
               free_condition);
    if (e.G.rows() > 0)
      add_scaled(errors, "multipliers, torques given", free.multipliers, have.free_lambda, free_condition);
  }
  errors.expect_below(1e-12L);  // measured: worst 1.8e-13, multipliers of wheeled_snake5; others below 4e-15
}

void expect_hybrid_motion_of(const Model& model, const Robot& robot, const std::set<std::string>& driven) {
  DeriveRequest request;
  request.torque_driven = driven;
  request.functions = {"kinematics", "reduced_velocities", "forward_dynamics", "inverse_torques",
                       "multipliers"};
  const auto derivation = derive(model, request);
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const auto call = interpreting_caller<double>(derivation->program, parameters);
  const Partition declared = partition_of(model), partition = partition_of(model, driven);
  const std::vector<int>&p = partition.passive, &a = partition.active;
  std::mt19937_64 rng(20130922);
  std::normal_distribution<double> normal;
  BlockErrors errors;
  for (int i = 0; i < 100; ++i) {
    Sample sample{random_position_and_velocity(model, rng)};
    const Column v_dot = admissible_motion(robot, model, sample, rng);
    const Equations e = equations(robot, model.group, sample);
    std::vector<int> every_row;
    for (int row = 0; row < e.G.rows(); ++row) every_row.push_back(row);
    const std::vector<Real> v = velocity(model.group, sample.state);
    NamedValues<double> in = position_inputs(model, declared, rounded(sample.state));
    Column force = picked(e.force, p), r_a_ddot(partition.s_a());
    for (std::size_t k = 0; k < p.size(); ++k) {
      const bool is_driven = k >= declared.passive.size();
      const char* block = static_cast<int>(k) < partition.n ? "eta" : is_driven ? "r_d_dot" : "r_p_dot";
      in[block].push_back(static_cast<double>(v[static_cast<std::size_t>(p[k])]));
      if (!is_driven) continue;
      const double tau = normal(rng);
      in[a.empty() ? "tau_a" : "tau_d"].push_back(tau);
      force(static_cast<Eigen::Index>(k)) += tau;
    }
    for (std::size_t k = 0; k < a.size(); ++k) {
      in["r_a_dot"].push_back(static_cast<double>(v[static_cast<std::size_t>(a[k])]));
      in["r_a_ddot"].push_back(static_cast<double>(v_dot(a[k])));
      r_a_ddot(static_cast<Eigen::Index>(k)) = in["r_a_ddot"].back();
    }
    const Dense A = picked(e.G, every_row, p), B = picked(e.G, every_row, a);
    const Motion want =
        solve_saddle(picked(e.M, p, p), force - picked(e.M, p, a) * r_a_ddot, A, e.bias + B * r_a_ddot);
    const Real condition = std::max<Real>(1, condition_of(A));
    if (partition.passive.size() > static_cast<std::size_t>(derivation->reduction.ranks.m_locked)) {
      in["nu"] = call("reduced_velocities", in)["nu"];
    }
    NamedValues<double> forward = call("forward_dynamics", in);
    std::vector<double> passive;
    for (const char* block : {"eta_dot", "r_p_ddot", "r_d_ddot"})
      passive.insert(passive.end(), forward[block].begin(), forward[block].end());
    add_scaled(errors, "passive accelerations", want.acceleration, passive, condition);
    in["nu_dot"] = forward["nu_dot"];
    if (!a.empty()) {
      const Column tau = picked(e.M, a, p) * want.acceleration + picked(e.M, a, a) * r_a_ddot -
                         picked(e.force, a) - B.transpose() * want.multipliers;
      add_scaled(errors, "torques", tau, call("inverse_torques", in)["tau_a"], condition);
    }
    if (e.G.rows() > 0)
      add_scaled(errors, "multipliers", want.multipliers, call("multipliers", in)["lambda"], condition);
  }
  errors.expect_below(1e-12L);
}

}  // namespace anholon::test
