// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include "check/compile_cache.hpp"
#include "simulate/cpu_time.hpp"
#include "simulate/groups.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/integrators.hpp"
#include "simulate/motion_sizes.hpp"
#include "simulate/position_keeper.hpp"
#include "simulate/rank_monitor.hpp"
#include "simulate/recorder.hpp"
#include "simulate/runner.hpp"
#include "simulate/scene_program.hpp"

namespace anholon {
namespace {

/// Why an integration failed, if an instant lies here or within the next step that no motion passes.
template <class G>
std::optional<std::string> obstacle_ahead(const SceneProgram& program, Runner<double>& run,
                                          const integrate::State<G>& state, double step) {
  constexpr double close = 1e-5;  // steps shrink towards such an instant until time has no more digits
  RankMonitor monitor(program, run);
  run.impose(state.t), run.set(state.g, state.y);
  if (run.rates) run.rates();
  if (auto here = monitor.obstacle(state.t, close)) return here;
  monitor.passed(state.t, state.g, state.y);
  run.impose(state.t + step), run.set(state.g, state.y);
  return monitor.passed(state.t + step, state.g, state.y);
}

/// Dormand-Prince over the whole duration: dense output at the wanted times, or rows at its own steps.
template <class G>
integrate::Result<double> integrate_with_step_control(const Scene& scene, const Field<G>& field,
                                                      const MotionSizes& sizes, integrate::State<G>& state,
                                                      PositionKeeper<G>& keeper, Recorder& recorder,
                                                      const Progress& progress) {
  const std::vector<double> y_sizes = sizes.of_state();
  const auto options = relative_tolerance(scene.integrator.tolerance, sizes, y_sizes);
  const std::vector<double>& times = scene.output_times;
  auto next = std::ranges::upper_bound(times, 0.0);
  Eigen::VectorXd y(state.y.size());
  G g;
  return integrate_adaptive<G>(field, state, scene.duration, options,
                               [&](const integrate::DenseStep<G>& step) {
                                 for (; next != times.end() && *next <= step.t_end(); ++next) {
                                   step.evaluate(*next, g, y);
                                   keeper(*next, g, y);
                                   recorder.record(*next, g, y, keeper.residual(*next, g, y));
                                 }
                                 const double t = step.t_end();
                                 g = step.g_end(), y = step.y_end();
                                 keeper(t, g, y);
                                 if (times.empty()) {
                                   recorder.record(t, g, y, keeper.residual(t, g, y));
                                 } else {
                                   recorder.watch(t, g, y, keeper.residual(t, g, y));
                                 }
                                 progress("integrating", step.t_end());
                               });
}

/// The classical method from each output time to the next, with equal steps no longer than the scene's.
template <class G>
integrate::Result<double> integrate_with_fixed_step(const Scene& scene, const Field<G>& field,
                                                    integrate::State<G>& state, PositionKeeper<G>& keeper,
                                                    Recorder& recorder, const Progress& progress) {
  integrate::Result<double> total;
  std::vector<double> times = scene.output_times;
  if (times.empty() || times.back() < scene.duration) times.push_back(scene.duration);
  for (auto t = std::ranges::upper_bound(times, 0.0); t != times.end(); ++t) {
    const long steps = std::max(1L, std::lround(std::ceil((*t - state.t) / scene.integrator.step - 1e-9)));
    const auto part =
        integrate_fixed<G>(field, state, *t, steps, [&](double now, const G& end, const auto& y_end) {
          G g = end;
          Eigen::VectorXd y = y_end;
          keeper(now, g, y);
          if (scene.output_times.empty() || now == *t) {
            recorder.record(now, g, y, keeper.residual(now, g, y));
          } else {
            recorder.watch(now, g, y, keeper.residual(now, g, y));
          }
          progress("integrating", now);
        });
    total.accepted_steps += part.accepted_steps, total.evaluations += part.evaluations;
    total.status = part.status, total.next_step = part.next_step;
    if (!part) break;
  }
  return total;
}

double nanoseconds_per_call(const Call& call) {
  const long repeats = 20000;
  const double start = cpu_now();
  for (long i = 0; i < repeats && call; ++i) call();
  return (cpu_now() - start) / static_cast<double>(repeats) * 1e9;
}

}  // namespace

void require_duration(const Scene& scene) {
  if (!(scene.duration > 0))
    throw ModelError(scene.where, "the scene has no duration", "write how long it lasts, in s: duration = 5");
}

SimulationResult simulate_scene(const Scene& scene, const Progress& wanted_progress,
                                const RowObserver& observer) {
  require_duration(scene);
  const Progress progress = wanted_progress ? wanted_progress : [](const char*, double) {};
  progress("deriving", 0);
  const SceneProgram program = make_program(scene);
  progress("compiling", 0);
  const auto code = std::make_shared<CompiledProgram>(program.derivation->program);
  SimulationResult result;
  result.was_cached = code->was_cached();
  result.operations = program.operations;
  result.class_of_table_I = program.derivation->reduction.ranks.table_I_class(program.reduced);
  with_group<double>(program.model.group, [&]<class G>(std::type_identity<G>) {
    Runner<double> run(scene, program, code);
    integrate::State<G> state = initial_state<G>(scene, program, run, 2);
    PositionKeeper<G> keeper(program, run);
    keeper.start(0.0, state.g, state.y);
    Field<G> field{run.template field_of<G>(), {}};
    result.charts = run.charts();
    result.projected = program.projects_motion;
    if (!keeper.empty() || run.charts() > 1) {
      field.correction = [&keeper, &result, charted = run.template charted_field<G>()](double t, G& g,
                                                                                       Eigen::VectorXd& y) {
        const bool moved = keeper(t, g, y);
        const bool changed = charted.correct(t, g, y);
        if (changed) result.chart_changes.push_back(t);
        return moved || changed;
      };
    }
    Recorder recorder(program, run, result, observer);
    recorder.record(0.0, state.g, state.y, keeper.residual(0.0, state.g, state.y));
    if (!result.violation.empty()) {
      result.status = result.violation;
      result.rows.clear();
      return;
    }
    const double start = cpu_now();
    integrate::Result<double> outcome;
    if (scene.integrator.method == Integrator::Method::dopri5) {
      const MotionSizes sizes = motion_sizes<G>(program, run, state, scene.duration);
      outcome = integrate_with_step_control(scene, field, sizes, state, keeper, recorder, progress);
    } else {
      outcome = integrate_with_fixed_step(scene, field, state, keeper, recorder, progress);
    }
    result.cpu_seconds = cpu_now() - start;
    result.steps = outcome.accepted_steps, result.rejected = outcome.rejected_steps,
    result.evaluations = outcome.evaluations;
    result.status = integrate::name(outcome.status);
    if (!outcome) {
      const auto obstacle = obstacle_ahead(program, run, state, outcome.next_step);
      result.status = obstacle.value_or(fmt::format("{} at t = {:.6g} s", result.status, state.t));
    }
    if (!result.violation.empty()) result.status = result.violation;
    result.finished = outcome && result.violation.empty();
    run.impose(state.t), run.set(state.g, state.y);
    result.nanoseconds_per_evaluation = nanoseconds_per_call(run.rates);
  });
  return result;
}

}  // namespace anholon
