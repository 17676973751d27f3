// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/path_conditioning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "check/compiled_caller.hpp"
#include "simulate/rank_monitor.hpp"
#include "simulate/runner.hpp"
#include "simulate/svg_plot.hpp"

namespace anholon {
namespace {

constexpr unsigned path_digits = 50;

/// What the functions read at a row.
struct Seen {
  NamedValues<double> inputs;
  PathPoint point;
};

/// Largest difference, relative to the largest entry of all.
double error_of(const NamedValues<double>& got, const NamedValues<Exact>& want) {
  double largest = 0, size = 0;
  for (const char* block : {"eta_dot", "r_p_ddot", "r_d_ddot"}) {
    const auto found = want.find(block);
    if (found == want.end()) continue;
    for (std::size_t i = 0; i < found->second.size(); ++i) {
      const double x = got.at(block)[i];
      if (!std::isfinite(x)) return INFINITY;
      largest = std::max(largest, std::abs((Exact::from_double(x) - found->second[i]).to_double()));
      size = std::max(size, std::abs(found->second[i].to_double()));
    }
  }
  return size > 0 ? largest / size : largest;
}

}  // namespace

PathConditioning path_conditioning(const Scene& scene, const Progress& progress) {
  require_one_phase(scene, "conditioning is followed along the motion of one set of contacts");
  PathConditioning path;
  std::vector<Seen> rows;
  path.motion = simulate_scene(scene, progress, [&](const SceneProgram& program, Runner<double>& run) {
    Seen seen;
    for (const InputBlock& block : program.derivation->program.inputs) {
      const std::vector<double>& values = run.b[block.name];
      if (values.size() == block.nodes.size()) seen.inputs[block.name] = values;  // else nothing reads it
    }
    seen.point.t = run.b.t[0];
    seen.point.chart = run.chart() + 1;
    seen.point.condition = RankMonitor(program, run).condition();
    if (run.chart_quality) {
      run.chart_quality();
      seen.point.quality = run.b.chart_quality;
    }
    rows.push_back(std::move(seen));
  });
  const SceneProgram program = make_program(scene);
  const Program& code = program.derivation->program;
  std::vector<Exact> parameters;
  for (const ParameterInfo& p : code.parameters)
    parameters.push_back(Exact::from_double(p.value.to_double()));
  const auto generated = compiled_caller(code, parameters);
  const auto exact = interpreting_caller<Exact>(code, parameters);
  const WorkingDigits precision(path_digits);
  for (Seen& seen : rows) {
    if (progress) progress("comparing with exact arithmetic", seen.point.t);
    const std::string function = chart_prefix(seen.point.chart - 1) + "forward_dynamics";
    if (find_function(code, function) != nullptr) {
      NamedValues<Exact> inputs;
      for (const auto& [name, values] : seen.inputs) {
        for (const double x : values) inputs[name].push_back(Exact::from_double(x));
      }
      seen.point.error = error_of(generated(function, seen.inputs), exact(function, inputs));
    }
    path.points.push_back(std::move(seen.point));
  }
  return path;
}

std::string conditioning_csv(const PathConditioning& path) {
  const std::size_t charts = path.motion.charts;
  std::string text = "t [s],chart [1],condition of (A B_p) [1]";
  for (std::size_t c = 1; charts > 1 && c <= charts; ++c) text += fmt::format(",quality of chart {} [1]", c);
  text += ",error of the accelerations [1]\n";
  for (const PathPoint& p : path.points) {
    text += fmt::format("{},{},{}", p.t, p.chart, p.condition);
    for (const double q : p.quality) text += fmt::format(",{}", q);
    text += fmt::format(",{}\n", p.error);
  }
  return text;
}

std::string conditioning_svg(const PathConditioning& path, const std::string& title) {
  Panel conditioning{"conditioning", {}}, error{"relative error of the accelerations", {}};
  conditioning.curves.push_back({"condition of (A, B_p)", {}});
  for (std::size_t c = 1; path.motion.charts > 1 && c <= path.motion.charts; ++c)
    conditioning.curves.push_back({fmt::format("1/quality of chart {}", c), {}});
  if (path.motion.charts > 1) conditioning.curves.push_back({"1/quality of the chart in use", {}});
  error.curves.push_back({"double against 50 digits", {}});
  error.curves.push_back({"2^-53 times the condition", {}});
  std::vector<double> times;
  for (const PathPoint& p : path.points) {
    times.push_back(p.t);
    std::size_t curve = 0;
    conditioning.curves[curve++].values.push_back(p.condition);
    for (const double q : p.quality) conditioning.curves[curve++].values.push_back(1 / q);
    if (!p.quality.empty()) conditioning.curves[curve].values.push_back(1 / p.quality[p.chart - 1]);
    error.curves[0].values.push_back(p.error);
    error.curves[1].values.push_back(0x1p-53 * p.condition);
  }
  return svg_plot(title, "t [s]", times, {conditioning, error});
}

}  // namespace anholon
