// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "check/compile_cache.hpp"
#include "cli/common.hpp"
#include "describe/deformation.hpp"
#include "describe/function_names.hpp"
#include "describe/read_bytes.hpp"
#include "describe/scene.hpp"
#include "emit/c_abi.hpp"
#include "emit/header.hpp"
#include "emit/write_file.hpp"
#include "optimise/tree_loops.hpp"

namespace anholon::cli {
namespace {

/// Operations of the same functions for the whole model, nothing frozen, locked or left out; empty without a
/// scene.
std::map<std::string, int> operations_without_scene(const GenerateOptions& options, const Program& program) {
  if (scene_file(options).empty()) return {};
  const Scene scene = load_scene(options);
  DeriveRequest request = derive_request(options, scene.model);
  request.functions.clear();
  for (const Function& f : program.functions) {  // those of further charts come along
    if (std::ranges::find(function_names(), f.name) != function_names().end())
      request.functions.push_back(f.name);
  }
  std::map<std::string, int> operations;
  try {
    const auto whole = derive(scene.model, request);
    for (const Function& f : whole->program.functions)
      operations[f.name] = operations_per_call(whole->program, f).total();
  } catch (const UnsupportedError&) {  // the scene may leave out what cannot be derived
  }
  return operations;
}

std::string headline(const AnyDerivation& derivation, const Model& model) {
  if (!derivation.tree)
    return derivation.reduction->reduction.ranks.table_I_class(derivation.reduction->reduction.partition);
  return fmt::format(
      "{} bodies, {} coordinates, all driven, reference body {}", model.bodies.size(),
      model.coordinates.size(),
      model.group == GroupKind::fixed ? "fixed" : fmt::format("free in {}", name(model.group)));
}

/// Operations and rounding after each pass, for the route that was kept; passes that change nothing are left
/// out.
void print_passes(const std::vector<PassReport>& trace) {
  fmt::print("\n{:28s} {:28s} {:>10s} {:>9s} {:>9s}\n", "function", "after", "operations", "median", "worst");
  const PassReport* last = nullptr;
  for (const PassReport& p : trace) {
    const bool is_first = last == nullptr || last->function != p.function;
    if (is_first || last->operations != p.operations || last->error.text() != p.error.text())
      fmt::print("{:28s} {:28s} {:>10d} {}\n", is_first ? p.function : "", p.pass, p.operations,
                 p.error.text());
    last = &p;
  }
  fmt::print("median and worst rounding error of {} states, in ulps of the natural scale\n", measured_states);
}

/// What compiling all functions of double takes.
void print_effort(const Program& program, const StatementStyle& style, double seconds) {
  fmt::print("\nderived and emitted in {:.2f} s\n", seconds);
  CompileOptions options;
  options.style = style;
  try {
    const CompileEffort effort = compile_effort(program, options);
    fmt::print("compiled with {} in {:.2f} s of processor time, object of {} bytes\n",
               fmt::join(flags_of(options), " "), effort.seconds, effort.object_bytes);
  } catch (const CompileError& error) {
    fmt::print("not compiled: {}\n", error.what());
  }
}

/// Every formulation that was tried. Passes over the finished program see only the cheapest.
void print_routes(const AnyDerivation& derivation, bool errors) {
  std::size_t width = 5;
  for (const CandidateReport& c : derivation.candidates()) width = std::max(width, c.route.size());
  fmt::print("\n{:28s} {:{}s} {:>10s}{}\n", "function", "route", width, "operations",
             errors ? fmt::format(" {:>9s} {:>9s}", "median", "worst") : "");
  for (const CandidateReport& c : derivation.candidates())
    fmt::print("{:28s} {:{}s} {:>10d}{}{}\n", c.function, c.route, width, c.operations,
               errors ? " " + c.error.text() : "", c.chosen ? "  <- kept" : "");
  if (derivation.tree) {
    for (const std::string& pass : derivation.tree->passes) fmt::print("{}\n", pass);
  }
}

/// One set of functions: of the model, or of a scene and one of its contact sets. Returns the header's file.
std::filesystem::path generate_one(const GenerateOptions& options) {
  const Stopwatch watch;
  const Model model = load_model(options);
  const AnyDerivation derivation = derive_any(options, model);
  const Program& program = derivation.program();
  StatementStyle style;
  if (options.sincos == "batch") style.sincos = SinCos::batch;
  if (options.order == "sections") style.order = NodeOrder::depth_first;
  if (options.order == "lifetimes") style.order = NodeOrder::lifetimes;
  const std::string header = emit_header(program, style);
  const double seconds = watch.seconds();

  std::filesystem::path file = options.output;
  if (file.extension() != ".hpp") {
    const bool standard = program.scene == "standard";
    file /= standard ? program.model + ".hpp" : program.model + "_" + program.scene + ".hpp";
  }
  write_file(file, header);
  if (options.c_abi) {
    write_file(std::filesystem::path(file).replace_extension(".abi.cpp"),
               emit_c_abi(program, file.filename().string()));
    write_file(std::filesystem::path(file).replace_extension(".json"), describe_json(program));
  }

  fmt::print("{} ({}), {}\n", program.model, program.scene, headline(derivation, model));
  for (const std::string& line : kept_terms(model)) fmt::print("{}\n", line);
  const std::map<std::string, int> without_scene = operations_without_scene(options, program);
  const auto compared = [&](const std::string& text) {
    return without_scene.empty() ? "" : fmt::format("{:>13s}", text);
  };
  fmt::print("{:28s} {:>10s}{} {:>8s}  {}\n", "function", "operations", compared("whole model"), "sin+cos",
             "route");
  int operations = 0, operations_before = 0;
  for (const Function& f : program.functions) {
    const OperationCount count = operations_per_call(program, f);
    std::string dearest;
    std::string route;
    int most = 0;
    for (const CandidateReport& c : derivation.candidates()) {
      if (c.function != f.name) continue;
      most = std::max(most, c.operations);
      if (c.chosen) route = c.route;
    }
    if (most > count.total()) dearest = fmt::format(" (dearest route {})", most);
    const auto before = without_scene.find(f.name);
    const bool is_compared = before != without_scene.end();
    if (is_compared) operations += count.total(), operations_before += before->second;
    fmt::print("{:28s} {:>10d}{} {:>8d}  {}{}\n", f.name, count.total(),
               compared(is_compared ? std::to_string(before->second) : "-"), count.trigonometric(), route,
               dearest);
  }
  if (operations_before > 0)
    fmt::print("scene: {} operations where the whole model takes {}, {:.0f} % {}\n", operations,
               operations_before, 100.0 * std::abs(operations_before - operations) / operations_before,
               operations > operations_before ? "more" : "fewer");
  if (options.passes) {
    const AnyDerivation traced = derive_any(options, model, true);
    print_routes(traced, true);
    print_passes(traced.trace());
    print_effort(program, style, seconds);
  } else if (derivation.tree) {
    print_routes(derivation, false);
  }
  fmt::print("wrote {} ({} bytes) in {:.2f} s\n", file.string(), header.size(), seconds);
  return file;
}

/// A path in a rule of make.
std::string in_rule(const std::filesystem::path& path) {
  std::string text;
  for (const char c : std::filesystem::absolute(path).lexically_normal().string()) {
    if (c == ' ' || c == '#') text += '\\';
    if (c == '$') text += '$';
    text += c;
  }
  return text;
}

}  // namespace

int generate(const GenerateOptions& options) {
  const FilesRead read;
  std::vector<std::string> sets{options.contacts};
  if (options.contacts.empty() && !scene_file(options).empty()) {
    const Scene scene = load_scene(options);
    if (!scene.contact_sets.empty()) sets.clear();
    for (const ContactSet& set : scene.contact_sets) sets.push_back(set.name);
  }
  if (sets.size() > 1 && std::filesystem::path(options.output).extension() == ".hpp")
    throw std::invalid_argument(
        "the scene has several contact sets: name a folder, or one set by --contacts");
  std::string rule;
  for (const std::string& set : sets) {
    GenerateOptions one = options;
    one.contacts = set;
    rule += in_rule(generate_one(one)) + (set == sets.back() ? ":" : " ");
  }
  if (options.depfile.empty()) return ok;
  for (const std::filesystem::path& file : read.files()) rule += " \\\n  " + in_rule(file);
  write_file(options.depfile, rule + "\n");
  return ok;
}

}  // namespace anholon::cli
