// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/work_precision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "check/compile_cache.hpp"
#include "simulate/cpu_time.hpp"
#include "simulate/equilibrium.hpp"
#include "simulate/final_state.hpp"
#include "simulate/groups.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/integrators.hpp"
#include "simulate/motion_sizes.hpp"
#include "simulate/recursion_dynamics.hpp"
#include "simulate/reference_solution.hpp"
#include "simulate/runner.hpp"
#include "simulate/scene_program.hpp"
#include "simulate/simulation.hpp"

namespace anholon {
namespace {

constexpr long most_steps = 100'000'000;
constexpr double enough_seconds = 10;  // of one integration: what would take longer is left out, and said
// Growth of the cost from rung to rung: by a decade of the tolerance with order 5, 10^(1/5); by half a step.
constexpr double growth_by_decade = 1.6, growth_by_half = 2;

/// One integration, repeated while it is too short for the clock; the least time counts.
template <class G>
WorkPrecisionPoint measured(const std::string& code, double tolerance, const integrate::State<G>& initial,
                            const Field<G>& field, const integrate::AdaptiveOptions<double>& options,
                            double duration, const Integrator& integrator, integrate::State<G>& state) {
  constexpr double long_enough = 0.02;  // s, of all repeats
  constexpr int most_repeats = 50;
  WorkPrecisionPoint point{code, tolerance, 0, std::numeric_limits<double>::infinity(), 0, ""};
  double spent = 0;
  for (int repeat = 0; repeat < most_repeats && spent < long_enough; ++repeat) {
    state = initial;
    const double start = cpu_now();
    const auto outcome = integrator.has_fixed_step()
                             ? integrate_fixed<G>(
                                   field, state, duration, std::lround(duration / tolerance),
                                   [](auto&&...) {}, integrator.method)
                             : integrate_adaptive<G>(
                                   field, state, duration, options, [](const auto&) {}, integrator.method);
    const double took = cpu_now() - start;
    spent += took;
    point.cpu_seconds = std::min(point.cpu_seconds, took);
    point.evaluations = outcome.evaluations;
    point.status = integrate::name(outcome.status);
  }
  return point;
}

}  // namespace

WorkPrecision work_precision(const Scene& wanted,
                             const std::function<void(const WorkPrecisionPoint&)>& on_point,
                             const Ladder& ladder) {
  require_duration(wanted);
  const Scene scene = settled(wanted);
  if (scene.project_motion)
    throw UnsupportedError("work-precision needs a motion that is given, not one that is projected");
  require_one_phase(scene, "work and precision are those of a smooth motion");
  const SceneProgram program = make_program(scene);
  const auto code = std::make_shared<CompiledProgram>(program.derivation->program);
  WorkPrecision result;
  result.by_step = scene.integrator.has_fixed_step();
  with_group<double>(program.model.group, [&]<class G>(std::type_identity<G>) {
    Runner<double> run(scene, program, code);
    const MotionSizes sizes =
        motion_sizes<G>(program, run, initial_state<G>(scene, program, run, 2), scene.duration);
    const ReferenceSolution reference = reference_solution(scene, program, sizes);
    result.reference_steps = reference.steps, result.reference_error = reference.own_error;
    result.reference_method = reference.method;
    const integrate::State<G> initial = initial_state<G>(scene, program, run, 0);
    const std::size_t chart = run.chart();
    RecursionDynamics recursion(program, run);
    const integrate::State<G> expanded = recursion.expanded(initial);
    const auto started_in_chart = [&](Runner<double>& runner) {
      const auto charted = field_with_corrections<G>(runner.template charted_field<G>());
      return Field<G>{[&runner, charted, chart](double t, const G& g, const auto& y, auto& eta, auto& y_dot) {
                        if (t == 0) runner.use_chart(chart);  // each integration starts there
                        charted.rates(t, g, y, eta, y_dot);
                      },
                      charted.correction, charted.derivative};
    };
    const Field<G> generated = started_in_chart(run);
    std::optional<Runner<double>> single;
    Field<G> generated_single;
    if (ladder.single) {
      CompileOptions options;
      options.scalar = AbiScalar::is_float;
      single.emplace(scene, program, std::make_shared<CompiledProgram>(program.derivation->program, options));
      generated_single = started_in_chart(*single);
      generated_single.correction = generated.correction;  // float cannot see what is left to correct
    }
    Integrator by_recursion = scene.integrator;  // which has no Jacobian
    if (by_recursion.method == Integrator::Method::rodas5p) by_recursion.method = Integrator::Method::dopri5;
    std::vector<double> reduced_sizes = sizes.of_state();
    reduced_sizes.resize(static_cast<std::size_t>(initial.y.size()));  // no quadratures here
    const std::vector<double> expanded_sizes = sizes.of_velocity_state();

    const auto add_values = [&](WorkPrecisionPoint point, const std::vector<double>& values) {
      point.error = reference.steps > 0 && point.status == "ok" ? state_error(values, reference.state, sizes)
                                                                : std::numeric_limits<double>::quiet_NaN();
      result.points.push_back(point);
      if (on_point) on_point(point);
    };
    const auto add = [&](const WorkPrecisionPoint& point, const integrate::State<G>& reduced) {
      add_values(point, final_values(reduced));
    };
    double expected_seconds = 0;
    for (int exponent = ladder.loosest; exponent >= ladder.tightest; --exponent) {
      const double tolerance =
          result.by_step ? std::ldexp(scene.duration, exponent) : std::pow(10.0, exponent);
      integrate::State<G> state;
      auto options = relative_tolerance(tolerance, sizes, reduced_sizes);
      options.max_steps = most_steps;
      const WorkPrecisionPoint by_code = measured<G>("generated", tolerance, initial, generated, options,
                                                     scene.duration, scene.integrator, state);
      run.express_in_best_chart(state);
      add(by_code, state);
      if (single && exponent >= ladder.single_tightest) {
        options.max_steps = 1'000'000;  // its noise may look like errors that no step is short enough for
        const WorkPrecisionPoint point = measured<G>("generated, float", tolerance, initial, generated_single,
                                                     options, scene.duration, scene.integrator, state);
        options.max_steps = most_steps;
        single->express_in_best_chart(state);
        add(point, state);
      }
      for (const Peer& peer : ladder.peers) {
        const Peer::Run run_of_peer = peer.run(tolerance);
        add_values(
            {peer.name, tolerance, 0, run_of_peer.cpu_seconds, run_of_peer.evaluations, run_of_peer.status},
            run_of_peer.state);
      }
      if (!ladder.recursion) continue;
      if (expected_seconds > enough_seconds) {
        add({"recursion", tolerance, 0, 0, 0, "left out: too long"}, initial);
        continue;
      }
      options.sizes = expanded_sizes;
      Field<G> field;
      field.rates = [&](double t, const G& g, const auto& y, auto& eta, auto& y_dot) {
        recursion(t, g, y, eta, y_dot);
      };
      const WorkPrecisionPoint point =
          measured<G>("recursion", tolerance, expanded, field, options, scene.duration, by_recursion, state);
      expected_seconds = (result.by_step ? growth_by_half : growth_by_decade) * point.cpu_seconds;
      run.use_chart(chart);
      integrate::State<G> reduced = recursion.reduced(state);
      run.express_in_best_chart(reduced);
      add(point, reduced);
    }
  });
  return result;
}

RoundingFloor rounding_floor(const WorkPrecision& result, const std::string& code) {
  RoundingFloor floor{std::numeric_limits<double>::infinity(), 0, false};
  for (const WorkPrecisionPoint& p : result.points) {
    if (p.code == code && p.error < floor.error) floor.error = p.error;
  }
  int rungs_below = 0;
  for (const WorkPrecisionPoint& p : result.points) {
    if (p.code != code || std::isnan(p.error)) continue;
    if (floor.tolerance > 0) ++rungs_below;
    if (floor.tolerance == 0 && p.error <= 2 * floor.error) floor.tolerance = p.tolerance;
  }
  floor.seen = rungs_below >= 2;
  return floor;
}

}  // namespace anholon
