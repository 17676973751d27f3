// SPDX-License-Identifier: GPL-2.0-or-later
//
// Drift of the position in a gait of many periods.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "anholon/lie/se2.hpp"
#include "check/compile_cache.hpp"
#include "hard/model_file.hpp"
#include "hard/motion_row.hpp"
#include "hard/table.hpp"
#include "simulate/motion_sizes.hpp"
#include "simulate/reference_solution.hpp"
#include "simulate/runner.hpp"
#include "simulate/scene_program.hpp"

namespace anholon::testing::gait_test {
namespace {

constexpr double T = 2.5;   // s, of a period
constexpr int steps = 100;  // of a period

Scene gait(double duration, double output_step) {
  return read_scene_text(
      fmt::format("anholon = 1\nname = \"many_periods\"\nmodel = \"rigid_snakeboard.toml\"\n"
                  "motion = {{ r1 = \"0.5*sin(4*pi/5*t)\", r3 = \"0.7*cos(4*pi/5*t)\" }}\n"
                  "initial = {{ velocities = {{ V_X = 0.5 }} }}\nduration = {}\noutput_step = {}\n"
                  "integrator = {{ method = \"rkmk8\", step = {} }}\n",
                  duration, output_step, T / steps),
      std::string(ANHOLON_SOURCE_DIR) + "/models/rigid_snakeboard/many_periods.scene.toml");
}

/// The pose after one period, by another method in long double.
lie::SE2<long double> pose_of_a_period() {
  const Scene scene = gait(T, T);
  const SceneProgram program = make_program(scene);
  const auto code = std::make_shared<CompiledProgram>(program.derivation->program);
  const Runner<double> run(scene, program, code);
  const ReferenceSolution reference = reference_solution(scene, program, MotionSizes(program, run));
  EXPECT_LT(reference.own_error, 1e-17);
  return {reference.state[9], reference.state[10], std::atan2(reference.state[3], reference.state[0])};
}

/// Slope of log y over log x.
double exponent(const PictureCurve& c, std::size_t first) {
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0, count = 0;
  for (std::size_t i = first; i < c.x.size(); ++i)
    mean_x += std::log(c.x[i]), mean_y += std::log(c.y[i]), count += 1;
  for (std::size_t i = first; i < c.x.size(); ++i) {
    const double x = std::log(c.x[i]) - mean_x / count, y = std::log(c.y[i]) - mean_y / count;
    xx += x * x, xy += x * y;
  }
  return xy / xx;
}

/// The rates of a period repeat themselves, so that the pose after n of them is the n-th power of the pose
/// after one.
void drift(long periods) {
  const lie::SE2<long double> period = pose_of_a_period();
  const long stride = periods / 100;
  const SimulationResult result =
      simulate_scene(gait(T * static_cast<double>(periods), T * static_cast<double>(stride)));
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_EQ(result.steps, steps * periods);
  const MotionRow first{result, 0}, last{result, result.rows.size() - 1};
  EXPECT_NEAR(last("nu_1"), first("nu_1"), 1e-12);  // so that periods repeat
  lie::SE2<long double> wanted;
  PictureCurve position{"position [m]", {}, {}}, heading{"heading [rad]", {}, {}};
  for (std::size_t row = 1; row < result.rows.size(); ++row) {
    for (long i = 0; i < stride; ++i) wanted = wanted * period;
    const MotionRow at{result, row};
    position.x.push_back(at("t")), heading.x.push_back(at("t"));
    position.y.push_back(static_cast<double>(std::hypot(at("x") - wanted.x(), at("y") - wanted.y())));
    heading.y.push_back(static_cast<double>(std::abs(at("theta") - wanted.theta())));
  }
  const auto path = static_cast<double>(std::hypot(wanted.x(), wanted.y()));
  // Each step rounds heading and position to 1e-16 of their size; where the roundings lean to one side the
  // heading errs by as much a step, and the position by that times the path.
  EXPECT_LT(position.y.back() / path, 1e-16 * static_cast<double>(steps * periods));
  EXPECT_LT(heading.y.back(), 1e-16 * static_cast<double>(steps * periods));
  const std::string name =
      fmt::format("gait of the snake-board, {:.0e} steps", static_cast<double>(steps * periods));
  note({"Long horizons", name, fmt::format("position after {:.3g} m", path),
        digits_text(position.y.back() / path), "", "", "",
        fmt::format("{:.1e} m off, grows with t^{:.1f}: a product of poses, one a step, each rounded",
                    position.y.back(), exponent(position, position.x.size() / 10))});
  note({"Long horizons", name, "heading", fmt::format("to {:.1e} rad", heading.y.back()), "", "", "",
        fmt::format(
            "grows with t^{:.1f}: roundings of the heading, and of the phase of the imposed motion, 1e-16 t",
            exponent(heading, heading.x.size() / 10))});
  note({"Long horizons", name, "reduced velocity", digits_text(std::abs(last("nu_1") / first("nu_1") - 1)),
        "", "", "", "summed with compensation; the phase of the imposed motion is rounded to 1e-16 t"});
  if (periods > 10'000)
    draw_picture("drift", "gait of the snake-board: errors over many periods", "t [s]", "m, rad",
                 {position, heading}, true);
}

TEST(HardGaits, DriftOverAThousandPeriods) { drift(1000); }
TEST(LongHard, DriftOverAHundredThousandPeriods) { drift(100'000); }

}  // namespace
}  // namespace anholon::testing::gait_test
