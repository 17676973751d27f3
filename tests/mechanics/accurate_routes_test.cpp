// SPDX-License-Identifier: GPL-2.0-or-later
// Routes that are derived where others lose digits.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "check/error_measure.hpp"
#include "check/evaluate_program.hpp"
#include "derive/derive.hpp"
#include "describe/read_model.hpp"
#include "reduce/samples.hpp"

namespace anholon::accurate_routes_test {
namespace {

/// Routes that keep digits, compensated or not, and the shortest one have the same exact values.
class AccurateRoutes : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(AccurateRoutes, AreTheSameEquations) {
  const auto& [name, function] = GetParam();
  const Model model = read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + name + "/" + name + ".toml");
  const WorkingDigits precision(verification_digits);
  std::vector<Exact> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value);
  DeriveRequest request;
  request.functions = {function};
  request.optimise = OptimiseFor::speed;
  const auto shortest = derive(model, request);
  request.optimise = OptimiseFor::balanced;
  const auto accurate = derive(model, request);
  ASSERT_NE(find_function(shortest->program, function)->remark,
            find_function(accurate->program, function)->remark);
  SampleSource source(11);
  for (int s = 0; s < 3; ++s) {
    NamedValues<Exact> in = position_inputs(model, partition_of(model), random_state(model, source));
    for (const InputBlock& block : accurate->program.inputs) {
      for (std::size_t i = in [block.name].size(); i < block.nodes.size(); ++i)
        in[block.name].push_back(source.uniform(Exact(-1), Exact(1)));
    }
    const auto want = interpreting_caller<Exact>(shortest->program, parameters)(function, in);
    const auto got = interpreting_caller<Exact>(accurate->program, parameters)(function, in);
    for (const auto& [block, values] : want) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double difference = (got.at(block)[i] - values[i]).to_double();
        // compensated constants are two doubles, whose rests are handed on to first order: 1e-32, times the
        // condition
        EXPECT_LT(std::abs(difference), 1e-28 * (1 + std::abs(values[i].to_double())))
            << block << ", state " << s;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, AccurateRoutes,
                         ::testing::Values(std::pair{"acm_snake", "compatibility"},
                                           std::pair{"whipple_bicycle", "forward_dynamics"},
                                           std::pair{"soft_snakeboard", "torque_driven_dynamics"},
                                           std::pair{"quadruped_stance", "torque_driven_dynamics"}),
                         [](const auto& info) { return std::string(info.param.first); });

TEST(AccurateRoutes, DoWithoutTheMassMatrixWhereAVelocityHasNoInertia) {
  std::ifstream file(std::string(ANHOLON_SOURCE_DIR) + "/models/trailer/trailer.toml");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string inertia = R"(inertia = { mass = "m_t", com = ["-e", 0, 0], about_com = { zz = "J_t" } })";
  ASSERT_NE(text.find(inertia), std::string::npos);
  text.erase(text.find(inertia), inertia.size());
  DeriveRequest request;
  request.functions = {"torque_driven_dynamics"};
  request.optimise = OptimiseFor::accuracy;  // asks for all routes
  const Model model = read_model_text(text, "trailer.toml");
  const auto derivation = derive(model, request);
  for (const CandidateReport& c : derivation->candidates)
    EXPECT_EQ(c.route.find("multipliers"), std::string::npos) << c.route;
}

}  // namespace
}  // namespace anholon::accurate_routes_test
