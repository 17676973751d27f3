// SPDX-License-Identifier: GPL-2.0-or-later
#include "report/timing.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "check/compile_cache.hpp"
#include "emit/embedded.hpp"
#include "emit/header.hpp"
#include "emit/plan.hpp"
#include "emit/provenance.hpp"
#include "emit/template.hpp"

namespace anholon {
namespace {

using nlohmann::json;
using Nanoseconds = double (*)(int function, int is_float, const double* states, int count);

CallTime call_time(std::vector<double> times) {
  std::ranges::sort(times);
  const auto at = [&](double part) {
    return times[static_cast<std::size_t>(part * static_cast<double>(times.size() - 1))];
  };
  return {at(0.5), times.front(), at(0.75) - at(0.25)};
}

}  // namespace

std::string emit_timing(const Program& program) {
  const EmissionPlan plan = plan_emission(program);
  std::vector<int> offsets;
  int stride = 0, most_outputs = 1;
  for (const InputBlock& block : program.inputs) {
    offsets.push_back(stride);
    stride += block.rows * block.cols;
  }
  json functions = json::array();
  for (const PlannedFunction& f : plan.functions) {
    json inputs = json::array(), outputs = json::array();
    for (const std::size_t i : f.inputs)
      inputs.push_back({{"size", program.inputs[i].rows * program.inputs[i].cols}, {"offset", offsets[i]}});
    int next = 0;
    for (const PlannedOutput& output : f.outputs) {
      const int size = output.block->rows * output.block->cols;
      outputs.push_back({{"size", size}, {"offset", next}});
      next += size;
    }
    most_outputs = std::max(most_outputs, next);
    functions.push_back({{"name", f.name},
                         {"qualified", (f.scope.empty() ? "" : f.scope + "::") + f.unqualified},
                         {"inputs", inputs},
                         {"outputs", outputs}});
  }
  return fill_template(embedded::timing_template,
                       {{"version", std::string(generator_version())},
                        {"model", one_line(program.model)},
                        {"name_space", fmt::format("{}", fmt::join(plan.name_space, "::"))},
                        {"functions", functions},
                        {"stride", stride},
                        {"outputs", most_outputs}});
}

std::vector<FunctionTime> time_functions(const Program& program, const std::vector<double>& states,
                                         int rounds, const StatementStyle& style) {
  CompileOptions options;
  options.style = style;
  const CompiledFile file = compile_cached(emit_header(program, style), emit_timing(program), options);
  const std::unique_ptr<void, int (*)(void*)> library(::dlopen(file.library.c_str(), RTLD_NOW | RTLD_LOCAL),
                                                      ::dlclose);
  if (library == nullptr) throw CompileError(fmt::format("cannot load compiled code: {}", ::dlerror()));
  const auto nanoseconds = reinterpret_cast<Nanoseconds>(::dlsym(library.get(), "anholon_nanoseconds"));
  if (nanoseconds == nullptr)
    throw CompileError(fmt::format("'{}' holds no anholon_nanoseconds", file.library.string()));

  std::size_t stride = 0;
  for (const InputBlock& block : program.inputs)
    stride += static_cast<std::size_t>(block.rows) * static_cast<std::size_t>(block.cols);
  const int count = stride == 0 ? 1 : static_cast<int>(states.size() / stride);
  const EmissionPlan plan = plan_emission(program);
  std::vector<std::vector<double>> by_double(plan.functions.size()), by_float(plan.functions.size());
  for (int round = -1; round < rounds; ++round) {  // the first one warms up
    for (std::size_t f = 0; f < plan.functions.size(); ++f) {
      const double d = nanoseconds(static_cast<int>(f), 0, states.data(), count);
      const double s = nanoseconds(static_cast<int>(f), 1, states.data(), count);
      if (round < 0) continue;
      by_double[f].push_back(d), by_float[f].push_back(s);
    }
  }
  std::vector<FunctionTime> times;
  for (std::size_t f = 0; f < plan.functions.size(); ++f)
    times.push_back({plan.functions[f].function->name, call_time(by_double[f]), call_time(by_float[f])});
  return times;
}

}  // namespace anholon
