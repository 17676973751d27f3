// SPDX-License-Identifier: GPL-2.0-or-later
// The integrators as scenes name them: each converges with its order to the solution of another method.

#include <cmath>
#include <vector>

#include "simulate/columns.hpp"
#include "simulate/work_precision.hpp"

namespace anholon::integrators_test {
namespace {

using testing::scene_of;
using Method = Integrator::Method;

Scene gait(Method method) {
  Scene scene = scene_of("rigid_snakeboard/gait");
  scene.integrator = {};
  scene.integrator.method = method;
  return scene;
}

TEST(Integrators, ErrorsOfFixedStepsFallWithTheirOrder) {
  struct Case {
    Method method;
    int order, coarsest;  // power of two of the step
  };
  for (const auto& [method, order, coarsest] :
       {Case{Method::rkmk4, 4, -9}, Case{Method::cf4, 4, -9}, Case{Method::rkmk8, 8, -4}}) {
    const WorkPrecision result = work_precision(gait(method), {}, {coarsest, coarsest - 1, false});
    ASSERT_EQ(result.points.size(), 2U);
    EXPECT_TRUE(result.by_step);
    const double slope = std::log2(result.points[0].error / result.points[1].error);
    EXPECT_NEAR(slope, order, 0.3) << Integrator::method_names[static_cast<std::size_t>(method)] << " "
                                   << result.points[0].error << " " << result.points[1].error;
  }
}

TEST(Integrators, Dopri8MeetsTightTolerancesWithFewerEvaluationsThanDopri5) {
  const WorkPrecision five = work_precision(gait(Method::dopri5), {}, {-12, -12, false});
  const WorkPrecision eight = work_precision(gait(Method::dopri8), {}, {-12, -12, false});
  ASSERT_EQ(eight.points.size(), 1U);
  EXPECT_LT(eight.points[0].error, 1e-10);
  EXPECT_LT(eight.points[0].evaluations, five.points[0].evaluations);
}

TEST(Integrators, OutputTimesOfDopri8LieOnTheContinuousSolution) {
  Scene fine = gait(Method::dopri8);
  fine.integrator.tolerance = 1e-12;
  const SimulationResult dense = simulate_scene(fine);
  Scene stepped = gait(Method::rkmk8);
  stepped.integrator.step = 1e-3;  // ends a step at every output time
  const SimulationResult exact = simulate_scene(stepped);
  ASSERT_TRUE(dense.finished && exact.finished);
  ASSERT_EQ(dense.rows.size(), exact.rows.size());
  const std::size_t x = testing::column_index(dense, "x"), nu = testing::column_index(dense, "nu_1");
  for (std::size_t i = 0; i < dense.rows.size(); ++i) {
    EXPECT_NEAR(dense.rows[i][x], exact.rows[i][x], 1e-10);
    EXPECT_NEAR(dense.rows[i][nu], exact.rows[i][nu], 1e-10);
  }
}

}  // namespace
}  // namespace anholon::integrators_test
