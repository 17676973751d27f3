// SPDX-License-Identifier: GPL-2.0-or-later
#include "report/record.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "check/compile_cache.hpp"
#include "check/evaluate_program.hpp"
#include "check/verify.hpp"
#include "check/verify_tree.hpp"
#include "describe/deformation.hpp"
#include "emit/header.hpp"
#include "emit/plan.hpp"
#include "emit/provenance.hpp"
#include "reduce/samples.hpp"
#include "report/motion_json.hpp"
#include "report/timing.hpp"
#include "simulate/work_precision.hpp"

namespace anholon {
namespace {

using nlohmann::ordered_json;

ordered_json sizes_of(const GeneratedModel& g) {
  ordered_json sizes = {{"bodies", g.model.bodies.size()}, {"coordinates", g.model.coordinates.size()}};
  if (g.reduction == nullptr) return sizes;
  const ReductionReport& reduction = g.reduction->reduction;
  const Partition& p = reduction.partition;
  sizes["n"] = p.n, sizes["s_p"] = p.s_p(), sizes["s_a"] = p.s_a();
  sizes["rows"] = reduction.ranks.rows, sizes["m"] = reduction.ranks.m;
  sizes["m_locked"] = reduction.ranks.m_locked;
  sizes["reduced_velocities"] = reduction.kernel.H.cols(), sizes["charts"] = reduction.charts.size();
  return sizes;
}

/// States of the working range, velocities and forces in +-1, as time_functions() takes them.
std::vector<double> random_states(const Model& model, const Program& program, int count) {
  SampleSource source(7);
  const Partition partition = partition_of(model);
  std::vector<double> states;
  for (int s = 0; s < count; ++s) {
    NamedValues<Exact> in = position_inputs(model, partition, random_state(model, source));
    for (const InputBlock& block : program.inputs) {
      const std::vector<Exact>& known = in[block.name];
      for (std::size_t i = 0; i < block.nodes.size(); ++i)
        states.push_back(i < known.size() ? known[i].to_double() : 2 * source.uniform() - 1);
    }
  }
  return states;
}

ordered_json time_json(const CallTime& time) {
  return {{"median", time.median}, {"least", time.least}, {"spread", time.spread}};
}

ordered_json error_json(const OutputError& e) {
  constexpr double ulp = 2.220446049250313e-16;
  ordered_json j = {{"output", e.output},
                    {"median_ulps", finite_or_null(e.median / ulp)},
                    {"p99_ulps", finite_or_null(e.p99 / ulp)},
                    {"worst_ulps", finite_or_null(e.worst / ulp)},
                    {"worst_at", e.worst_at},
                    {"passed", e.passed}};
  if (e.condition > 0) j["condition"] = e.condition;
  if (e.recursion_worst >= 0) j["recursion_worst_ulps"] = finite_or_null(e.recursion_worst / ulp);
  return j;
}

/// A larger error needs the condition of its output as a reason.
constexpr double unexplained_ulps = 50;

std::string class_of(const GeneratedModel& g) {
  if (g.tree != nullptr) return "tree whose joints are all driven";
  return g.reduction->reduction.ranks.table_I_class(g.reduction->reduction.partition);
}

}  // namespace

ordered_json operations_record(const OperationCount& count) {
  return {{"total", count.total()},
          {"additions", count.additions},
          {"multiplications", count.multiplications},
          {"divisions", count.divisions},
          {"sines_and_cosines", count.trigonometric()}};
}

ordered_json model_record(const GeneratedModel& g, const MeasureOptions& options, const Stage& stage) {
  const Program& program = g.program();
  ordered_json record = {{"schema", "anholon.report.model/1"},
                         {"model", g.model.name},
                         {"title", g.model.title},
                         {"sizes", sizes_of(g)},
                         {"table_I", class_of(g)},
                         {"deformation", kept_terms(g.model)}};
  stage("compiling");
  const CompileEffort effort = compile_effort(program);
  record["generation_s"] = g.seconds;
  record["header_bytes"] = emit_header(program).size();
  record["compile_s"] = effort.seconds;
  record["object_bytes"] = effort.object_bytes;

  stage("timing");
  const std::vector<double> states = random_states(g.model, program, options.states);
  const std::vector<FunctionTime> times = time_functions(program, states, options.rounds);
  StatementStyle batch;
  batch.sincos = SinCos::batch;
  const std::vector<FunctionTime> batch_times = time_functions(program, states, options.rounds, batch);

  stage("verifying");
  const VerificationPlan plan_of_errors{options.samples, unexplained_ulps * 0x1p-52};
  const auto progress = [&](int done) { stage(fmt::format("verifying, {} of {}", done, options.samples)); };
  const Verification v = g.tree != nullptr ? verify_tree(g.model, *g.tree, plan_of_errors, progress)
                                           : verify_program(g.model, *g.reduction, plan_of_errors, progress);
  record["verification"] = {{"samples", v.samples},
                            {"formulas_worst", v.formula_worst},
                            {"formula_samples", v.formula_samples},
                            {"energy_balance", v.energy_balance},
                            {"passed", v.passed}};

  const EmissionPlan plan = plan_emission(program);
  record["functions"] = ordered_json::array();
  for (std::size_t i = 0; i < plan.functions.size(); ++i) {
    const PlannedFunction& f = plan.functions[i];
    ordered_json entry = {{"function", f.function->name},
                          {"operations", operations_record(f.operations)},
                          {"operations_without_prepare", f.unprepared.total()},
                          {"ns_double", time_json(times[i].by_double)},
                          {"ns_float", time_json(times[i].by_float)},
                          {"ns_double_batch_sines", time_json(batch_times[i].by_double)},
                          {"routes", ordered_json::array()},
                          {"passes", ordered_json::array()},
                          {"modes", ordered_json::array()},
                          {"errors", ordered_json::array()}};
    const auto measured = [](ordered_json to, int operations, const RoundingError& error) {
      to["operations"] = operations;
      if (error.is_measured()) {
        to["median_ulps"] = finite_or_null(error.median);
        to["worst_ulps"] = finite_or_null(error.worst);
      }
      return to;
    };
    for (const CandidateReport& c : g.candidates()) {
      if (c.function == f.function->name)
        entry["routes"].push_back(measured({{"route", c.route}, {"kept", c.chosen}}, c.operations, c.error));
    }
    for (const PassReport& pass : g.trace()) {
      if (pass.function == f.function->name)
        entry["passes"].push_back(measured({{"after", pass.pass}}, pass.operations, pass.error));
    }
    for (const ModeResult& mode : g.modes) {
      for (const CandidateReport& c : mode.kept) {
        if (c.function == f.function->name)
          entry["modes"].push_back(
              measured({{"mode", name(mode.mode)}, {"route", c.route}}, c.operations, c.error));
      }
    }
    for (const OutputError& e : v.outputs) {
      if (e.function == f.function->name) entry["errors"].push_back(error_json(e));
    }
    record["functions"].push_back(std::move(entry));
  }
  return record;
}

ordered_json motion_record(const Scene& scene, const Stage& stage) {
  ordered_json record = {{"schema", "anholon.report.motion/1"},
                         {"model", scene.model.name},
                         {"scene", scene.name},
                         {"title", scene.title},
                         {"duration_s", scene.duration}};
  try {
    stage("simulating");
    record["run"] = to_json(scene, simulate_scene(scene));
    Ladder ladder;
    ladder.single = true;
    record["ladder"] = to_json(
        scene,
        work_precision(
            scene, [&](const auto& p) { stage(fmt::format("{} at {:.0e}", p.code, p.tolerance)); }, ladder));
  } catch (const UnfitSceneError& error) {  // several phases, no duration
    record["left_out"] = error.what();
  } catch (const UnsupportedError& error) {  // a projected motion, or what has no program
    record["left_out"] = error.what();
  }
  return record;
}

ordered_json machine_record() {
  std::string processor = "unknown", line;
  std::ifstream info("/proc/cpuinfo");
  while (std::getline(info, line)) {
    if (!line.starts_with("model name")) continue;
    processor = line.substr(line.find(':') + 2);
    break;
  }
  const CompileOptions options;
  ordered_json flags = ordered_json::array();
  for (const std::string& flag : flags_of(options)) flags.push_back(flag);
  return {{"processor", processor},
          {"compiler", compiler_name(options)},
          {"flags", flags},
          {"anholon", std::string(generator_version())}};
}

}  // namespace anholon
