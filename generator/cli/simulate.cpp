// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "check/simulation.hpp"
#include "cli/common.hpp"

namespace anholon::cli {
namespace {

std::string csv(const SimulationResult& result) {
  std::string text;
  for (const std::string& c : result.columns) text += (text.empty() ? "" : ",") + c;
  text += "\n";
  for (const auto& row : result.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += fmt::format("{}{}", i == 0 ? "" : ",", row[i]);
    text += "\n";
  }
  return text;
}

int print_work_precision(const Scene& scene, const std::filesystem::path& folder) {
  const auto points = work_precision(scene);
  std::string table = "code,tolerance,error,cpu_s,evaluations,status\n";
  fmt::print("{}, {}: error of the final state against a long double run at tolerance 1e-16\n",
             scene.model.name, scene.name);
  fmt::print("{:>10s} {:>10s} {:>11s} {:>12s} {:>12s}  {}\n", "code", "tolerance", "error", "cpu [s]",
             "evaluations", "status");
  for (const auto& p : points) {
    fmt::print("{:>10s} {:>10.0e} {:>11.2e} {:>12.6f} {:>12d}  {}\n", p.code, p.tolerance, p.error,
               p.cpu_seconds, p.evaluations, p.status);
    table += fmt::format("{},{},{},{},{},{}\n", p.code, p.tolerance, p.error, p.cpu_seconds, p.evaluations,
                         p.status);
  }
  write_output((folder / "work_precision.csv").string(), table);
  fmt::print("wrote {}\n", (folder / "work_precision.csv").string());
  return ok;
}

}  // namespace

int simulate(const SimulateOptions& options) {
  const Stopwatch watch;
  const Scene scene = read_scene(options.scene);
  const std::filesystem::path folder =
      options.output.empty() ? std::filesystem::path("out") / (scene.model.name + "_" + scene.name)
                             : std::filesystem::path(options.output);
  if (options.work_precision) return print_work_precision(scene, folder);

  const SimulationResult result = simulate_scene(scene);
  if (!result.rows.empty()) write_output((folder / "trajectory.csv").string(), csv(result));
  nlohmann::ordered_json j = {{"schema", "anholon.simulation/1"},
                              {"model", scene.model.name},
                              {"scene", scene.name},
                              {"status", result.status},
                              {"finished", result.finished},
                              {"table_I", result.class_of_table_I},
                              {"steps", result.steps},
                              {"rejected", result.rejected},
                              {"evaluations", result.evaluations},
                              {"operations_per_evaluation", result.operations},
                              {"nanoseconds_per_evaluation", result.nanoseconds_per_evaluation},
                              {"cpu_seconds", result.cpu_seconds},
                              {"energy_balance", result.energy_balance},
                              {"constraint_residual", result.constraint_residual},
                              {"orthonormality", result.orthonormality}};
  write_output((folder / "summary.json").string(), j.dump(1) + "\n");

  const bool adaptive = scene.integrator.method == Integrator::Method::dopri5;
  fmt::print("{}, scene {}{}\n", scene.model.name, scene.name, scene.title.empty() ? "" : ": " + scene.title);
  fmt::print("  class (Table I)       {}\n", result.class_of_table_I);
  fmt::print("  integrator            {}\n",
             adaptive
                 ? fmt::format("Dormand-Prince 5(4) in Lie form, tolerance {:g}", scene.integrator.tolerance)
                 : fmt::format("Munthe-Kaas RK4, step {:g} s", scene.integrator.step));
  fmt::print("  status                {} ({} s simulated, {} steps, {} rejected, {} evaluations)\n",
             result.status, result.rows.empty() ? 0.0 : result.rows.back()[0], result.steps, result.rejected,
             result.evaluations);
  fmt::print("  one evaluation        {} operations, {:.0f} ns\n", result.operations,
             result.nanoseconds_per_evaluation);
  fmt::print("  energy balance        {:.2e} of the largest energy\n", result.energy_balance);
  fmt::print("  constraint residual   {:.2e} relative\n", result.constraint_residual);
  fmt::print("  ||R^T R - 1||         {:.2e}\n", result.orthonormality);
  fmt::print("  time                  {:.4f} s integration, {:.2f} s in all\n", result.cpu_seconds,
             watch.seconds());
  if (!result.rows.empty())
    fmt::print("  files                 {}, {}\n", (folder / "trajectory.csv").string(),
               (folder / "summary.json").string());
  return result.finished ? ok : check_failed;
}

}  // namespace anholon::cli
