// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>

#include <filesystem>

#include "cli/common.hpp"
#include "emit/c_abi.hpp"
#include "emit/header.hpp"
#include "emit/write_file.hpp"
#include "optimise/tape/count.hpp"

namespace anholon::cli {

int generate(const GenerateOptions& options) {
  const Stopwatch watch;
  const Model model = load_model(options);
  const auto derivation = derive(model, derive_request(options, model));
  const Program& program = derivation->program;
  const std::string header = emit_header(program);

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

  fmt::print("{} ({}), {}\n", program.model, program.scene,
             derivation->reduction.ranks.table_I_class(derivation->reduction.partition));
  fmt::print("{:28s} {:>10s} {:>8s}  {}\n", "function", "operations", "sin+cos", "route");
  for (const Function& f : program.functions) {
    std::vector<NodeId> roots;
    for (const OutputBlock& b : f.outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
    const OperationCount count = operations_per_call(program, roots);
    std::string before;
    std::string route;
    int most = 0;
    for (const CandidateReport& c : derivation->candidates) {
      if (c.function != f.name) continue;
      most = std::max(most, c.operations);
      if (c.chosen) route = c.route;
    }
    if (most > count.total()) before = fmt::format(" (dearest route {})", most);
    fmt::print("{:28s} {:>10d} {:>8d}  {}{}\n", f.name, count.total(), count.trigonometric(), route, before);
  }
  if (options.passes) {
    fmt::print("\n{:28s} {:32s} {:>10s}\n", "function", "route", "operations");
    for (const CandidateReport& c : derivation->candidates)
      fmt::print("{:28s} {:32s} {:>10d}{}\n", c.function, c.route, c.operations, c.chosen ? "  <- kept" : "");
  }
  fmt::print("wrote {} ({} bytes) in {:.2f} s\n", file.string(), header.size(), watch.seconds());
  return ok;
}

}  // namespace anholon::cli
