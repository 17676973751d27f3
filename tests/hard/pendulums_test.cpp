// SPDX-License-Identifier: GPL-2.0-or-later
//
// Motions that amplify errors, or that are far faster than others: generated code against Lagrange's
// equations written by hand and integrated to 30 digits, and against collocation in long double.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hard/extrapolation.hpp"
#include "hard/model_file.hpp"
#include "hard/motion_row.hpp"
#include "hard/pendulum_equations.hpp"
#include "hard/table.hpp"
#include "simulate/work_precision.hpp"

namespace anholon::testing::pendulums_test {
namespace {

const std::string section = "Motions that amplify errors";

struct Chaos {
  std::string model, name;
  Links links;
  std::vector<double> angles;  // of the joints at the start, at rest
};
Chaos double_pendulum() {
  const Exact J = Exact::from_double(0.01), g = Exact::from_double(9.81);
  return {"double_pendulum", "double pendulum", {{1, 1}, {1, 1}, {J, J}, g}, {2.5, 0.4}};
}
Chaos triple_pendulum() {
  return {"triple_pendulum",
          "triple pendulum",
          {{1, 1, 1}, {1, 1, 1}, {0, 0, 0}, Exact::from_double(9.81)},
          {2.2, 0.5, -0.7}};
}

/// Follows a chaotic pendulum in double and to 30 digits and more.
/// @param horizon  s, of the comparison     @param expected  s, that double must follow to 1e-3 rad
void follow(const Chaos& chaos, double horizon, double expected) {
  const WorkingDigits precision(45);
  const std::size_t n = chaos.angles.size();
  const double H = 0.05;
  const ExactField f = [&](const ExactVector& y) {
    const auto middle = y.begin() + static_cast<std::ptrdiff_t>(n);
    ExactVector rates(middle, y.end());
    const std::vector<Exact> second = accelerations(chaos.links, {y.begin(), middle}, rates);
    rates.insert(rates.end(), second.begin(), second.end());
    return rates;
  };
  ExactVector y;
  std::string initial;
  for (std::size_t i = 0; i < n; ++i) {
    y.push_back(Exact::from_double(chaos.angles[i]).as_float());
    initial += fmt::format("{}r{} = {:.17g}", i == 0 ? "" : ", ", i + 1, chaos.angles[i]);
  }
  y.resize(2 * n, Exact(0).as_float());
  ExactVector checked = y;
  const SimulationResult result = simulate_scene(scene_of_model(
      chaos.model, fmt::format("initial = {{ coordinates = {{ {} }} }}\nduration = {}\noutput_step = {}\n"
                               "integrator = {{ method = \"dopri8\", tolerance = 1e-16 }}\n",
                               initial, horizon, H)));
  ASSERT_TRUE(result.finished) << result.status;
  const auto distance = [n](const ExactVector& a, const auto& b) {
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs((a[i] - b(i)).to_double()));
    return largest;
  };
  PictureCurve of_double{"generated code in double, tolerance 1e-16", {}, {}},
      of_exact{"two runs of 30 digits", {}, {}};
  double followed = 0;
  bool lost = false;
  for (std::size_t row = 1; row < result.rows.size(); ++row) {
    const double t = result.rows[row][0];
    const Exact step = Exact::from_double(t - result.rows[row - 1][0]);
    y = extrapolated(f, y, step, 13, Exact::from_decimal("1e-30"));
    checked = extrapolated(f, checked, step, 10, Exact::from_decimal("1e-28"));  // the witness of the witness
    const double error = distance(y, [&](std::size_t i) {
      return Exact::from_double(MotionRow{result, row}(fmt::format("r{}", i + 1)));
    });
    of_double.x.push_back(t), of_double.y.push_back(error);
    of_exact.x.push_back(t), of_exact.y.push_back(distance(y, [&](std::size_t i) { return checked[i]; }));
    if (error > 1e-3) lost = true;
    if (!lost) followed = t;
  }
  // The witness has to be better than double by ten digits at every instant that double still follows.
  for (std::size_t i = 0; i < of_double.x.size() && of_double.x[i] <= followed; ++i)
    EXPECT_LT(of_exact.y[i], 1e-10 * std::max(of_double.y[i], 1e-16)) << of_double.x[i];
  EXPECT_LT(of_double.y.front(), 1e-14);
  EXPECT_GE(followed, std::min(expected, horizon) - H / 2);
  EXPECT_LT(result.energy_balance, 1e-12);  // 1e-16 a step of some thousands
  // Errors grow as exp(lambda t): the mean rate between the first row and the last that is followed.
  std::size_t last = 0;
  while (last + 1 < of_double.x.size() && of_double.x[last + 1] <= followed) ++last;
  const double growth =
      std::log(of_double.y[last] / of_double.y.front()) / (of_double.x[last] - of_double.x.front());
  note({section, fmt::format("chaotic {} over {:g} s", chaos.name, horizon), "angles",
        lost ? fmt::format("3 until {:.3g} s", followed) : digits_text(of_double.y.back()), "", "",
        fmt::format("exp({:.1f} t)", growth),
        fmt::format("the motion itself multiplies any error; energy keeps {} digits all along",
                    digits_text(result.energy_balance))});
  if (horizon > 5)
    draw_picture(chaos.model, fmt::format("chaotic {}: error of an angle", chaos.name), "t [s]", "rad",
                 {of_double, of_exact}, false);
}

TEST(HardPendulums, DoublePendulumForOneSecond) { follow(double_pendulum(), 1, 1); }
TEST(HardPendulums, TriplePendulumForHalfASecond) { follow(triple_pendulum(), 0.5, 0.5); }
TEST(LongHard, DoublePendulumForTwentySeconds) { follow(double_pendulum(), 20, 12); }
TEST(LongHard, TriplePendulumUntilDoubleLosesIt) { follow(triple_pendulum(), 16, 8); }

TEST(HardPendulums, JointOfStiffness1e8) {
  const Scene scene = scene_of_model(
      "double_pendulum",
      "parameters = { k = 1e8 }\ninitial = { coordinates = { r1 = 0.5, r2 = 1e-6 } }\nduration = 0.02\n"
      "integrator = { method = \"dopri8\", tolerance = 1e-14 }\n");
  const WorkPrecision result = work_precision(scene, {}, {-14, -14, true});
  ASSERT_EQ(result.points.size(), 2U);
  for (const WorkPrecisionPoint& p : result.points) {
    ASSERT_EQ(p.status, "ok") << p.code;
    // 0.02 s are some 300 rad of the oscillation, each rounded to 1e-16 in hundreds of steps
    EXPECT_LT(p.error, 1e-9) << p.code;
  }
  EXPECT_LT(result.reference_error, 1e-12);
  note({section, "joint of 1e8 N m/rad over 0.02 s", "final state", digits_text(result.points[0].error), "",
        digits_text(result.points[1].error), "",
        fmt::format("{} evaluations follow every oscillation; what adds up is its phase",
                    result.points[0].evaluations)});
}

/// A motion whose accelerations have lost their digits says so: the short link hangs above one that is 1e9
/// times as long, and elimination through the mass matrix is all there is below an imposed motion.
TEST(HardPendulums, MotionThatLosesItsDigitsSaysSo) {
  const auto moved = [](double l_1, const char* aim) {
    Scene scene =
        scene_of_model("pushed_pendulum",
                       fmt::format("parameters = {{ l_1 = {}, l_2 = 1000 }}\nmotion = {{ x = \"0\" }}\n"
                                   "initial = {{ coordinates = {{ r1 = 0.5, r2 = 0.3 }} }}\nduration = 1e-6\n"
                                   "integrator = {{ method = \"rkmk4\", step = 1e-6 }}\n",
                                   l_1));
    scene.optimise = aim;
    return simulate_scene(scene);
  };
  const SimulationResult sound = moved(1000, "speed"), lost = moved(1e-6, "speed");
  const SimulationResult kept = moved(1e-6, "balanced");  // takes the closed form
  EXPECT_FALSE(kept.rounding.is_loss());
  EXPECT_LT(kept.rounding.error, 1e-13);
  EXPECT_FALSE(sound.rounding.is_loss());
  EXPECT_LT(sound.rounding.error, 1e-13);
  EXPECT_TRUE(lost.rounding.is_loss()) << lost.rounding.error << " " << lost.rounding.least;
  EXPECT_GT(lost.rounding.error, 1e-3);
  EXPECT_LT(lost.rounding.least, 1e-13);  // kappa is below 100
}

}  // namespace
}  // namespace anholon::testing::pendulums_test
