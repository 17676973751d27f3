// SPDX-License-Identifier: GPL-2.0-or-later
// Charts of the kernel: where one basis cannot serve, several do; no digits are lost in the best of them, and
// a change of chart leaves the motion as it is.

#include "reduce/atlas.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "anholon/charts.hpp"
#include "check/regularity.hpp"
#include "describe/mechanise.hpp"
#include "emit/header.hpp"
#include "simulate/simulation.hpp"
#include "singular/exact_inputs.hpp"
#include "singular/wheeled_snake.hpp"

namespace anholon::atlas_test {
namespace {

using test::BothInputs;
using test::distance;

const std::string here = std::string(ANHOLON_SOURCE_DIR) + "/tests/singular/";

/// Attitude whose body components of the vertical are u, row-major.
std::vector<double> attitude(const Eigen::Vector3d& u, double heading) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      Eigen::Quaterniond::FromTwoVectors(u, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  std::vector<double> rows;
  for (int i = 0; i < 9; ++i) rows.push_back(R(i / 3, i % 3));
  return rows;
}

class SpinlessBody : public ::testing::Test {
 protected:
  SpinlessBody()
      : model(read_model(here + "without_spin.toml")),
        derivation(derive(model)),
        generated(compiled_caller(derivation->program, test::rounded_parameters(model))),
        exact(interpreting_caller<Exact>(derivation->program, test::rounded_parameters(model))),
        charts(derivation->reduction.charts.size()) {}

  Model model;
  std::unique_ptr<Derivation> derivation;
  ProgramCaller<double> generated;
  ProgramCaller<Exact> exact;
  std::size_t charts;
};

// There is no field of directions on the sphere: two charts cannot do, the three pairs of axes can.
TEST_F(SpinlessBody, HasThreeCharts) {
  ASSERT_EQ(charts, 3U);
  EXPECT_TRUE(derivation->reduction.why_charts.has_value());
  EXPECT_FALSE(derivation->reduction.unserved.has_value());
  for (const Kernel& chart : derivation->reduction.charts) EXPECT_EQ(chart.free.size(), 2U);
  const Regularity found = search_singularities(model, *derivation);
  EXPECT_EQ(found.singular_basis, std::nullopt);
  EXPECT_EQ(found.rank_drop, std::nullopt);
}

/// Attitudes all over the sphere, those among them where one or two charts are singular.
std::vector<Eigen::Vector3d> verticals() {
  std::vector<Eigen::Vector3d> all;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double small : {0.0, 1e-300, 1e-16, 1e-9, -1e-6, 1e-3, 0.1, 0.5, 1.0}) {
      Eigen::Vector3d u(small, -small, small / 2);
      u(axis) = 1;
      all.push_back(u.normalized());
      all.emplace_back(-u.normalized());
      Eigen::Vector3d v = u;
      v((axis + 1) % 3) = 1;
      all.push_back(v.normalized());
    }
  }
  return all;
}

TEST_F(SpinlessBody, KeepsAllDigitsAtEveryAttitude) {
  const WorkingDigits precision(50);
  const auto chart_at = chart_finder<double>(*derivation);
  double worst = 0;
  for (const Eigen::Vector3d& u : verticals()) {
    SCOPED_TRACE(::testing::Message() << u.transpose());
    BothInputs in;
    in.set("R", attitude(u, 0.4));
    in.set("nu", {0.7, -1.3});
    const std::string chart = chart_prefix(chart_at(in.rounded));
    const auto got = generated(chart + "forward_dynamics", in.rounded);
    const auto want = exact(chart + "forward_dynamics", in.exact);
    // the default bound of the project; the condition of (A, B_p) is 1, that of H at most sqrt(3)
    EXPECT_LT(distance(got.at("eta_dot"), want.at("eta_dot")), 1e-13);
    EXPECT_LT(distance(got.at("nu_dot"), want.at("nu_dot")), 1e-13);
    worst = std::max(worst, distance(got.at("eta_dot"), want.at("eta_dot")));
    EXPECT_GT(generated("chart_quality", in.rounded).at("quality")[chart_at(in.rounded)], 0.5);
  }
  RecordProperty("worst", std::to_string(worst));
}

// Every pair of charts, wherever both are of use.
TEST_F(SpinlessBody, GoesOnInAnotherChartWithoutAJump) {
  int changes = 0;
  for (const Eigen::Vector3d& u : verticals()) {
    BothInputs in;
    in.set("R", attitude(u, -1.1));
    const std::vector<double> quality = generated("chart_quality", in.rounded).at("quality");
    const double best = quality[best_chart(std::span<const double>(quality))];
    for (std::size_t from = 0; from < charts; ++from) {
      if (!(quality[from] > 0.1 * best)) continue;  // hysteresis leaves a chart at a quarter
      in.set("nu", {0.7, -1.3});
      const auto velocity = generated(chart_prefix(from) + "kinematics", in.rounded).at("eta");
      const auto acceleration = generated(chart_prefix(from) + "forward_dynamics", in.rounded).at("eta_dot");
      for (std::size_t to = 0; to < charts; ++to) {
        if (to == from || !(quality[to] > 0.1 * best)) continue;
        ++changes;
        in.set("eta", velocity);
        in.set("nu", generated(chart_prefix(to) + "reduced_velocities", in.rounded).at("nu"));
        EXPECT_LT(distance(generated(chart_prefix(to) + "kinematics", in.rounded).at("eta"), velocity),
                  1e-14);
        EXPECT_LT(distance(generated(chart_prefix(to) + "forward_dynamics", in.rounded).at("eta_dot"),
                           acceleration),
                  1e-12);  // the bound of the issue
      }
    }
  }
  EXPECT_GT(changes, 30);
}

TEST_F(SpinlessBody, GivesEveryChartANamespaceOfTheHeader) {
  const std::string header = emit_header(derivation->program);
  for (const char* text :
       {"namespace chart1 {", "using without_spin::standard::forward_dynamics;", "namespace chart2 {",
        "namespace chart3 {", "inline void chart_quality(", "inline int choose_chart("})
    EXPECT_NE(header.find(text), std::string::npos) << text;
  const std::string use = R"(#include "program.hpp"
extern "C" int chart_test(void);
extern "C" int chart_test(void) {
  using namespace without_spin::standard;
  const double nan = std::nan("");
  const double good[3] = {0.5, 0.9, 0.1}, poor[3] = {0.1, 0.9, 0.2}, broken[3] = {nan, 0.3, nan};
  const auto par = prepare(Parameters<double>{});
  const double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, nu[2] = {1, 2};
  double eta_1[3], eta_2[3], H[6];
  chart1::kinematics(par, R, nu, eta_1, H);
  kinematics(par, R, nu, eta_2, H);
  chart2::kinematics(par, R, nu, eta_2, H);
  return choose_chart(good, 1) * 1000 + choose_chart(poor, 1) * 100 + choose_chart(broken, 1) * 10 +
         choose_chart(good, 0);
}
)";
  EXPECT_NO_THROW(compile_cached(header, use)) << header;
}

TEST(ChartChoice, StaysWhileItsChartIsAQuarterAsGoodAsTheBest) {
  const auto next = [](std::vector<double> quality, std::size_t current) {
    return next_chart(std::span<const double>(quality), current);
  };
  EXPECT_EQ(next({0.5, 0.9, 0.1}, 0), 0U);
  EXPECT_EQ(next({0.2, 0.9, 0.1}, 0), 1U);
  EXPECT_EQ(next({0.23, 0.9, 0.1}, 0), 0U);
  EXPECT_EQ(next({NAN, 0.3, 0.2}, 0), 1U);
  EXPECT_EQ(next({0.3, NAN}, 0), 0U);
  EXPECT_EQ(next({0.3, NAN}, 1), 0U);
  EXPECT_EQ(next({0.0, 0.0}, 1), 1U);  // nowhere to go
}

// Motion through many changes of chart: energy is conserved, since the row does no work, and the motion is
// the one that full equations with a multiplier give (multiplier_test.cpp).
TEST(SpinlessMotion, ConservesItsEnergyThroughManyChanges) {
  const SimulationResult result = simulate_scene(read_scene(here + "tumble.scene.toml"));
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_EQ(result.charts, 3U);
  EXPECT_GE(result.chart_changes.size(), 3U);
  EXPECT_LT(result.energy_balance, 1e-9);  // tolerance 1e-11 a step, some hundred steps
  EXPECT_LT(result.constraint_residual, 1e-14);
  EXPECT_LT(result.orthonormality, 1e-14);
}

// The description may ask for its own velocities: it gets them, and `check` says where they do not serve.
TEST(ChartChoice, LeavesTheDescriptionItsWish) {
  Model model = read_model(here + "without_spin.toml");
  model.free_velocities = {"Omega_X", "Omega_Y"};
  DeriveRequest request;
  request.functions = {"kinematics", "constraints"};
  const auto derivation = derive(model, request);
  EXPECT_EQ(derivation->reduction.charts.size(), 1U);
  EXPECT_EQ(derivation->reduction.kernel.free, (std::vector<int>{0, 1}));
  EXPECT_TRUE(search_singularities(model, *derivation).singular_basis.has_value());
}

TEST(ChartChoice, TakesOneBasisWhereOneServes) {
  for (const char* name : {"bicycle", "trailer", "rigid_snakeboard", "soft_snakeboard", "mobile_pendulum",
                           "ball_on_incline", "rattleback"}) {
    DeriveRequest request;
    request.functions = {"kinematics"};
    request.closed_forms = false;
    const auto derivation = derive(test::shipped(name), request);
    EXPECT_EQ(derivation->reduction.charts.size(), 1U) << name;
    EXPECT_EQ(find_function(derivation->program, "chart_quality"), nullptr) << name;
  }
}

// A circle of directions: two charts, sine and cosine, serve it.
TEST(ChartChoice, CoversACircleByTwoCharts) {
  std::vector<Eigen::MatrixXd> A;
  for (int i = 0; i < 100; ++i)
    A.push_back((Eigen::MatrixXd(1, 2) << std::cos(0.1 * i), std::sin(0.1 * i)).finished());
  const ChartChoice choice(A, 1, velocity_sizes(A));
  EXPECT_EQ(choice.free_sets().size(), 2U);
}

// Sizes even out units: a lever of a millimetre in place of a metre changes nothing.
TEST(ChartChoice, DoesNotDependOnUnits) {
  std::vector<Eigen::MatrixXd> A;
  for (int i = 0; i < 100; ++i)
    A.push_back((Eigen::MatrixXd(1, 2) << std::cos(0.1 * i), 1e-3 * std::sin(0.1 * i)).finished());
  const std::vector<double> sizes = velocity_sizes(A);
  EXPECT_NEAR(std::log2(sizes[1] / sizes[0]), std::log2(1000), 1.01);  // powers of two
  EXPECT_EQ(ChartChoice(A, 1, sizes).free_sets().size(), 2U);
}

}  // namespace
}  // namespace anholon::atlas_test
