// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "check/compile_cache.hpp"
#include "simulate/contact_forces.hpp"
#include "simulate/contact_switch.hpp"
#include "simulate/cpu_time.hpp"
#include "simulate/equilibrium.hpp"
#include "simulate/groups.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/integrators.hpp"
#include "simulate/motion_sizes.hpp"
#include "simulate/position_keeper.hpp"
#include "simulate/rank_monitor.hpp"
#include "simulate/recorder.hpp"
#include "simulate/rounding_monitor.hpp"
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

/// The method of a scene that leaves the choice, and why: what each would cost, in operations, to go as far
/// as accuracy and stability ask for. Both are of order 5, so that the steps of a coarse run tell those of a
/// fine one.
std::pair<Integrator::Method, std::string> chosen_method(const Scene& scene, const SceneProgram& program,
                                                         const Stiffness& stiffness, Eigen::Index size) {
  if (program.jacobian_operations == 0) return {Integrator::Method::dopri5, "no Jacobian of this motion"};
  constexpr double stable = 1;  // |h lambda| of Dormand-Prince on the imaginary axis; 3.3 on the real one
  constexpr int stages = 8, explicit_stages = 6;
  const auto n = static_cast<double>(size);
  const double accurate = stiffness.steps * std::pow(coarse_tolerance / scene.integrator.tolerance, 0.2);
  const double stable_steps = stiffness.fast / stable;
  const double by_stiff = accurate * (stages * (program.operations + 2 * n * n + 2 * stages * n) +
                                      program.jacobian_operations + 2 * n * n * n / 3);
  const double by_explicit =
      std::max(accurate, stable_steps) * explicit_stages * (program.operations + 2 * explicit_stages * n);
  return {by_stiff < by_explicit ? Integrator::Method::rodas5p : Integrator::Method::dopri5,
          fmt::format("stability asks an explicit method for {:.2g} steps, accuracy for {:.2g}", stable_steps,
                      accurate)};
}

/// To t_end: dense output at the wanted times, or rows at the method's own steps.
template <class G>
integrate::Result<double> integrate_with_step_control(const Scene& scene, double t_end,
                                                      Integrator::Method method, const Field<G>& field,
                                                      const MotionSizes& sizes, integrate::State<G>& state,
                                                      PositionKeeper<G>& keeper, Recorder& recorder,
                                                      const Progress& progress) {
  const std::vector<double> y_sizes = sizes.of_state();
  const auto options = relative_tolerance(scene.integrator.tolerance, sizes, y_sizes);
  const std::vector<double>& times = scene.output_times;
  auto next = std::ranges::upper_bound(times, state.t);
  Eigen::VectorXd y(state.y.size());
  G g;
  const auto observe = [&](const AnyStep<G>& step) {
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
  };
  return integrate_adaptive<G>(field, state, t_end, options, observe, method);
}

/// By a method with equal steps from each output time to the next, none longer than the scene's step.
template <class G>
integrate::Result<double> integrate_with_fixed_step(const Scene& scene, double t_end, const Field<G>& field,
                                                    integrate::State<G>& state, PositionKeeper<G>& keeper,
                                                    Recorder& recorder, const Progress& progress) {
  integrate::Result<double> total;
  std::vector<double> times = scene.output_times;
  std::erase_if(times, [t_end](double t) { return t > t_end; });
  if (times.empty() || times.back() < t_end) times.push_back(t_end);
  for (auto t = std::ranges::upper_bound(times, state.t); t != times.end(); ++t) {
    const long steps = std::max(1L, std::lround(std::ceil((*t - state.t) / scene.integrator.step - 1e-9)));
    const auto observe = [&](double now, const G& end, const auto& y_end) {
      G g = end;
      Eigen::VectorXd y = y_end;
      keeper(now, g, y);
      if (scene.output_times.empty() || now == *t) {
        recorder.record(now, g, y, keeper.residual(now, g, y));
      } else {
        recorder.watch(now, g, y, keeper.residual(now, g, y));
      }
      progress("integrating", now);
    };
    const auto part = integrate_fixed<G>(field, state, *t, steps, observe, scene.integrator.method);
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

/// The functions of one set of contacts.
struct SetOfContacts {
  Scene scene;  // with this set in force
  std::unique_ptr<SceneProgram> program;
  std::shared_ptr<CompiledProgram> code;
};

std::map<std::string, SetOfContacts> sets_of_contacts(const Scene& scene,
                                                      const std::vector<ContactPhase>& phases,
                                                      const Progress& progress) {
  std::map<std::string, SetOfContacts> sets;
  for (const ContactPhase& phase : phases) {
    if (sets.contains(phase.set)) continue;
    SetOfContacts& set = sets[phase.set];
    set.scene = scene;
    set.scene.contact_set = phase.set;
    progress("deriving", 0);
    set.program = std::make_unique<SceneProgram>(make_program(set.scene));
    progress("compiling", 0);
    set.code = std::make_shared<CompiledProgram>(set.program->derivation->program);
  }
  return sets;
}

/// Adds what was seen of a phase: columns by name, rows, extremes.
void add_phase(SimulationResult& whole, const SimulationResult& phase) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::size_t> place;
  for (const std::string& name : phase.columns) {
    const auto at = std::ranges::find(whole.columns, name);
    place.push_back(static_cast<std::size_t>(at - whole.columns.begin()));
    if (at != whole.columns.end()) continue;
    whole.columns.push_back(name);
    for (auto& row : whole.rows) row.push_back(none);
  }
  for (const auto& row : phase.rows) {
    whole.rows.emplace_back(whole.columns.size(), none);
    for (std::size_t i = 0; i < row.size(); ++i) whole.rows.back()[place[i]] = row[i];
  }
  const auto raise = [](double& to, double by) { to = std::max(to, by); };
  raise(whole.energy_balance, phase.energy_balance), raise(whole.largest_energy, phase.largest_energy);
  raise(whole.constraint_residual, phase.constraint_residual);
  raise(whole.position_residual, phase.position_residual), raise(whole.orthonormality, phase.orthonormality);
  raise(whole.departure, phase.departure);
  if (whole.violation.empty()) whole.violation = phase.violation;
  for (const ContactHistory& seen : phase.contacts) {
    const auto known = std::ranges::find(whole.contacts, seen.contact, &ContactHistory::contact);
    if (known == whole.contacts.end()) {
      whole.contacts.push_back(seen);
      continue;
    }
    if (seen.least_normal < known->least_normal)
      known->least_normal = seen.least_normal, known->least_normal_at = seen.least_normal_at;
    if (seen.largest_utilisation > known->largest_utilisation)
      known->largest_utilisation = seen.largest_utilisation, known->utilisation_at = seen.utilisation_at;
    if (!known->lifts_at) known->lifts_at = seen.lifts_at;
    if (!known->slips_at) known->slips_at = seen.slips_at;
  }
}

/// Integrates one phase after the other; at a switch of contacts the velocities jump to admissible ones.
template <class G>
class PhaseRunner {
 public:
  PhaseRunner(SimulationResult& result, const Progress& progress, const RowObserver& observer)
      : result_(result), progress_(progress), observer_(observer) {}

  [[nodiscard]] bool goes_on() const { return last_ == nullptr || result_.finished; }

  void run(const SetOfContacts& set, const ContactPhase& phase, double t_end) {
    const Scene& scene = set.scene;
    const SceneProgram& program = *set.program;
    Runner<double> run(scene, program, set.code);
    PositionKeeper<G> keeper(program, run);
    if (last_ == nullptr) {
      state_ = initial_state<G>(scene, program, run, 2);
      keeper.start(0.0, state_.g, state_.y);
    } else {
      switch_contacts(set, phase, run, keeper);
    }
    last_ = &set;
    Field<G> field{run.template field_of<G>(),
                   {},
                   field_with_corrections<G>(run.template charted_field<G>()).derivative};
    result_.charts = std::max(result_.charts, run.charts());
    result_.projected = program.projects_motion;
    if (!keeper.empty() || run.charts() > 1) {
      field.correction = [this, &keeper, charted = run.template charted_field<G>()](double t, G& g,
                                                                                    Eigen::VectorXd& y) {
        const bool moved = keeper(t, g, y);
        const bool changed = charted.correct(t, g, y);
        if (changed) result_.chart_changes.push_back(t);
        return moved || changed;
      };
    }
    watch_rounding(program, run);
    SimulationResult seen;
    const SharingRule sharing = sharing_rule(scene.sharing);
    Recorder recorder(program, run, energy_, sharing, seen, observer_);
    recorder.record(state_.t, state_.g, state_.y, keeper.residual(state_.t, state_.g, state_.y));
    if (!seen.violation.empty()) {
      seen.rows.clear();
      add_phase(result_, seen);
      result_.status = result_.violation, result_.finished = false;
      return;
    }
    const double start = cpu_now();
    integrate::Result<double> outcome;
    if (scene.integrator.has_fixed_step()) {
      result_.method = scene.integrator.method;
      outcome = integrate_with_fixed_step(scene, t_end, field, state_, keeper, recorder, progress_);
    } else {
      Stiffness stiffness;
      const MotionSizes sizes = motion_sizes<G>(program, run, state_, t_end, &stiffness);
      Integrator::Method method = scene.integrator.method;
      if (scene.integrator.method == Integrator::Method::automatic)
        std::tie(method, result_.why) = chosen_method(scene, program, stiffness, G::dim + state_.y.size());
      result_.method = method;
      result_.jacobian_operations = program.jacobian_operations;
      outcome = integrate_with_step_control(scene, t_end, method, field, sizes, state_, keeper, recorder,
                                            progress_);
    }
    result_.jacobians += outcome.jacobians;
    result_.cpu_seconds += cpu_now() - start;
    add_phase(result_, seen);
    result_.steps += outcome.accepted_steps, result_.rejected += outcome.rejected_steps,
        result_.evaluations += outcome.evaluations;
    result_.status = integrate::name(outcome.status);
    if (!outcome) {
      const auto obstacle = obstacle_ahead(program, run, state_, outcome.next_step);
      result_.status = obstacle.value_or(fmt::format("{} at t = {:.6g} s", result_.status, state_.t));
    }
    if (!result_.violation.empty()) result_.status = result_.violation;
    result_.finished = outcome && result_.violation.empty();
    watch_rounding(program, run);
    result_.nanoseconds_per_evaluation = nanoseconds_per_call(run.rates);
    if (run.kinematics) run.kinematics();
    before_ = state_of(program, run);
  }

 private:
  void watch_rounding(const SceneProgram& program, Runner<double>& run) {
    run.impose(state_.t), run.set(state_.g, state_.y);
    const RoundingLoss here = rounding_loss(program, run);
    const auto rank = [](const RoundingLoss& l) { return std::pair(l.is_loss(), l.error); };
    if (rank(here) > rank(result_.rounding)) result_.rounding = here;
  }

  /// The state at which a phase ends becomes the one at which the next begins.
  void switch_contacts(const SetOfContacts& set, const ContactPhase& phase, Runner<double>& run,
                       PositionKeeper<G>& keeper) {
    const SceneProgram& program = *set.program;
    const Eigen::VectorXd y = state_.y;
    const Eigen::Index shape = run.size() - static_cast<Eigen::Index>(run.b.nu.size());
    state_.y.setZero(run.size() + 2);
    state_.y.head(shape) = y.head(shape);
    state_.y.tail(2) = y.tail(2);
    keeper.start(state_.t, state_.g, state_.y);
    const double gap = keeper.residual(state_.t, state_.g, state_.y);
    if (gap > phase.gap)
      throw ModelError(phase.where,
                       fmt::format("at t = {:.6g} s a contact of '{}' closes {:.2g} m from where it holds",
                                   state_.t, phase.set, gap),
                       "choose the time at which it touches, or allow more: gap = 1e-6");
    keeper(state_.t, state_.g, state_.y);
    run.impose(state_.t);
    run.set(state_.g, state_.y);
    run.use_chart(run.best_chart_here());
    const VelocityJump jump = velocity_jump(program.model, program.reduced, before_);
    ContactSwitch seen{state_.t, last_->scene.contact_set, phase.set, jump.lost, jump.work, jump.relative,
                       {}};
    for (std::size_t i = 0; i < program.model.rows.size(); ++i)
      seen.impulses.emplace_back(program.model.rows[i].name, jump.impulses(static_cast<Eigen::Index>(i)));
    result_.switches.push_back(seen);
    if (set.scene.continuous && jump.relative > *set.scene.continuous)
      throw ModelError(
          phase.where,
          fmt::format("at t = {:.6g} s the velocities jump by {:.2g} of their size, in the kinetic "
                      "metric; the scene allows {:.2g}",
                      state_.t, jump.relative, *set.scene.continuous),
          "make the motion arrive at rest in the new contacts, or remove 'continuous'");
    take_velocities(program, run, jump.velocities);
    for (std::size_t i = 0; i < run.b.nu.size(); ++i)
      state_.y(shape + static_cast<Eigen::Index>(i)) = run.b.nu[i];
    state_.y(state_.y.size() - 2) += jump.work;
    state_.y(state_.y.size() - 1) += jump.lost;
  }

  SimulationResult& result_;
  const Progress& progress_;
  const RowObserver& observer_;
  EnergyMonitor energy_;
  integrate::State<G> state_;
  State<double> before_;  // all velocities at the end of the last phase
  const SetOfContacts* last_ = nullptr;
};

}  // namespace

void require_duration(const Scene& scene) {
  if (!(scene.duration > 0))
    throw UnfitSceneError(scene.where, "the scene has no duration",
                          "write how long it lasts, in s: duration = 5");
}

void require_one_phase(const Scene& scene, const std::string& why) {
  if (scene.phases.size() > 1) throw UnfitSceneError(scene.phases[1].where, why, "take a scene of one phase");
}

SimulationResult simulate_scene(const Scene& wanted, const Progress& wanted_progress,
                                const RowObserver& observer) {
  require_duration(wanted);
  const Progress progress = wanted_progress ? wanted_progress : [](const char*, double) {};
  const std::vector<ContactPhase> phases =
      wanted.phases.empty() ? std::vector<ContactPhase>{{0, wanted.contact_set, 0, {}}} : wanted.phases;
  Scene scene = wanted;
  scene.contact_set = phases.front().set;
  scene = settled(scene);
  const std::map<std::string, SetOfContacts> sets = sets_of_contacts(scene, phases, progress);
  SimulationResult result;
  const SceneProgram& first = *sets.at(phases.front().set).program;
  result.operations = first.operations;
  result.class_of_table_I = first.derivation->reduction.ranks.table_I_class(first.reduced);
  with_group<double>(first.model.group, [&]<class G>(std::type_identity<G>) {
    PhaseRunner<G> runner(result, progress, observer);
    for (std::size_t i = 0; i < phases.size() && runner.goes_on(); ++i) {
      const double end = i + 1 < phases.size() ? phases[i + 1].start : scene.duration;
      runner.run(sets.at(phases[i].set), phases[i], end);
    }
  });
  return result;
}

}  // namespace anholon
