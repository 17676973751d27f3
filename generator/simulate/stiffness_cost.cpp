// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/stiffness_cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "check/compile_cache.hpp"
#include "simulate/cpu_time.hpp"
#include "simulate/equilibrium.hpp"
#include "simulate/final_state.hpp"
#include "simulate/groups.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/integrators.hpp"
#include "simulate/motion_sizes.hpp"
#include "simulate/reference_solution.hpp"
#include "simulate/runner.hpp"
#include "simulate/scene_program.hpp"
#include "simulate/simulation.hpp"
#include "simulate/svg_plot.hpp"

namespace anholon {
namespace {

constexpr int factors = 5;
constexpr double factor_step = 100;
constexpr double loosest = 1e-4, tightest = 1e-11, tolerance_step = 0.31622776601683794;  // half decades

/// The scene with its parameters at a factor, its start settled.
Scene grown(const Scene& scene, const std::vector<Growth>& growths, double factor) {
  Scene result = scene;
  for (const Growth& growth : growths) {
    const auto found = std::ranges::find(result.model.parameters, growth.parameter, &Parameter::name);
    if (found == result.model.parameters.end())
      throw std::invalid_argument(fmt::format("'{}' is not a parameter of the model", growth.parameter));
    found->value = found->value * Exact::from_double(std::pow(factor, growth.exponent));
  }
  result.integrator.method = Integrator::Method::rodas5p;
  return settled(result);
}

/// Tightens the tolerance until the error is what is wanted.
template <class G>
CostPoint cost_of(Integrator::Method method, const Field<G>& field, const integrate::State<G>& initial,
                  double duration, const MotionSizes& sizes, const std::vector<double>& y_sizes,
                  const ReferenceSolution& reference) {
  constexpr double long_enough = 0.02;  // s, for the clock
  constexpr int most_repeats = 5;
  CostPoint point;
  for (double tolerance = loosest; tolerance >= tightest; tolerance *= tolerance_step) {
    auto options = relative_tolerance(tolerance, sizes, y_sizes);
    options.max_steps = std::numeric_limits<long>::max();
    point = {tolerance, 0, std::numeric_limits<double>::infinity(), 0, 0};
    for (int repeat = 0; repeat < most_repeats; ++repeat) {
      integrate::State<G> state = initial;
      const double start = cpu_now();
      const auto outcome = integrate_adaptive<G>(
          field, state, duration, options, [](const auto&) {}, method);
      point.cpu_seconds = std::min(point.cpu_seconds, cpu_now() - start);
      point.evaluations = outcome.evaluations, point.jacobians = outcome.jacobians;
      point.error = outcome ? state_error(final_values(state), reference.state, sizes)
                            : std::numeric_limits<double>::infinity();
      if (point.cpu_seconds > long_enough || point.error > cost_accuracy) break;
    }
    if (point.error <= cost_accuracy) break;
  }
  return point;
}

}  // namespace

double StiffnessCost::growth(CostPoint StiffnessCostRow::*method) const {
  double least = std::numeric_limits<double>::infinity(), growth = 0;
  for (const StiffnessCostRow& row : rows) {
    const auto evaluations = static_cast<double>((row.*method).evaluations);
    if (!(evaluations > 0)) continue;  // left out
    least = std::min(least, evaluations);
    growth = std::max(growth, evaluations / least);
  }
  return growth;
}

StiffnessCost stiffness_cost(const Scene& scene, const std::vector<Growth>& growths,
                             const std::function<void(const StiffnessCostRow&)>& on_row,
                             double fastest_explicit) {
  require_duration(scene);
  if (scene.project_motion || scene.motion_table || scene.phases.size() > 1)
    throw ModelError(scene.where, "the cost of stiffness is that of a smooth motion",
                     "take a scene of one phase, whose motion is given by expressions");
  StiffnessCost result;
  std::vector<std::vector<long double>> ends;
  std::unique_ptr<MotionSizes> last_sizes;
  double factor = 1;
  for (int i = 0; i < factors; ++i, factor *= factor_step) {
    const Scene at = grown(scene, growths, factor);
    const SceneProgram program = make_program(at);
    const auto code = std::make_shared<CompiledProgram>(program.derivation->program);
    StiffnessCostRow row;
    row.factor = factor;
    with_group<double>(program.model.group, [&]<class G>(std::type_identity<G>) {
      Runner<double> run(at, program, code);
      if (run.charts() > 1)
        throw UnsupportedError("the cost of stiffness is measured in one chart of the kernel");
      Stiffness stiffness;
      const MotionSizes sizes =
          motion_sizes<G>(program, run, initial_state<G>(at, program, run, 2), at.duration, &stiffness);
      row.fast = stiffness.fast / at.duration;
      const ReferenceSolution reference = reference_solution(at, program, sizes, cost_accuracy * 1e-4);
      if (reference.steps == 0)
        throw UnsupportedError(
            fmt::format("the cost of stiffness has nothing to measure errors by: at the factor {:g} no "
                        "reference converges, by {}",
                        factor, reference.method));
      row.reference_error = reference.own_error;
      ends.push_back(reference.state);
      last_sizes = std::make_unique<MotionSizes>(sizes);
      const integrate::State<G> initial = initial_state<G>(at, program, run, 0);
      std::vector<double> y_sizes = sizes.of_state();
      y_sizes.resize(static_cast<std::size_t>(initial.y.size()));  // no quadratures here
      const auto field = field_with_corrections<G>(run.template charted_field<G>());
      row.stiff =
          cost_of<G>(Integrator::Method::rodas5p, field, initial, at.duration, sizes, y_sizes, reference);
      if (row.fast <= fastest_explicit)
        row.explicit_method =
            cost_of<G>(Integrator::Method::dopri5, field, initial, at.duration, sizes, y_sizes, reference);
    });
    result.operations = program.operations, result.jacobian_operations = program.jacobian_operations;
    result.rows.push_back(row);
    if (on_row) on_row(row);
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    std::vector<long double> pose(ends[i].begin(), ends[i].begin() + 12),
        limit(ends.back().begin(), ends.back().begin() + 12);
    result.rows[i].to_limit = state_error(pose, limit, *last_sizes);
  }
  return result;
}

std::string stiffness_cost_svg(const StiffnessCost& cost, const std::string& title) {
  std::vector<double> decades;
  Curve stiff{"stiff (Rodas5P)", {}}, by_explicit{"explicit (Dormand-Prince)", {}};
  for (const StiffnessCostRow& row : cost.rows) {
    decades.push_back(std::log10(row.fast));
    stiff.values.push_back(static_cast<double>(row.stiff.evaluations));
    by_explicit.values.push_back(static_cast<double>(row.explicit_method.evaluations));
  }
  return svg_plot(title, "log10 of the fastest rate [1/s]", decades,
                  {{fmt::format("evaluations for an error of {:.0e}", cost_accuracy), {stiff, by_explicit}}});
}

}  // namespace anholon
