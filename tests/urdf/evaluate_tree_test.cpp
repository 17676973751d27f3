// SPDX-License-Identifier: GPL-2.0-or-later

// `evaluate` of robots from URDF files: generated code, recursion and exact arithmetic answer alike.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "check/evaluate.hpp"
#include "reduce/samples.hpp"
#include "urdf/oracle_state.hpp"
#include "urdf/small_robots.hpp"

namespace anholon::evaluate_tree_test {
namespace {

using Json = nlohmann::ordered_json;

/// States in the layout of docs/evaluate.md; every number is a double.
Json random_states(const Model& model, int count) {
  SampleSource source(8);
  Json file;
  Json& names = file["coordinates"]["r_a"] = Json::array();
  for (const Coordinate& c : model.coordinates) names.push_back(c.name);
  for (int i = 0; i < count; ++i) {
    const State<Exact> s = random_state(model, source);
    Json in;
    for (int row = 0; row < 3; ++row)
      in["g"]["R"].push_back({s.R(row, 0).to_double(), s.R(row, 1).to_double(), s.R(row, 2).to_double()});
    in["g"]["p"] = {s.p.x.to_double(), s.p.y.to_double(), s.p.z.to_double()};
    const auto fill = [&](const char* key, std::size_t size, const auto& take) {
      in[key] = Json::array();
      for (std::size_t k = 0; k < size; ++k) in[key].push_back(take(k).to_double());
    };
    const auto any = [&](std::size_t) { return source.uniform(Exact(-1), Exact(1)); };
    const auto components = free_components(model.group);
    fill("eta", components.size(), [&](std::size_t k) { return s.eta[components[k]]; });
    fill("eta_dot", components.size(), any);
    fill("r_a", s.r.size(), [&](std::size_t k) { return s.r[k]; });
    fill("rdot_a", s.r.size(), [&](std::size_t k) { return s.r_dot[k]; });
    fill("rddot_a", s.r.size(), any);
    fill("tau_a", s.r.size(), any);
    file["states"].push_back({{"label", std::to_string(i)}, {"inputs", std::move(in)}});
  }
  return file;
}

double number(const Json& x) { return x.is_string() ? std::stod(x.get<std::string>()) : x.get<double>(); }

void flatten(const Json& x, std::vector<double>& to) {
  if (x.is_array()) {
    for (const Json& e : x) flatten(e, to);
  } else {
    to.push_back(number(x));
  }
}

/// Compares every array and number of two answers, each relative to its largest entry.
void compare(const std::string& where, const Json& got, const Json& want, double tolerance, int& compared) {
  if (want.is_object()) {
    ASSERT_TRUE(got.is_object()) << where;
    for (const auto& [key, value] : want.items()) {
      ASSERT_TRUE(got.contains(key)) << where << " has no " << key;
      compare(fmt::format("{}.{}", where, key), got[key], value, tolerance, compared);
    }
    return;
  }
  std::vector<double> a, b;
  flatten(got, a), flatten(want, b);
  ASSERT_EQ(a.size(), b.size()) << where;
  double scale = 0, worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    scale = std::max(scale, std::abs(b[i]));
    worst = std::max(worst, std::abs(a[i] - b[i]));
  }
  EXPECT_LE(worst, tolerance * scale) << where;
  ++compared;
}

/// @param tolerance  10 eps times the condition number of the robot's mass matrix at these states, rounded up
void expect_agreement(const Model& model, const std::string& name, double tolerance) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / (name + "_states.json");
  std::ofstream(file) << random_states(model, 3).dump(1);
  const StatesFile states = read_states(file, model);
  EvaluateRequest request;
  request.tree = TreeRequest();
  request.method = EvaluationMethod::exact;
  const Json exact = evaluate_states(model, states, request);
  int compared = 0;
  for (const EvaluationMethod method : {EvaluationMethod::generated, EvaluationMethod::recursion}) {
    request.method = method;
    const Json answer = evaluate_states(model, states, request);
    for (std::size_t i = 0; i < 3; ++i)
      compare(name, answer["states"][i]["outputs"], exact["states"][i]["outputs"], tolerance, compared);
  }
  EXPECT_GT(compared, 100);
  std::filesystem::remove(file);
}

TEST(EvaluateTree, Arm7) { expect_agreement(testing::shipped_robot("arm7"), "arm7", 1e-12); }
TEST(EvaluateTree, Quadruped) { expect_agreement(testing::shipped_robot("quadruped"), "quadruped", 1e-11); }
TEST(EvaluateTree, ArmWithDampersAndMimic) {
  expect_agreement(read_robot_text(testing::arm(), "arm.urdf"), "arm", 1e-12);
}

}  // namespace
}  // namespace anholon::evaluate_tree_test
