// SPDX-License-Identifier: GPL-2.0-or-later
// Stiff motions: the Jacobian of the field, the choice of the method, what fast modes cost, and where the
// motion tends as they become faster.

#include <algorithm>
#include <cmath>

#include "simulate/columns.hpp"
#include "simulate/equilibrium.hpp"
#include "simulate/groups.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/reference_solution.hpp"
#include "simulate/runner.hpp"
#include "simulate/stiffness_cost.hpp"
#include "simulate/work_precision.hpp"

namespace anholon::stiff_test {
namespace {

using testing::column;
using testing::scene_of;

class FieldJacobian : public ::testing::TestWithParam<std::string> {};

TEST_P(FieldJacobian, IsTheDerivativeOfTheField) {
  using S = long double;
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
  Scene scene = scene_of(GetParam());
  scene.integrator.method = Integrator::Method::rodas5p;
  const SceneProgram program = make_program(scene);
  with_group<S>(program.model.group, [&]<class G>(std::type_identity<G>) {
    using Tangent = typename G::Tangent;
    Runner<S> run(scene, program, &program.derivation->program);
    const integrate::State<G> start = initial_state<G>(scene, program, run, 2);
    const auto n = start.y.size(), size = n + G::dim;
    // somewhere beside the start, so that no velocity is zero
    const S t = 0.3L, h = 1e-5L;
    const G g = start.g * G::exp(Tangent::Constant(0.1L));
    const Vector y = start.y + Vector::LinSpaced(n, 0.05L, 0.1L);
    const auto field = [&](S at, const G& pose, const Vector& values) {
      Tangent eta;
      Vector y_dot(n), all(size);
      run.field(at, pose, values, eta, y_dot);
      all << eta, y_dot;
      return all;
    };
    Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> F(size, size);
    Vector F_t(size);
    run.jacobian(t, g, y, F, F_t);
    const auto expect = [&](const Vector& after, const Vector& before, const Vector& slope,
                            const std::string& name) {
      const Vector difference = (after - before) / (2 * h);
      // h^2 of third derivatives beside first ones, and rounding
      EXPECT_LT((difference - slope).norm(), 1e-6L * (1 + slope.norm())) << name;
    };
    expect(field(t + h, g, y), field(t - h, g, y), F_t, "t");
    const auto twists = static_cast<Eigen::Index>(run.b.eta.size());  // of a line or plane fewer than dim
    for (Eigen::Index j = 0; j < size; ++j) {
      const std::string name = "column " + std::to_string(j);
      if (j >= twists && j < G::dim) continue;
      if (j < G::dim) {
        const Tangent twist = h * Tangent::Unit(j);
        expect(field(t, g * G::exp(twist), y), field(t, g * G::exp(-twist), y), F.col(j), name);
      } else {
        const Vector step = h * Vector::Unit(n, j - G::dim);
        expect(field(t, g, y + step), field(t, g, y - step), F.col(j), name);
      }
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Scenes, FieldJacobian,
                         ::testing::Values("soft_snakeboard/gait", "mobile_pendulum/swing",
                                           "whipple_bicycle/perturbed", "two_wheeled_pendulum/balance"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::ranges::replace(name, '/', '_');
                           return name;
                         });

TEST(StiffMotion, TheMethodIsChosenByWhatEachWouldCost) {
  const SimulationResult fast = simulate_scene(scene_of("soft_snakeboard/fast_beams"));
  ASSERT_TRUE(fast.finished) << fast.status;
  EXPECT_EQ(fast.method, Integrator::Method::rodas5p) << fast.why;
  EXPECT_GT(fast.jacobians, 0);
  EXPECT_LT(fast.constraint_residual, 1e-14);  // a few roundings
  Scene slow = scene_of("soft_snakeboard/gait");
  slow.integrator.method = Integrator::Method::automatic;
  const SimulationResult gait = simulate_scene(slow);
  EXPECT_EQ(gait.method, Integrator::Method::dopri5) << gait.why;
}

TEST(StiffMotion, BalancesItsEnergyAsItsToleranceSays) {
  Scene scene = scene_of("soft_snakeboard/fast_beams");
  scene.integrator.method = Integrator::Method::rodas5p;
  const SimulationResult result = simulate_scene(scene);
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_LT(result.energy_balance, 100 * scene.integrator.tolerance);  // some hundred steps
}

TEST(StiffMotion, CostsNoMoreWhereModesAreFaster) {
  const StiffnessCost cost =
      stiffness_cost(scene_of("soft_snakeboard/fast_beams"), {{"EI", 1}, {"c_e", 0.5}}, {}, 1e5);
  ASSERT_EQ(cost.rows.size(), 5U);
  EXPECT_LT(cost.growth(&StiffnessCostRow::stiff), 2);
  for (const StiffnessCostRow& row : cost.rows) {
    EXPECT_LE(row.stiff.error, cost_accuracy) << row.factor;
    EXPECT_LT(row.reference_error, cost_accuracy / 100) << row.factor;
  }
  // the explicit method follows the modes: ten times the frequency, ten times the steps
  EXPECT_GT(cost.rows[1].explicit_method.evaluations, 5 * cost.rows[0].explicit_method.evaluations);
}

// What is compared with no reference has no error that any tolerance could allow.
TEST(ReferenceSolution, ThatWasNotFoundIsInfinitelyFarFromEveryState) {
  const Scene scene = scene_of("mobile_pendulum/swing");
  const SceneProgram program = make_program(scene);
  const Runner<double> run(scene, program, &program.derivation->program);
  EXPECT_EQ(state_error(std::vector<double>(20, 0.0), {}, MotionSizes(program, run)), INFINITY);
}

/// The final pose with beams of this stiffness; `modes` false: without.
std::vector<double> final_pose(double factor, bool modes) {
  Scene scene = scene_of("soft_snakeboard/fast_beams");
  scene.integrator.method = modes ? Integrator::Method::rodas5p : Integrator::Method::dopri5;
  scene.integrator.tolerance = 1e-12;
  for (Parameter& p : scene.model.parameters) {
    if (p.name == "EI") p.value = p.value * Exact::from_double(factor);
    if (p.name == "c_e") p.value = p.value * Exact::from_double(std::sqrt(factor));
  }
  if (!modes) {
    for (std::size_t body = 0; body < scene.model.bodies.size(); ++body) {
      if (!scene.model.bodies[body].modes.empty()) scene.modes.emplace_back(static_cast<int>(body), 0);
    }
    scene.initial.equilibrium.clear();
  }
  const SimulationResult result = simulate_scene(scene);
  EXPECT_TRUE(result.finished) << result.status;
  return {column(result, "x"), column(result, "y"), column(result, "theta")};
}

TEST(StiffMotion, TendsToThatOfRigidBeams) {
  // Another model: no modes at all. What is left of the modes falls with the square of their frequency.
  const std::vector<double> rigid = final_pose(1, false);
  const auto distance = [&](double factor) {
    const std::vector<double> pose = final_pose(factor, true);
    double largest = 0;
    for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, std::abs(pose[i] - rigid[i]));
    return largest;
  };
  const double near = distance(1e2), nearer = distance(1e4);
  EXPECT_NEAR(std::log10(near / nearer), 2, 0.1);
  EXPECT_LT(distance(1e8), 1e-10);  // a hundred times the tolerance
}

}  // namespace
}  // namespace anholon::stiff_test
