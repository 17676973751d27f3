// SPDX-License-Identifier: GPL-2.0-or-later

// Compiled code of whole robots against exact arithmetic and the exact recursion; and that a wrong program is
// found.

#include "check/verify_tree.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "urdf/oracle_state.hpp"
#include "urdf/small_robots.hpp"

namespace anholon::verify_tree_test {
namespace {

void expect_passed(const Model& model, const std::vector<std::string>& functions, int samples) {
  TreeRequest request;
  request.functions = functions;
  const auto derivation = derive_tree(model, request);
  const Verification v = verify_tree(model, *derivation, {samples}, {});
  EXPECT_TRUE(v.passed);
  EXPECT_GT(v.formula_samples, 0);
  EXPECT_LE(v.formula_worst, formula_bound) << v.formula_at;
  EXPECT_LE(v.energy_balance, 1e-11);  // the bound of verify; the derivative alone is good to 1e-24
  for (const OutputError& e : v.outputs)
    EXPECT_TRUE(e.passed) << e.function << "." << e.output << ": " << e.worst << ", kappa " << e.condition;
}

TEST(VerifyTree, EveryFunctionOfTheSmallArm) {
  expect_passed(read_robot_text(testing::arm(), "arm.urdf"), tree_function_names(), 5);
}
TEST(VerifyTree, EveryFunctionOfTheWalker) {
  RobotOptions options;
  options.floating = true;
  expect_passed(read_robot_text(testing::walker(), "walker.urdf", options), tree_function_names(), 5);
}
TEST(VerifyTree, EveryFunctionOfAFreeBaseWithAFixedLink) {
  RobotOptions options;
  options.floating = true;
  expect_passed(read_robot_text(testing::arm(), "arm.urdf", options), tree_function_names(), 5);
}
TEST(VerifyTree, SymbolicInertia) {
  RobotOptions options;
  options.symbolic_inertia = true;
  expect_passed(read_robot_text(testing::arm(), "arm.urdf", options), {}, 5);
}
TEST(VerifyTree, Arm7) { expect_passed(testing::shipped_robot("arm7"), tree_function_names(), 10); }
TEST(VerifyTree, Quadruped) { expect_passed(testing::shipped_robot("quadruped"), {}, 10); }
TEST(VerifyTree, Humanoid) { expect_passed(testing::shipped_robot("humanoid"), {}, 5); }

/// A program with one output changed by 1e-12 of itself has to fail.
TEST(VerifyTree, FindsAWrongFunction) {
  const Model model = read_robot_text(testing::serial_arm(), "arm.urdf");
  TreeRequest request;
  request.functions = {"inverse_dynamics"};
  const auto derivation = derive_tree(model, request);
  Program& program = derivation->program;
  NodeId& output = program.functions.at(0).outputs.back().nodes.at(1);
  const Expr factor(program.tape, program.tape.constant(Exact::from_decimal("1.000000000001")));
  output = (factor * Expr(program.tape, output)).id(program.tape);
  const Verification v = verify_tree(model, *derivation, {3}, {});
  EXPECT_FALSE(v.passed);
  EXPECT_GT(v.formula_worst, 1e-14);
}

/// Robots that users point at by ANHOLON_ROBOTS, as a variable of the environment or of CMake; their files
/// are not part of the project. The largest is verified in its default functions only: the compiler needs a
/// minute for all.
class RealRobots : public ::testing::TestWithParam<std::string> {};

TEST_P(RealRobots, PassVerification) {
  const char* chosen = std::getenv("ANHOLON_ROBOTS");
  const std::string folder = chosen == nullptr ? ANHOLON_ROBOTS : chosen;
  const std::filesystem::path file = std::filesystem::path(folder) / (GetParam() + ".urdf");
  if (folder.empty() || !std::filesystem::exists(file)) GTEST_SKIP() << "no " << GetParam();
  RobotOptions options;
  options.floating =
      GetParam() != "ur5" && GetParam() != "iiwa" && GetParam() != "panda" && GetParam() != "double_pendulum";
  const bool all = GetParam() != "talos_full";
  expect_passed(read_robot(file, options), all ? tree_function_names() : std::vector<std::string>{},
                GetParam().starts_with("talos") ? 5 : 20);
}

INSTANTIATE_TEST_SUITE_P(All, RealRobots,
                         ::testing::Values("double_pendulum", "ur5", "iiwa", "panda", "anymal_b", "hyq",
                                           "talos_reduced", "talos_full"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace anholon::verify_tree_test
