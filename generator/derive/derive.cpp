// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/derive.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "derive/deriver.hpp"
#include "describe/function_names.hpp"
#include "optimise/tape/hoist.hpp"

namespace anholon {
namespace {

constexpr int random_samples = 24;

}  // namespace

std::vector<int> range(int n) {
  std::vector<int> r(static_cast<std::size_t>(n));
  std::iota(r.begin(), r.end(), 0);
  return r;
}

std::vector<NodeId> roots_of(const Route& r) {
  std::vector<NodeId> roots;
  for (const OutputBlock& b : r.outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  return roots;
}

Deriver::Deriver(const Model& model, const DeriveRequest& request)
    : model_(model),
      request_(request),
      result_(std::make_unique<Derivation>()),
      program_(result_->program),
      tape_(program_.tape),
      motion_partition_(partition_of(model, request.torque_driven)),
      symbols_(model, partition_of(model), program_),
      description_(describe_mechanism(model)),
      described_(mechanise<Expr>(description_, symbols_.parameters(), FromExact<Expr>{&tape_})),
      mechanism_(merged(described_)),
      dynamics_(mechanism_),
      samples_(sample_states(model, random_samples)),
      names_(velocity_names(model)),
      sampled_inputs_(model) {
  described_.open_section =
      mechanism_.open_section = [this](const std::string& title) { tape_.section(title); };
  for (const Parameter& p : model.parameters) defaults_.push_back(p.value);
  for (const ParameterInfo& p : program_.parameters) parameter_nodes_.push_back(p.node);
}

std::unique_ptr<Derivation> Deriver::run() {
  begin_program(program_, model_, request_.scene, request_.functions, function_names());
  motion_ = reduce(motion_partition_);
  atlas_ = &motion_.atlas;
  nu_ = symbols_.block("nu", motion_.k(), "mixed", "reduced velocities: " + meaning_of_nu(motion_));
  r_a_dot_ = symbols_.block("r_a_dot", motion_partition_.s_a(), "rad/s or m/s", "rates of r_a");
  r_a_ddot_ =
      symbols_.block("r_a_ddot", motion_partition_.s_a(), "rad/s^2 or m/s^2", "second derivatives of r_a");

  prepare_state_jacobian();
  derive_kinematics();
  derive_constraints();
  derive_free_dynamics();
  derive_reduced_dynamics();
  derive_state_jacobian();
  derive_torques_and_multipliers();
  derive_compatibility();
  derive_torque_driven();
  derive_position_conditions();
  derive_energies();
  derive_poses();
  derive_further_charts();
  result_->reduction = report(motion_);
  for (const auto& chart : motion_.atlas.charts) {
    if (request_.rates)
      result_->rates.push_back(
          symbols_.motion(merged(motion_partition_, chart->velocities(r_a_dot_, nu_), r_a_dot_)));
  }
  note_header();
  if (request_.trace) trace();  // last: it leaves nodes on the tape, which no function needs
  return std::move(result_);
}

Reduced Deriver::reduce(const Partition& partition) {
  Reduced r;
  r.partition = partition;
  r.ranks = analyse_ranks(description_, defaults_, partition, samples_, request_.leading_rows);
  tape_.section("constraints");
  const Matrix<Expr> G = dynamics_.constraints(symbols_.position()).first;
  const std::vector<int> rows = range(G.rows());
  std::vector<int> preferred;
  for (const std::string& name : model_.free_velocities) {
    const auto at = std::ranges::find(partition.passive,
                                      static_cast<int>(std::ranges::find(names_, name) - names_.begin()));
    if (at != partition.passive.end()) preferred.push_back(static_cast<int>(at - partition.passive.begin()));
  }
  std::vector<std::string> passive_names;
  for (const int i : partition.passive) passive_names.push_back(names_[static_cast<std::size_t>(i)]);
  tape_.section("kernel");
  r.atlas = choose_atlas(tape_, symbols_,
                         {&model_,
                          {G.block(rows, partition.passive), G.block(rows, partition.active)},
                          &r.ranks,
                          request_.inverse,
                          preferred,
                          passive_names,
                          samples_});
  r.reduction = r.atlas.charts.front().get();
  return r;
}

ReductionReport Deriver::report(const Reduced& of) const {
  ReductionReport r{of.partition,        of.ranks, of.atlas.charts.front()->kernel(),
                    request_.inverse,    {},       of.atlas.first_basis_singular_at,
                    of.atlas.singular_at};
  for (const auto& chart : of.atlas.charts) r.charts.push_back(chart->kernel());
  return r;
}

std::string Deriver::meaning_of_nu(const Reduced& of) {
  const auto& charts = of.atlas.charts;
  std::string text = charts.front()->kernel().description;
  for (std::size_t c = 1; c < charts.size(); ++c)
    text += fmt::format("; in chart {}: {}", c + 1, charts[c]->kernel().description);
  return text;
}

void Deriver::derive_further_charts() {
  const KernelAtlas& atlas = motion_.atlas;
  if (atlas.charts.size() < 2) return;
  for (std::size_t c = 1; c < atlas.charts.size(); ++c) {
    prefix_ = chart_prefix(c);
    chart_ = c;
    motion_.reduction = atlas.charts[c].get();
    derive_kinematics();
    derive_reduced_dynamics();
    derive_state_jacobian();
    derive_torques_and_multipliers();
    derive_compatibility();
  }
  prefix_.clear();
  chart_ = 0;
  motion_.reduction = atlas.charts.front().get();
  emit_quality(atlas, "chart_quality", "nu", "reduced_velocities", "kinematics");
}

void Deriver::emit_quality(const KernelAtlas& atlas, const std::string& name, const std::string& nu,
                           const std::string& to, const std::string& from) {
  emit(name,
       fmt::format(
           "How good each chart is here, from 1 down to 0 where it is singular. Change where that in use "
           "falls below a quarter of the best: {} is then what {} of the new chart makes of what {} of the "
           "old one gives.",
           nu, to, from),
       {{"elimination", {block("quality", "1", "one for each chart", atlas.quality)}}});
}

void Deriver::note_header() {
  if (request_.optimise != OptimiseFor::balanced)
    program_.notes.push_back(fmt::format("optimised for {}", anholon::name(request_.optimise)));
  const RankAnalysis& r = motion_.ranks;
  program_.notes.push_back(fmt::format(
      "group {}: n = {}, s_p = {}, s_a = {}, rows = {}, m = {}, m_locked = {}", name(model_.group),
      motion_partition_.n, motion_partition_.s_p(), motion_partition_.s_a(), r.rows, r.m, r.m_locked));
  program_.notes.push_back("Table I: " + r.table_I_class(motion_partition_));
  const auto& charts = motion_.atlas.charts;
  for (std::size_t c = 0; c < charts.size(); ++c)
    program_.notes.push_back(fmt::format("{}: {}",
                                         charts.size() > 1 ? fmt::format("chart {}", c + 1) : "kernel",
                                         charts[c]->kernel().description));
  if (charts.size() > 1)
    program_.notes.emplace_back(
        "no basis serves everywhere: functions that know nu are there once for each chart, in namespaces "
        "chart1, chart2, ...; those without such a namespace are of chart 1; choose_chart() compares and "
        "is "
        "the only function that branches");
}

std::string chart_prefix(std::size_t chart) { return chart == 0 ? "" : fmt::format("chart{}::", chart + 1); }

OperationCount operations_per_call(const Program& program, const std::vector<NodeId>& roots) {
  std::vector<NodeId> parameters;
  for (const ParameterInfo& p : program.parameters) parameters.push_back(p.node);
  return operations_per_call(program.tape, roots, parameters);
}

void begin_program(Program& program, const Model& model, const std::string& scene,
                   const std::vector<std::string>& functions, const std::vector<std::string>& known) {
  program.model = model.name;
  program.scene = scene;
  program.name_space = model.name + "::" + scene;
  program.source_file = model.file;
  program.source_sha256 = model.sha256;
  refuse_unknown_functions(functions, known);
}

std::unique_ptr<Derivation> derive(const Model& model, const DeriveRequest& request) {
  return Deriver(model, request).run();
}

}  // namespace anholon
