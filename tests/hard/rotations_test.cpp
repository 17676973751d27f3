// SPDX-License-Identifier: GPL-2.0-or-later
//
// Bodies that turn, through generated code and the integrators of the runtime: against published figures,
// conserved quantities and Jacobi's elliptic functions. The tests of the suite LongHard repeat others over
// more steps.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hard/extrapolation.hpp"
#include "hard/model_file.hpp"
#include "hard/motion_row.hpp"
#include "hard/table.hpp"
#include "simulate/work_precision.hpp"

namespace anholon::testing::rotations_test {
namespace {

const std::string of_turns = "Bodies that turn";

/// Errors of the final state by generated code and by recursion, at one rung; against collocation in
/// long double.
struct FinalErrors {
  double generated = INFINITY, recursion = INFINITY, reference = INFINITY;
};
FinalErrors final_errors(const Scene& scene, int decade) {
  const WorkPrecision result = work_precision(scene, {}, {decade, decade, true});
  FinalErrors errors{INFINITY, INFINITY, result.reference_error};
  for (const WorkPrecisionPoint& p : result.points) {
    if (p.status == "ok") (p.code == "generated" ? errors.generated : errors.recursion) = p.error;
  }
  return errors;
}

/// The top after t seconds by Euler's equations in body axes, written by hand and integrated to 30 digits:
///
///   J Omega' = J Omega x Omega + m g l (y x -R^T z),   R' = R [Omega]
///
/// @return (12) R row-major, Omega
ExactVector top_by_euler(double t) {
  const Exact J_d = Exact::from_double(0.234375 + 15), J_a = Exact::from_double(0.46875),  // about the origin
      moment = Exact::from_double(15) * Exact::from_double(9.81);
  const std::vector<Exact> J = {J_d, J_a, J_d};
  const ExactField f = [&](const ExactVector& s) {
    ExactVector rate(12);
    const auto R = [&](std::size_t i, std::size_t j) { return s[3 * i + j]; };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
      for (std::size_t i = 0; i < 3; ++i) rate[3 * i + k] = R(i, a) * s[9 + b] - R(i, b) * s[9 + a];
      rate[9 + k] = (J[a] - J[b]) * s[9 + a] * s[9 + b] / J[k];
    }
    rate[9] -= moment * R(2, 2) / J[0];  // y x -R^T z = (-R_zz, 0, R_zx)
    rate[11] += moment * R(2, 0) / J[2];
    return rate;
  };
  const auto number = [](double x) { return Exact::from_double(x).as_float(); };
  ExactVector s(12, number(0));
  for (const std::size_t i : {0, 4, 8}) s[i] = number(1);
  s[10] = number(150), s[11] = number(-4.61538);
  return extrapolated(f, s, Exact::from_double(t), 12, Exact::from_decimal("1e-32"));
}

TEST(HardRotations, HeavyTopOfTheIntegrationBenchmarks) {
  const Scene scene = scene_file("tests/hard/heavy_top.scene.toml");
  const SimulationResult result = simulate_scene(scene);
  ASSERT_TRUE(result.finished) << result.status;
  const MotionRow end{result, result.rows.size() - 1};
  EXPECT_EQ(end("t"), 0.01);
  const WorkingDigits precision(45);
  const ExactVector exact = top_by_euler(end("t"));
  Exact world = 0;
  for (std::size_t j = 0; j < 3; ++j) world += exact[3 + j] * exact[9 + j];
  const double published = 149.8473939540758, found = in_world(end, Omega(end))[1];
  // 13 significant digits of the published figure are those of the motion; it has three more, of which the
  // last two are not: to 30 digits the motion says ...40745.
  EXPECT_NEAR(world.to_double(), published, 2e-12);
  // A rounding of 150, which is 2.8e-14, at each of 64 steps.
  EXPECT_NEAR(found, world.to_double(), 64 * 2.8e-14);
  EXPECT_NEAR(end("Omega_Y"), 150, 1e-12);  // the moment of gravity has no part about the axis
  const FinalErrors errors = final_errors(scene, -6);
  EXPECT_LT(errors.reference, 1e-16);
  EXPECT_LT(errors.generated, 1e-14);
  EXPECT_LT(errors.recursion, 1e-14);
  note({of_turns, "heavy top, spin of 150 rad/s", "world rate about y at 0.01 s",
        digits_text(std::abs(found / world.to_double() - 1)), "", "", "",
        fmt::format(
            "found {2:.13f}; Euler's equations to 30 digits say {0}; published is {1}, of which the last two "
            "digits are not those of the motion",
            world.decimal(16), published, found)});
  note({of_turns, "heavy top, spin of 150 rad/s", "body rate about its axis",
        digits_text(std::abs(end("Omega_Y") / 150 - 1)), "", "", "",
        "gravity has no moment about the axis, and the terms of equal inertias cancel in the program"});
  note({of_turns, "heavy top, spin of 150 rad/s", "final state", digits_text(errors.generated), "",
        digits_text(errors.recursion), "", "rounding; against collocation in long double"});
}

/// Largest relative departures of a free body over so many steps.
void tumble(const std::string& name, long steps, const std::string& method, double allowed_energy,
            double allowed_momentum, const std::string& why) {
  SCOPED_TRACE(name);
  const double step = 0.01, duration = static_cast<double>(steps) * step;
  const SimulationResult result = simulate_scene(scene_of_model(
      "free_body", fmt::format("initial = {{ velocities = {{ Omega_X = 0.9, Omega_Y = 0.7, Omega_Z = -0.4, "
                               "V_X = 0.01 }} }}\nduration = {}\noutput_step = {}\n"
                               "integrator = {{ method = \"{}\", step = {} }}\n",
                               duration, duration / 100, method, step)));
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_EQ(result.steps, steps);
  const std::array<double, 3> J = {1, 2, 3};
  std::array<double, 3> first{};
  double worst = 0, size = 0;
  PictureCurve momentum{method, {}, {}};
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    const MotionRow at{result, row};
    std::array<double, 3> L = Omega(at);
    for (std::size_t i = 0; i < 3; ++i) L[i] *= J[i];
    L = in_world(at, L);
    if (row == 0) first = L, size = std::hypot(L[0], L[1], L[2]);
    const double error = std::hypot(L[0] - first[0], L[1] - first[1], L[2] - first[2]) / size;
    momentum.x.push_back(at("t")), momentum.y.push_back(error);
    worst = std::max(worst, error);
  }
  EXPECT_LT(result.energy_balance, allowed_energy);
  EXPECT_LT(worst, allowed_momentum);
  note({of_turns, name, "energy", digits_text(result.energy_balance), "", "", "", why});
  note({of_turns, name, "angular momentum in the world", digits_text(worst), "", "", "", why});
  if (steps > 100'000)
    draw_picture("tumble_" + method, fmt::format("free tumbling body, {}: angular momentum", method), "t [s]",
                 "error relative to its size", {momentum}, true);
}

// Steps of 0.01 rad err by less than 1e-16 of themselves with order 8: what is left is rounding. Rates are
// summed with compensation; the orientation is a product of rotations, whose roundings add up like a random
// walk, 1e-16 sqrt(steps), or where they lean to one side 1e-16 steps.
const std::string rounding_why =
    "rounding of the products of rotations, one a step; rates are summed with compensation";
TEST(HardRotations, TumblingBodyOverTenThousandSteps) {
  tumble("free tumbling body, 1e4 steps of 0.01 s, rkmk8", 10'000, "rkmk8", 1e-14, 1e-12, rounding_why);
}
TEST(LongHard, TumblingBodyOverAMillionSteps) {
  tumble("free tumbling body, 1e6 steps of 0.01 s, rkmk8", 1'000'000, "rkmk8", 1e-13, 1e-10, rounding_why);
  // order 4: (0.01 rad)^4 a step of relative size 1e-8, of which 1e-10 a rad may stay in one direction
  tumble("the same by rkmk4", 1'000'000, "rkmk4", 1e-6, 1e-6, "the method's own error, of order 4");
}

/// Period of a free body's rates by Jacobi's elliptic functions: Landau & Lifshitz, Mechanics, section 37.
/// @param J  rising     @param w  rates with L^2 > 2 E J_2
double period(const std::array<double, 3>& J, const std::array<double, 3>& w) {
  // L^2 - 2 E J_i, without cancellation
  const auto excess = [&](std::size_t i) {
    double sum = 0;
    for (std::size_t j = 0; j < 3; ++j) sum += J[j] * (J[j] - J[i]) * w[j] * w[j];
    return sum;
  };
  const double rate = std::sqrt((J[2] - J[1]) * excess(0) / (J[0] * J[1] * J[2]));
  // k'^2 = 1 - k^2 = (J_3 - J_1)(L^2 - 2 E J_2)/((J_3 - J_2)(L^2 - 2 E J_1))
  double a = 1, b = std::sqrt((J[2] - J[0]) * excess(1) / ((J[2] - J[1]) * excess(0)));
  while (std::abs(a - b) > 4e-16 * a) {  // K by the arithmetic-geometric mean
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b), a = mean;
  }
  return 4 * std::numbers::pi / (2 * a) / rate;
}

/// One period of a body that spins about its middle axis, with small rates across it.
void flip(double small) {
  const std::array<double, 3> J = {1, 2, 3}, w = {small, 3, 2 * small};
  const double T = period(J, w);
  const SimulationResult result = simulate_scene(scene_of_model(
      "free_body", fmt::format("initial = {{ velocities = {{ Omega_X = {}, Omega_Y = {}, Omega_Z = {} }} }}\n"
                               "duration = {:.17g}\noutput_times = [{:.17g}, {:.17g}]\n"
                               "integrator = {{ method = \"dopri8\", tolerance = 1e-15 }}\n",
                               w[0], w[1], w[2], T, T / 2, T)));
  ASSERT_TRUE(result.finished) << result.status;
  ASSERT_GE(result.rows.size(), 3U);
  const MotionRow half{result, result.rows.size() - 2}, end{result, result.rows.size() - 1};
  // Half a period reverses the spin, a whole one returns. How long the spin stays near an axis, and with it
  // the phase, is the logarithm of L^2 - 2 E J_2, which is (small/3)^2 of the terms that it is made of: these
  // are rounded at every step, of which there are some hundreds. The spin itself departs from 3 by the square
  // of the rates across it, which an error of the phase may double.
  const double kappa = 9 / (small * small);
  EXPECT_NEAR(half("Omega_Y"), -3, 1e-13 + 10 * small * small);
  EXPECT_NEAR(end("Omega_Y"), 3, 1e-13 + 10 * small * small);
  const double error = std::hypot(end("Omega_X") - w[0], end("Omega_Z") - w[2]) / w[2];
  EXPECT_LT(error, 1e-14 * kappa);
  EXPECT_LT(result.energy_balance, 1e-13);
  const std::string name =
      fmt::format("Dzhanibekov's flips, {:g} rad/s across 3 rad/s, one period of {:.2f} s", small, T);
  note({of_turns, name, "spin", digits_text(std::abs(end("Omega_Y") / 3 - 1)), "", "", "",
        "against Jacobi's elliptic functions: reversed at half the period, back at its end"});
  note({of_turns, name, "rates across it", digits_text(error), "", "", fmt::format("{:.1g}", kappa),
        "the phase hangs on L^2 - 2 E J_2, which is 1/kappa of the terms that make it, and these are "
        "rounded"});
  note({of_turns, name, "energy", digits_text(result.energy_balance), "", "", "", "rounding"});
}
TEST(HardRotations, DzhanibekovFlipsKeepHalfTheDigits) { flip(1e-4); }
TEST(HardRotations, DzhanibekovFlipsNextToTheSeparatrix) { flip(1e-8); }

}  // namespace
}  // namespace anholon::testing::rotations_test
