// SPDX-License-Identifier: GPL-2.0-or-later

// The derived functions against the numeric recursion on the mechanism as described, in double and in exact numbers.

#include "derive/tree_functions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_urdf.hpp"
#include "optimise/tape/count.hpp"
#include "urdf/random_state.hpp"
#include "urdf/small_robots.hpp"

namespace anholon {
namespace {

using testing::random_state;
using testing::RandomState;
using testing::run;

/// Largest difference, in parts of the largest entry of the reference.
template <class S>
S error(const std::vector<S>& got, const std::vector<S>& reference) {
  using std::abs;
  EXPECT_EQ(got.size(), reference.size());
  S worst = S(0), scale = S(1);
  for (std::size_t i = 0; i < std::min(got.size(), reference.size()); ++i) {
    if (abs(got[i] - reference[i]) > worst) worst = abs(got[i] - reference[i]);
    if (abs(reference[i]) > scale) scale = abs(reference[i]);
  }
  return worst / scale;
}

/// Compares every function with the recursion; forward dynamics by putting its answer into the recursion.
template <class S>
void compare(const Mechanism<S>& mechanism, const Program& program, const RandomState<S>& x, const S& tolerance) {
  FreeDynamics<S> dynamics(mechanism);
  State<S> rest = x.state;
  rest.eta = {};
  for (S& rate : rest.r_dot) rate = S(0);
  const std::vector<S> zero(x.acceleration.size(), S(0));
  EXPECT_LT(error(run(program, "inverse_dynamics", x.inputs), dynamics.inverse_dynamics(x.state, x.acceleration)), tolerance);
  EXPECT_LT(error(run(program, "bias_forces", x.inputs), dynamics.inverse_dynamics(x.state, zero)), tolerance);
  EXPECT_LT(error(run(program, "gravity_forces", x.inputs), dynamics.inverse_dynamics(rest, zero)), tolerance);
  EXPECT_LT(error(run(program, "mass_matrix", x.inputs), dynamics.mass_matrix(x.state).entries()), tolerance);
  const std::vector<S> applied = dynamics.inverse_dynamics(x.state, run(program, "forward_dynamics", x.inputs));
  std::vector<S> expected(applied.size() - x.tau.size(), S(0));
  expected.insert(expected.end(), x.tau.begin(), x.tau.end());
  const std::vector<S> M = dynamics.mass_matrix(x.state).entries();
  S largest = S(1);  // forces are sums of terms that large
  for (const S& a : run(program, "forward_dynamics", x.inputs)) {
    using std::abs;
    if (abs(a) > largest) largest = abs(a);
  }
  EXPECT_LT(error(applied, expected), S(20) * largest * tolerance);
}

void verify(const Model& model, const TreeRequest& request = {}) {
  const auto derivation = derive_tree(model, request);
  const Program& program = derivation->program;
  ASSERT_EQ(program.functions.size(), tree_function_names().size());
  const MechanismDescription description = describe_mechanism(model);
  std::vector<double> parameters;
  std::vector<Exact> exact_parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double()), exact_parameters.push_back(p.value);
  const Mechanism<double> mechanism = mechanise<double>(description, parameters);
  std::mt19937 random(7);
  for (int i = 0; i < 20; ++i) compare(mechanism, program, random_state<double>(program, random, [](double v) { return v; }), 1e-13);
  const Mechanism<Exact> exact = mechanise<Exact>(description, exact_parameters);
  compare(exact, program, random_state<Exact>(program, random, [](double v) { return Exact::from_double(v); }), Exact::from_decimal("1e-60"));
}

TEST(TreeFunctions, ArmWithEveryKindOfJoint) { verify(read_urdf_text(testing::serial_arm(), "arm.urdf")); }
TEST(TreeFunctions, ArmWithMimic) { verify(read_urdf_text(testing::arm(), "arm.urdf")); }
TEST(TreeFunctions, WithoutSearch) {
  TreeRequest request;
  request.search = false;
  verify(read_urdf_text(testing::serial_arm(), "arm.urdf"), request);
}
TEST(TreeFunctions, FloatingWalker) {
  UrdfOptions options;
  options.floating = true;
  verify(read_urdf_text(testing::walker(), "walker.urdf", options));
}
TEST(TreeFunctions, FloatingArm) {
  UrdfOptions options;
  options.floating = true;
  verify(read_urdf_text(testing::arm(), "arm.urdf", options));
}
TEST(TreeFunctions, SymbolicInertia) {
  UrdfOptions options;
  options.floating = true;
  options.symbolic_inertia = true;
  verify(read_urdf_text(testing::walker(), "walker.urdf", options));
}

TEST(TreeFunctions, SearchNeverCostsOperations) {
  const Model model = read_urdf_text(testing::walker(), "walker.urdf");
  TreeRequest plain;
  plain.search = false;
  const auto total = [](const TreeDerivation& d) {
    int sum = 0;
    for (const CandidateReport& c : d.candidates) sum += c.chosen ? c.operations : 0;
    return sum;
  };
  EXPECT_LE(total(*derive_tree(model)), total(*derive_tree(model, plain)));
}

TEST(TreeFunctions, SameProgramEveryTime) {
  const Model model = read_urdf_text(testing::walker(), "walker.urdf");
  const auto a = derive_tree(model);
  const auto b = derive_tree(model);
  ASSERT_EQ(a->program.tape.size(), b->program.tape.size());
  for (std::size_t f = 0; f < a->program.functions.size(); ++f) {
    for (std::size_t o = 0; o < a->program.functions[f].outputs.size(); ++o)
      EXPECT_EQ(a->program.functions[f].outputs[o].nodes, b->program.functions[f].outputs[o].nodes);
  }
}

/// Robots that users point the tests at; their files are not part of the project.
class Robots : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(ANHOLON_ROBOTS) / (GetParam() + ".urdf");
    if (std::string(ANHOLON_ROBOTS).empty() || !std::filesystem::exists(file_)) GTEST_SKIP() << "ANHOLON_ROBOTS has no " << GetParam();
  }
  [[nodiscard]] Model model() const {
    UrdfOptions options;
    options.floating = GetParam() != "ur5" && GetParam() != "iiwa" && GetParam() != "panda" && GetParam() != "double_pendulum";
    return read_urdf(file_, options);
  }
  std::filesystem::path file_;
};

TEST_P(Robots, AgreeWithTheRecursion) { verify(model()); }

TEST_P(Robots, KeepTheirOperationCounts) {
  static const std::map<std::string, std::map<std::string, int>> reached = {
      {"ur5", {{"inverse_dynamics", 261}, {"mass_matrix", 147}, {"forward_dynamics", 456}}},
      {"iiwa", {{"inverse_dynamics", 399}, {"mass_matrix", 214}, {"forward_dynamics", 735}}},
      {"panda", {{"inverse_dynamics", 554}, {"mass_matrix", 338}, {"forward_dynamics", 1105}}},
      {"anymal_b", {{"inverse_dynamics", 1268}, {"mass_matrix", 552}, {"forward_dynamics", 2619}}},
      {"hyq", {{"inverse_dynamics", 1303}, {"mass_matrix", 614}, {"forward_dynamics", 2720}}},
      {"talos_reduced", {{"inverse_dynamics", 3366}, {"mass_matrix", 3022}, {"forward_dynamics", 7658}}},
      {"talos_full", {{"inverse_dynamics", 4520}, {"mass_matrix", 5173}, {"forward_dynamics", 9860}}}};
  const auto bounds = reached.find(GetParam());
  if (bounds == reached.end()) GTEST_SKIP();
  const auto derivation = derive_tree(model());
  for (const CandidateReport& c : derivation->candidates) {
    const auto bound = bounds->second.find(c.function);
    if (!c.chosen || bound == bounds->second.end()) continue;
    EXPECT_LE(c.operations, bound->second) << c.function << ": " << c.route;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Robots, ::testing::Values("double_pendulum", "ur5", "iiwa", "panda", "anymal_b", "hyq", "talos_reduced", "talos_full"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace anholon
