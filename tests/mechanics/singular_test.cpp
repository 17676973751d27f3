// SPDX-License-Identifier: GPL-2.0-or-later
// The snake-boards at r_1 = pi/2, where A loses rank for an instant: the motion passes along the continued
// kernel.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "check/compiled_caller.hpp"
#include "check/evaluate_recursion.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"

namespace anholon::singular_test {
namespace {

class SnakeboardAtRightAngle : public testing::TestWithParam<std::string> {};

double distance(const std::vector<double>& a, const std::vector<Exact>& b) {
  double largest = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i])) return INFINITY;
    largest = std::max(largest, std::abs((Exact::from_double(a[i]) - b[i]).to_double()));
    size = std::max(size, std::abs(b[i].to_double()));
  }
  return size > 0 ? largest / size : largest;
}

TEST_P(SnakeboardAtRightAngle, KeepsAllDigitsOfAccelerationsAndTorques) {
  const Model model =
      read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + GetParam() + "/" + GetParam() + ".toml");
  const auto derivation = derive(model);
  std::vector<Exact> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(Exact::from_double(p.value.to_double()));
  const auto generated = compiled_caller(derivation->program, parameters);
  const auto exact = interpreting_caller<Exact>(derivation->program, parameters);
  const WorkingDigits precision(60);
  const Mechanism<Exact> mechanism = mechanise<Exact>(describe_mechanism(model), parameters);
  const Partition partition = partition_of(model);
  const auto modes = static_cast<std::size_t>(partition.s_p());

  for (const double offset : {0.0, 1e-8, -1e-8, 1e-12, -1e-4}) {
    SCOPED_TRACE(offset);
    const double r_1 = std::numbers::pi / 2 + offset;
    NamedValues<double> in = {{"g", {0.1, -0.2, 0.3}},
                              {"r_a", {r_1, 0.4}},
                              {"r_a_dot", {0.5, -1.2}},
                              {"r_a_ddot", {1.1, 2.3}},
                              {"nu", {0.7}}};
    if (modes > 0) in["r_p"] = {0.02, -0.05}, in["nu"] = {0.7, 0.1, 0.05};
    NamedValues<Exact> exact_in;
    for (const auto& [name, values] : in) {
      for (const double x : values) exact_in[name].push_back(Exact::from_double(x));
    }
    const auto got = generated("forward_dynamics", in);
    const auto want = exact("forward_dynamics", exact_in);
    // the default bound of the project; about 300 operations without cancellation
    EXPECT_LT(distance(got.at("nu_dot"), want.at("nu_dot")), 1e-13);
    EXPECT_LT(distance(got.at("eta_dot"), want.at("eta_dot")), 1e-13);
    in["nu_dot"] = got.at("nu_dot");
    exact_in["nu_dot"] = want.at("nu_dot");
    const auto tau = generated("inverse_torques", in);
    EXPECT_LT(distance(tau.at("tau_a"), exact("inverse_torques", exact_in).at("tau_a")), 1e-13);

    // the same accelerations from the recursion with a pivoted kernel at this one state, which knows no
    // continuation
    const auto velocities = exact("kinematics", exact_in);
    EvaluationInput<Exact> input;
    input.state.R = AxisRotation<Exact>{2, cos(exact_in["g"][2]), sin(exact_in["g"][2])}.matrix();
    input.state.eta = {{velocities.at("eta")[0], velocities.at("eta")[1], 0},
                       {0, 0, velocities.at("eta")[2]}};
    input.state.r.assign(model.coordinates.size(), 0);
    input.state.r_dot = input.r_ddot = input.state.r;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto at = static_cast<std::size_t>(partition.active[i] - partition.n);
      input.state.r[at] = exact_in["r_a"][i], input.state.r_dot[at] = exact_in["r_a_dot"][i],
      input.r_ddot[at] = exact_in["r_a_ddot"][i];
    }
    for (std::size_t i = 0; i < modes; ++i) {
      const auto at = static_cast<std::size_t>(partition.passive[3 + i] - partition.n);
      input.state.r[at] = exact_in["r_p"][i], input.state.r_dot[at] = velocities.at("r_p_dot")[i];
    }
    input.has_acceleration = true;
    const Evaluated<Exact> witness =
        evaluate_recursion(mechanism, partition, input, Exact::from_decimal("1e-30"));
    EXPECT_LT(distance(got.at("eta_dot"), {witness.acceleration.begin(), witness.acceleration.begin() + 3}),
              1e-13);
    EXPECT_LT(distance(tau.at("tau_a"), witness.tau_a), 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Snakeboards, SnakeboardAtRightAngle,
                         testing::Values("rigid_snakeboard", "soft_snakeboard"));

}  // namespace
}  // namespace anholon::singular_test
