// SPDX-License-Identifier: GPL-2.0-or-later

// The classic arms with all inertial figures symbolic: the operations of one call, and the values.

#include <gtest/gtest.h>

#include <algorithm>

#include "anholon/free_dynamics.hpp"
#include "derive/tree_functions.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "urdf/random_state.hpp"

namespace anholon::classic_arms_test {
namespace {

struct Arm {
  std::string name;
  int inverse_dynamics, mass_matrix;  // operations of one call
};

class ClassicArms : public ::testing::TestWithParam<Arm> {
 protected:
  [[nodiscard]] static Model model() {
    return read_model(std::filesystem::path(ANHOLON_SOURCE_DIR) / "models" / "classic_arms" /
                      (GetParam().name + ".toml"));
  }
};

TEST_P(ClassicArms, TakeExactlySoManyOperations) {
  TreeRequest request;
  request.functions = {"inverse_dynamics", "mass_matrix"};
  const auto derivation = derive_tree(model(), request);
  const auto operations = [&](const std::string& name) {
    const Function& f = *std::ranges::find(derivation->program.functions, name, &Function::name);
    std::vector<NodeId> roots;
    for (const OutputBlock& b : f.outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
    return operations_per_call(derivation->program, roots).total();
  };
  EXPECT_EQ(operations("inverse_dynamics"), GetParam().inverse_dynamics);
  EXPECT_EQ(operations("mass_matrix"), GetParam().mass_matrix);
}

TEST_P(ClassicArms, AgreeWithTheRecursionInExactNumbers) {
  const Model arm = model();
  TreeRequest request;
  request.functions = {"inverse_dynamics", "mass_matrix"};
  const auto derivation = derive_tree(arm, request);
  std::vector<Exact> parameters;
  for (const Parameter& p : arm.parameters) parameters.push_back(p.value);
  const Mechanism<Exact> mechanism = mechanise<Exact>(describe_mechanism(arm), parameters);
  FreeDynamics<Exact> dynamics(mechanism);
  std::mt19937 random(3);
  const auto x = testing::random_state<Exact>(derivation->program, random,
                                              [](double v) { return Exact::from_double(v); });
  const auto expect_same = [](const std::vector<Exact>& a, const std::vector<Exact>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)  // of 128 digits, entries are below 1e4
      EXPECT_LT(abs(a[i] - b[i]), Exact::from_decimal("1e-80")) << i;
  };
  expect_same(testing::run(derivation->program, "inverse_dynamics", x.inputs),
              dynamics.inverse_dynamics(x.state, x.acceleration));
  expect_same(testing::run(derivation->program, "mass_matrix", x.inputs),
              dynamics.mass_matrix(x.state).entries());
}

INSTANTIATE_TEST_SUITE_P(All, ClassicArms,
                         ::testing::Values(Arm{"rx90", 435, 201}, Arm{"puma560", 456, 234},
                                           Arm{"stanford_arm", 388, 170}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace anholon::classic_arms_test
