// SPDX-License-Identifier: GPL-2.0-or-later
//
// The derived program against the full equations of motion with multipliers, written from positions and
// contact points and solved in long double: accelerations, torques and multipliers of the robots that have no
// reference vectors.
#include <gtest/gtest.h>

#include "anholon/reduction.hpp"
#include "mechanics/robots.hpp"

namespace anholon {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

struct Case {
  const char* model;
  Robot robot;
};
void PrintTo(const Case& c, std::ostream* stream) { *stream << c.model; }

class Multipliers : public testing::TestWithParam<Case> {};

/// Largest over smallest singular value that does not vanish.
Real condition_of(const Dense& A) {
  if (A.size() == 0) return 1;
  const Column sigma = Eigen::JacobiSVD<Dense>(A).singularValues();
  Real least = sigma(0);
  for (const Real s : sigma) {
    if (s > 1e-12L) least = s;
  }
  return sigma(0) / least;
}

std::vector<Real> list(const Column& x) { return {x.data(), x.data() + x.size()}; }

Column picked(const Column& x, const std::vector<int>& at) {
  Column r(static_cast<Eigen::Index>(at.size()));
  for (std::size_t i = 0; i < at.size(); ++i) r(static_cast<Eigen::Index>(i)) = x(at[i]);
  return r;
}
Dense picked(const Dense& x, const std::vector<int>& rows, const std::vector<int>& cols) {
  Dense r(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(cols.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < cols.size(); ++j)
      r(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = x(rows[i], cols[j]);
  }
  return r;
}

TEST_P(Multipliers, OfTheFullEquationsGiveTheMotionAndTorquesOfTheReducedOnes) {
  const Robot& robot = GetParam().robot;
  const std::string name = GetParam().model;
  const Model model = read_model(fmt::format("{}/models/{}/{}.toml", ANHOLON_SOURCE_DIR, name, name));
  const auto derivation = derive(model);
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const auto call = interpreting_caller<double>(derivation->program, parameters);
  const Partition partition = partition_of(model);
  const std::size_t n = static_cast<std::size_t>(partition.n);
  std::vector<int> every_row;

  std::mt19937_64 rng(20130922);
  std::normal_distribution<double> normal;
  BlockErrors errors;
  const auto scaled = [&](const std::string& block, const Column& want, const auto& have, Real condition) {
    // near a loss of rank the tolerance grows with the condition number; an error is shrunk by it instead
    std::vector<Real> shrunk = list(want);
    ASSERT_EQ(shrunk.size(), have.size()) << block;
    for (std::size_t i = 0; i < shrunk.size(); ++i)
      shrunk[i] += (static_cast<Real>(have[i]) - shrunk[i]) / condition;
    errors.add(block, list(want), shrunk);
  };
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(fmt::format("state {}", i));
    Sample sample;
    sample.state = random_position_and_velocity(model, rng);
    for (std::size_t c = 0; c < model.coordinates.size(); ++c) {  // working range
      const double low = model.coordinates[c].lower.to_double(),
                   high = model.coordinates[c].upper.to_double();
      sample.state.r[c] = std::uniform_real_distribution<double>(low, high)(rng);
    }
    // admissible velocity: the projection of a random one; then an admissible acceleration of all coordinates
    const Dense Z = kernel_of(equations(robot, model.group, sample).G);
    Column v(Z.rows());
    for (Real& x : v) x = normal(rng);
    v = (Z * (Z.transpose() * v)).eval();
    const auto components = free_components(model.group);
    for (std::size_t k = 0; k < n; ++k) sample.state.eta[components[k]] = v(static_cast<Eigen::Index>(k));
    for (std::size_t k = 0; k < sample.state.r_dot.size(); ++k)
      sample.state.r_dot[k] = v(static_cast<Eigen::Index>(n + k));
    const Equations e = equations(robot, model.group, sample);
    Column v_dot(v.size());
    for (Real& x : v_dot) x = 3 * normal(rng);
    v_dot = (Z * (Z.transpose() * v_dot)).eval();
    if (e.G.rows() > 0) v_dot += e.G.completeOrthogonalDecomposition().solve(Column(-e.bias));
    every_row.clear();
    for (int row = 0; row < e.G.rows(); ++row) every_row.push_back(row);

    EvaluationInput<double> input;
    input.state = rounded(sample.state);
    input.has_acceleration = true;
    input.has_torque = partition.s_a() > 0;
    input.r_ddot.assign(sample.state.r.size(), 0), input.tau.assign(sample.state.r.size(), 0);
    Column actuation = Column::Zero(v.size());
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
    const Real condition = std::max<Real>(1, condition_of(A));
    std::vector<double> passive;
    for (const int at : p) passive.push_back(have.acceleration[static_cast<std::size_t>(at)]);
    scaled("passive accelerations", imposed.acceleration, passive, condition);
    scaled("torques", tau, have.tau_a, condition);
    if (e.G.rows() > 0) scaled("multipliers", imposed.multipliers, have.lambda, condition);

    // torques given
    if (!input.has_torque) continue;
    const Motion free = solve_saddle(e.M, e.force + actuation, e.G, e.bias);
    const Real free_condition = std::max<Real>(1, condition_of(e.G));
    scaled("accelerations, torques given", free.acceleration, have.free_acceleration, free_condition);
    if (e.G.rows() > 0)
      scaled("multipliers, torques given", free.multipliers, have.free_lambda, free_condition);
  }
  errors.expect_below(1e-12L);  // measured: worst 1.8e-13, multipliers of wheeled_snake5; others below 4e-15
}

INSTANTIATE_TEST_SUITE_P(Robots, Multipliers,
                         testing::Values(Case{"double_pendulum", double_pendulum()}, Case{"arm6", arm6()},
                                         Case{"free_chain", free_chain()},
                                         Case{"wheeled_snake3", wheeled_snake(3)},
                                         Case{"wheeled_snake5", wheeled_snake(5)}, Case{"trailer", trailer()},
                                         Case{"mobile_pendulum", mobile_pendulum()},
                                         Case{"mobile_pendulum_one_wheel", mobile_pendulum()}),
                         [](const auto& info) { return std::string(info.param.model); });

// Murray, Li & Sastry, A Mathematical Introduction to Robotic Manipulation (1994), example 4.3, with gravity
// added: relative angles from the downward vertical.
TEST(DoublePendulum, FollowsItsTextbookEquations) {
  const Model model = read_model(ANHOLON_SOURCE_DIR "/models/double_pendulum/double_pendulum.toml");
  const auto derivation = derive(model);
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const auto call = interpreting_caller<double>(derivation->program, parameters);
  const Real m1 = 1.4L, m2 = 0.9L, l1 = 0.6L, c1 = 0.28L, c2 = 0.22L, J1 = 0.045L, J2 = 0.018L, gamma = 9.81L;
  std::mt19937_64 rng(20130922);
  BlockErrors errors;
  for (int i = 0; i < 100; ++i) {
    EvaluationInput<double> input;
    input.state = rounded(random_position_and_velocity(model, rng));
    input.has_acceleration = input.has_torque = true;
    input.r_ddot = {std::uniform_real_distribution<double>(-5, 5)(rng), 0};
    input.tau = {std::uniform_real_distribution<double>(-5, 5)(rng), 0};
    const Evaluated<double> e = evaluate_program(model, *derivation, call, input);
    const Real q1 = input.state.r[0], q2 = input.state.r[1], u1 = input.state.r_dot[0],
               u2 = input.state.r_dot[1];
    const Real alpha = J1 + J2 + m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2), beta = m2 * l1 * c2,
               delta = J2 + m2 * c2 * c2;
    const Real M11 = alpha + 2 * beta * std::cos(q2), M12 = delta + beta * std::cos(q2), M22 = delta;
    const Real h1 = -beta * std::sin(q2) * (2 * u1 * u2 + u2 * u2) +
                    (m1 * c1 + m2 * l1) * gamma * std::sin(q1) + m2 * c2 * gamma * std::sin(q1 + q2);
    const Real h2 = beta * std::sin(q2) * u1 * u1 + m2 * c2 * gamma * std::sin(q1 + q2);
    const Real a1 = input.r_ddot[0];
    const Real a2 = (-h2 - M12 * a1) / M22;
    errors.add("M", {M11, M12, M12, M22}, e.M.entries());
    errors.add("Q", {-h1, -h2}, e.force);
    errors.add("second acceleration", {a2}, std::vector{e.acceleration[1]});
    errors.add("torque", {M11 * a1 + M12 * a2 + h1}, e.tau_a);
    const Real determinant = M11 * M22 - M12 * M12, tau = input.tau[0];
    errors.add("accelerations, torque given",
               {(M22 * (tau - h1) + M12 * h2) / determinant, (-M11 * h2 - M12 * (tau - h1)) / determinant},
               e.free_acceleration);
  }
  errors.expect_below(1e-13L);  // measured: worst 1.2e-15
}

}  // namespace
}  // namespace anholon
