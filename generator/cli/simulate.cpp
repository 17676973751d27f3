// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "cli/common.hpp"
#include "report/motion_json.hpp"
#include "simulate/path_conditioning.hpp"
#include "simulate/simulation.hpp"
#include "simulate/stiffness_cost.hpp"
#include "simulate/stiffness_ladder.hpp"
#include "simulate/work_precision.hpp"

namespace anholon::cli {
namespace {

/// One line on the terminal that says how far a simulation is, once it takes longer than a second.
class ProgressLine {
 public:
  explicit ProgressLine(double duration) : duration_(duration) {}
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() {
    if (shown_ > 1) fmt::print(stderr, "\r{:60s}\r", "");
  }
  void operator()(const char* stage, double t) {
    if (!terminal_ || watch_.seconds() < shown_) return;
    fmt::print(stderr, "\r{:60s}\r{}", "",
               t > 0 ? fmt::format("{}: {:.4g} of {:g} s", stage, t, duration_) : stage);
    std::fflush(stderr);
    shown_ = watch_.seconds() + 0.5;
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  double duration_, shown_ = 1;
  Stopwatch watch_;
};

int print_work_precision(const Scene& scene, const std::filesystem::path& folder) {
  const bool by_step = scene.integrator.has_fixed_step();
  fmt::print("{}, {}, {}: error of the final state, relative to the sizes of the motion\n\n",
             scene.model.name, scene.name, scene.integrator.name());
  fmt::print("{:>9s}  {:>10s} {:>11s} {:>11s}  {:>10s} {:>11s}  {:>10s} {:>11s} {:>11s}\n",
             by_step ? "step [s]" : "tolerance", "generated", "cpu [s]", "evaluations", "in float", "cpu [s]",
             "recursion", "cpu [s]", "evaluations");
  std::fflush(stdout);
  std::string table =
      fmt::format("code,{},error,cpu_s,evaluations,status\n", by_step ? "step_s" : "tolerance");
  bool had_single = false;
  const auto show = [&](const WorkPrecisionPoint& p) {
    table += fmt::format("{},{},{},{},{},{}\n", p.code, p.tolerance, p.error, p.cpu_seconds, p.evaluations,
                         p.status);
    if (p.code == "generated") fmt::print("{:>9.{}e}", p.tolerance, by_step ? 2 : 0);
    const bool is_single = p.code == "generated, float";
    if (p.code == "recursion" && !had_single) fmt::print("  {:22s}", "");  // the ladder of float is shorter
    had_single = is_single;
    if (p.status != "ok") {
      fmt::print("  {:>{}s}", p.status, is_single ? 22 : 34);
    } else {
      fmt::print("  {:>10.2e} {:>11.6f}", p.error, p.cpu_seconds);
      if (!is_single) fmt::print(" {:>11d}", p.evaluations);
    }
    if (p.code == "recursion") fmt::print("\n");
    std::fflush(stdout);
  };
  Ladder ladder;
  ladder.single = true;
  const WorkPrecision result = work_precision(scene, show, ladder);
  const bool has_reference = result.reference_steps > 0;
  if (has_reference) {
    fmt::print("\nreference   {} in long double, {} steps; half as many move it by {:.1e}\n",
               result.reference_method, result.reference_steps, result.reference_error);
  } else {
    fmt::print("\nreference   NONE: {} in long double does not converge; no error is known\n",
               result.reference_method);
  }
  for (const char* code : {"generated", "recursion"}) {
    const RoundingFloor floor = rounding_floor(result, code);
    fmt::print("floor       {:10s} {:.1e}, {}\n", code, floor.error,
               floor.seen ? fmt::format("reached at {} {:.{}e}: below it, only the cost grows",
                                        by_step ? "step" : "tolerance", floor.tolerance, by_step ? 2 : 0)
                          : "not reached on this ladder");
  }
  write_output((folder / "work_precision.csv").string(), table);
  write_output((folder / "work_precision.json").string(), to_json(scene, result).dump(1) + "\n");
  fmt::print("files       {}, {}\n", (folder / "work_precision.csv").string(),
             (folder / "work_precision.json").string());
  const auto is_ok = [](const WorkPrecisionPoint& p) { return p.status == "ok"; };
  return has_reference && std::ranges::any_of(result.points, is_ok) ? ok : check_failed;
}

int print_conditioning(const Scene& scene, const std::filesystem::path& folder) {
  const PathConditioning path = [&] {
    ProgressLine line(scene.duration);
    return path_conditioning(scene, [&](const char* stage, double t) { line(stage, t); });
  }();
  if (path.points.empty()) {
    fmt::print("status      {}\n", path.motion.status);
    return check_failed;
  }
  const auto by = [](double PathPoint::*member) {
    return [member](const PathPoint& p) { return p.*member; };
  };
  const PathPoint& hardest = *std::ranges::max_element(path.points, {}, by(&PathPoint::condition));
  const PathPoint& worst = *std::ranges::max_element(path.points, {}, by(&PathPoint::error));
  fmt::print("{}, {}: {} states, status {}\n", scene.model.name, scene.name, path.points.size(),
             path.motion.status);
  fmt::print("  condition of (A, B_p)   at most {:.3g}, at t = {:.6g} s\n", hardest.condition, hardest.t);
  fmt::print("  error of accelerations  at most {:.2e}, at t = {:.6g} s, where the condition is {:.3g}\n",
             worst.error, worst.t, worst.condition);
  if (path.motion.charts > 1) {
    double least = 1;
    for (const PathPoint& p : path.points) least = std::min(least, p.quality[p.chart - 1]);
    fmt::print("  charts of the kernel    {}, changed {} times; quality of the one in use at least {:.3g}\n",
               path.motion.charts, path.motion.chart_changes.size(), least);
  }
  const std::string csv = (folder / "conditioning.csv").string(),
                    svg = (folder / "conditioning.svg").string();
  write_output(csv, conditioning_csv(path));
  write_output(svg, conditioning_svg(path, scene.model.name + ", " + scene.name));
  fmt::print("  files                   {}, {}\n", csv, svg);
  return path.motion.finished ? ok : check_failed;
}

/// Remark 7: a column a row, a line a stiffness.
int print_stiffness_ladder(const Scene& scene, const std::vector<double>& factors) {
  const StiffnessLadder ladder = stiffness_ladder(scene, factors);
  fmt::print("{}, {}: multipliers at t = {:g} s, contacts elastic and rigid\n\n", scene.model.name,
             scene.name, scene.duration);
  std::size_t width = 12;
  for (const std::string& row : ladder.rows) width = std::max(width, row.size() + 1);
  fmt::print("{:>{}s}", "stiffness", width);
  for (const StiffnessStep& step : ladder.steps) fmt::print(" {:>13.2g}", step.stiffness);
  fmt::print(" {:>13s}\n", "rigid");
  for (std::size_t i = 0; i < ladder.rows.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    fmt::print("{:>{}s}", ladder.rows[i], width);
    for (const StiffnessStep& step : ladder.steps) fmt::print(" {:>13.6f}", step.lambda(row));
    fmt::print(" {:>13.6f}\n", ladder.rigid(row));
  }
  fmt::print("{:>{}s}", "distance", width);
  for (const StiffnessStep& step : ladder.steps) fmt::print(" {:>13.2e}", step.distance);
  fmt::print(
      "\n\ndistance: the largest difference to the rigid contacts, relative to the largest multiplier\n");
  int status = ok;
  for (const StiffnessStep& step : ladder.steps) {
    if (step.status == "ok") continue;
    fmt::print("FAILED: stiffness {:.2g} stopped before the end, and its column is of there: {}\n",
               step.stiffness, step.status);
    status = check_failed;
  }
  return status;
}

/// "EI:1" or "EI" as a parameter and its exponent.
std::vector<Growth> growths_of(const std::vector<std::string>& texts) {
  std::vector<Growth> result;
  for (const std::string& text : texts) {
    const std::size_t colon = text.find(':');
    Growth growth{text.substr(0, colon), 1};
    if (colon != std::string::npos) {
      const char* begin = text.c_str() + colon + 1;
      char* end = nullptr;
      growth.exponent = std::strtod(begin, &end);
      if (end == begin || *end != 0 || !std::isfinite(growth.exponent))
        throw std::invalid_argument(
            fmt::format("--stiffness-cost is '{}', not PARAMETER:EXPONENT, for example EI:1", text));
    }
    result.push_back(growth);
  }
  return result;
}

int print_stiffness_cost(const Scene& scene, const std::vector<Growth>& growths,
                         const std::filesystem::path& folder) {
  fmt::print(
      "{}, {}: cost of a final state that is off by {:.0e} of the sizes of the motion (pose, r_p, nu)\n\n",
      scene.model.name, scene.name, cost_accuracy);
  fmt::print("{:>9s} {:>11s}  {:>7s} {:>11s} {:>9s} {:>9s}  {:>11s} {:>9s} {:>9s}  {:>9s}\n", "factor",
             "fast [1/s]", "stiff:", "evaluations", "cpu [s]", "error", "explicit:", "cpu [s]", "error",
             "ref. own");
  std::fflush(stdout);
  const StiffnessCost result = stiffness_cost(scene, growths, [](const StiffnessCostRow& row) {
    fmt::print("{:>9.0e} {:>11.3g}  {:>7d} {:>11d} {:>9.5f} {:>9.1e}  {:>11d} {:>9.4f} {:>9.1e}  {:>9.1e}",
               row.factor, row.fast, row.stiff.jacobians, row.stiff.evaluations, row.stiff.cpu_seconds,
               row.stiff.error, row.explicit_method.evaluations, row.explicit_method.cpu_seconds,
               row.explicit_method.error, row.reference_error);
    fmt::print("\n");
    std::fflush(stdout);
  });
  std::string table =
      "factor,fast_per_s,stiff_steps,stiff_evaluations,stiff_cpu_s,stiff_error,stiff_tolerance,explicit_"
      "evaluations,"
      "explicit_cpu_s,explicit_error,explicit_tolerance,reference_error,to_limit\n";
  fmt::print("\ndistance of the reference's end to that at the largest factor:");
  for (const StiffnessCostRow& row : result.rows) {
    table += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", row.factor, row.fast,
                         row.stiff.jacobians, row.stiff.evaluations, row.stiff.cpu_seconds, row.stiff.error,
                         row.stiff.tolerance, row.explicit_method.evaluations,
                         row.explicit_method.cpu_seconds, row.explicit_method.error,
                         row.explicit_method.tolerance, row.reference_error, row.to_limit);
    if (&row != &result.rows.back()) fmt::print(" {:.1e}", row.to_limit);
  }
  fmt::print("\nstiff: Jacobians, one a step, of {} operations; an evaluation is {} operations\n",
             result.jacobian_operations, result.operations);
  fmt::print(
      "cost of the stiff method grows {:.2f}-fold in evaluations, that of the explicit one {:.3g}-fold\n",
      result.growth(&StiffnessCostRow::stiff), result.growth(&StiffnessCostRow::explicit_method));
  fmt::print("reference   Radau collocation of order 9 in long double\n");
  const std::string csv = (folder / "stiffness_cost.csv").string(),
                    svg = (folder / "stiffness_cost.svg").string();
  write_output(csv, table);
  write_output((folder / "stiffness_cost.json").string(), to_json(scene, result).dump(1) + "\n");
  write_output(svg, stiffness_cost_svg(result, scene.model.name + ", " + scene.name));
  fmt::print("files       {}, {}\n", csv, svg);
  const auto reached = [](const StiffnessCostRow& row) { return row.stiff.error <= cost_accuracy; };
  return std::ranges::all_of(result.rows, reached) ? ok : check_failed;
}

/// Switches, and what the contacts carried.
void print_contacts(const SimulationResult& result) {
  for (const ContactSwitch& at : result.switches)
    fmt::print("  contacts at {:<8.6g}  {} -> {}: {:.3g} J lost, jump {:.2g}\n", at.t,
               at.from.empty() ? "none" : at.from, at.to, at.lost, at.relative);
  for (const ContactHistory& c : result.contacts) {
    if (!c.has_normal) continue;
    std::string text = fmt::format("least load {:.4g} N at {:.4g} s", c.least_normal, c.least_normal_at);
    if (c.has_friction)
      text +=
          fmt::format(", friction used {:.0f} % at {:.4g} s", 100 * c.largest_utilisation, c.utilisation_at);
    if (c.lifts_at) text += fmt::format("; WOULD LIFT at {:.4g} s", *c.lifts_at);
    if (c.slips_at) text += fmt::format("; WOULD SLIP at {:.4g} s", *c.slips_at);
    fmt::print("  {:<21s} {}\n", c.contact, text);
  }
}

}  // namespace

int simulate(const SimulateOptions& options) {
  const Stopwatch watch;
  Scene scene = read_scene(options.scene);
  scene.optimise = options.optimise;
  const std::filesystem::path folder =
      options.output.empty() ? std::filesystem::path("out") / (scene.model.name + "_" + scene.name)
                             : std::filesystem::path(options.output);
  if (options.work_precision) return print_work_precision(scene, folder);
  if (options.conditioning) return print_conditioning(scene, folder);
  if (!options.stiffness_cost.empty())
    return print_stiffness_cost(scene, growths_of(options.stiffness_cost), folder);
  if (!options.stiffen.empty()) return print_stiffness_ladder(scene, options.stiffen);

  const SimulationResult result = [&] {
    ProgressLine line(scene.duration);
    return simulate_scene(scene, [&](const char* stage, double t) { line(stage, t); });
  }();
  if (!result.rows.empty()) write_output((folder / "trajectory.csv").string(), trajectory_csv(result));
  write_output((folder / "summary.json").string(), to_json(scene, result).dump(1) + "\n");

  fmt::print("{}, scene {}{}\n", scene.model.name, scene.name, scene.title.empty() ? "" : ": " + scene.title);
  fmt::print("  class (Table I)       {}\n", result.class_of_table_I);
  fmt::print("  integrator            {}{}\n",
             scene.integrator.method == Integrator::Method::automatic ? "auto: " : "",
             integrator_text(scene.integrator, result.method));
  if (!result.why.empty()) fmt::print("  chosen because        {}\n", result.why);
  fmt::print("  status                {} ({} s simulated, {} steps, {} rejected, {} evaluations)\n",
             result.status, result.rows.empty() ? 0.0 : result.rows.back()[0], result.steps, result.rejected,
             result.evaluations);
  if (result.projected)
    fmt::print("  imposed motion        projected to a compatible one, at most {:.3g} rad or m from it\n",
               result.departure);
  if (result.charts > 1)
    fmt::print("  charts of the kernel  {}, changed {} times\n", result.charts, result.chart_changes.size());
  fmt::print("  one evaluation        {} operations, {:.0f} ns\n", result.operations,
             result.nanoseconds_per_evaluation);
  if (result.jacobians > 0)
    fmt::print("  Jacobians             {}, {} operations each\n", result.jacobians,
               result.jacobian_operations);
  fmt::print("  energy balance        {:.2e} of the largest energy, {:.3g} J\n", result.energy_balance,
             result.largest_energy);
  fmt::print("  constraint residual   {:.2e} relative\n", result.constraint_residual);
  if (result.position_residual > 0)
    fmt::print("  position residual     {:.2e} m\n", result.position_residual);
  fmt::print("  ||R^T R - 1||         {:.2e}\n", result.orthonormality);
  const bool lost = result.rounding.is_loss();
  if (lost)
    fmt::print(
        "  LOST DIGITS           at t = {:.6g} s the accelerations keep {:.1f} digits where rounded inputs "
        "would leave "
        "{:.1f}: their program loses them; links or masses of very different sizes do that "
        "(docs/hard-cases.md)\n",
        result.rounding.t, std::max(0.0, -std::log10(result.rounding.error)),
        std::min(16.0, -std::log10(result.rounding.least)));
  print_contacts(result);
  fmt::print("  time                  {:.4f} s integration, {:.2f} s in all\n", result.cpu_seconds,
             watch.seconds());
  fmt::print("  files                 {}{}\n",
             result.rows.empty() ? "" : (folder / "trajectory.csv").string() + ", ",
             (folder / "summary.json").string());
  return result.finished && !lost ? ok : check_failed;
}

}  // namespace anholon::cli
