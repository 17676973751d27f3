// SPDX-License-Identifier: GPL-2.0-or-later

// Functions that are emitted as loops over the tree: values against the recursion, counts in closed form.

#include "optimise/tree_loops.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "check/verify_tree.hpp"
#include "describe/read_robot.hpp"
#include "emit/header.hpp"
#include "urdf/chain.hpp"
#include "urdf/small_robots.hpp"

namespace anholon::tree_loops_test {
namespace {

const std::vector<std::string> looped = {"mass_factor", "inverse_mass_matrix", "regressor"};

TreeRequest request_for(const std::vector<std::string>& functions) {
  TreeRequest request;
  request.functions = functions;
  request.search = false;
  return request;
}

void expect_loops_that_pass(const Model& model, const std::vector<std::string>& functions) {
  const auto derivation = derive_tree(model, request_for(functions));
  for (const std::string& name : functions) {
    const auto f = std::ranges::find(derivation->program.functions, name, &Function::name);
    ASSERT_NE(f, derivation->program.functions.end());
    EXPECT_TRUE(f->loops.has_value()) << name;
  }
  const Verification v = verify_tree(model, *derivation, {3}, {});
  EXPECT_TRUE(v.passed);
  EXPECT_LE(v.formula_worst, formula_bound) << v.formula_at;
  for (const OutputError& e : v.outputs)
    EXPECT_TRUE(e.passed) << e.function << "." << e.output << ": " << e.worst << ", kappa " << e.condition;
}

TEST(TreeLoops, OfAFreeTrunkWithLimbsPassVerification) {
  RobotOptions options;
  options.floating = true;
  expect_loops_that_pass(read_robot_text(testing::branching(4, 6, 6), "robot.urdf", options), looped);
}

TEST(TreeLoops, OfAFixedTrunkWithLimbsPassVerification) {
  expect_loops_that_pass(read_robot_text(testing::branching(12, 4, 6), "robot.urdf"), looped);
}

/// Row k of the factor is scaled by one division and k products and taken from the triangle above it; the
/// inverse of L costs a product and a difference for each three on a path, and each pair in its square one of
/// each.
TEST(TreeLoops, CountWhatAChainTakes) {
  const int n = 30;
  const auto derivation = derive_tree(read_robot_text(testing::chain(n), "chain.urdf"),
                                      request_for({"mass_factor", "inverse_mass_matrix"}));
  const auto loops_of = [&](const std::string& name) {
    return count_operations(*std::ranges::find(derivation->program.functions, name, &Function::name)->loops);
  };
  const int pairs = n * (n - 1) / 2;              // k > i
  const int triples = n * (n - 1) * (n - 2) / 6;  // k > i > j
  const OperationCount factor = loops_of("mass_factor");
  EXPECT_EQ(factor.divisions, n);
  EXPECT_EQ(factor.multiplications, pairs + pairs + triples);
  EXPECT_EQ(factor.additions, pairs + triples);
  const OperationCount inverse = loops_of("inverse_mass_matrix");
  EXPECT_EQ(inverse.divisions, 2 * n);
  EXPECT_EQ(inverse.negations, pairs);
  EXPECT_EQ(inverse.multiplications, factor.multiplications + triples + pairs + pairs + triples);
  EXPECT_EQ(inverse.additions, factor.additions + triples + n + pairs + pairs + triples);
}

TEST(TreeLoops, AreLeftOutWhereAStraightLineDoes) {
  const auto derivation =
      derive_tree(read_robot_text(testing::serial_arm(), "arm.urdf"), request_for(looped));
  ASSERT_EQ(derivation->program.functions.size(), looped.size());
  for (const Function& f : derivation->program.functions) EXPECT_FALSE(f.loops.has_value()) << f.name;
}

/// The function that the loops start from comes along, whether it was asked for or not, and once.
TEST(TreeLoops, BringTheFunctionThatTheyStartFrom) {
  const auto derivation = derive_tree(read_robot_text(testing::chain(30), "chain.urdf"),
                                      request_for({"inverse_mass_matrix", "regressor"}));
  std::vector<std::string> names;
  for (const Function& f : derivation->program.functions) names.push_back(f.name);
  EXPECT_EQ(names, (std::vector<std::string>{"mass_matrix", "inverse_mass_matrix", "regressor_motion",
                                             "regressor"}));
  const std::string header = emit_header(derivation->program);
  EXPECT_NE(header.find("  detail::invert_mass_factor(30, parent, end, M_inverse, D);"), std::string::npos);
}

}  // namespace
}  // namespace anholon::tree_loops_test
