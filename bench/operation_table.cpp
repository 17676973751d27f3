// SPDX-License-Identifier: GPL-2.0-or-later

// Operations of the functions of every robot in a folder of URDF and model files: additions, multiplications
// and divisions together, sines and cosines apart. A URDF file has a free base unless its name is one of
// fixed_bases() or is given by --fixed.
//
//   operation_table [--routes | --passes | --symbolic] [--fixed NAME]... FOLDER
//
// --routes adds the formulations that were tried, --passes the operations after each pass; --symbolic
// compares frozen inertial figures with symbolic ones, whose operations are those of one call.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "derive/tree_functions.hpp"
#include "describe/read_model.hpp"
#include "describe/read_robot.hpp"
#include "optimise/tree_loops.hpp"
#include "robot.hpp"

namespace {

using namespace anholon;

/// Operations of one call; -1 where the robot has no such function.
int operations(const TreeDerivation& derivation, const std::string& name, int* angles = nullptr) {
  const auto function = std::ranges::find(derivation.program.functions, name, &Function::name);
  if (function == derivation.program.functions.end()) return -1;
  const OperationCount count = operations_per_call(derivation.program, *function);
  if (angles != nullptr) *angles = std::max(*angles, count.trigonometric());
  return count.total();
}

void print_counts(const std::string& robot, const TreeDerivation& derivation, double seconds) {
  fmt::print("| {} |", robot);
  int angles = 0;
  for (const std::string& name : standard_tree_functions())
    fmt::print(" {} |", operations(derivation, name, &angles));
  fmt::print(" {} | {:.2f} |\n", angles, seconds);
}

void print_ratios(const std::string& robot, const TreeDerivation& frozen, const TreeDerivation& symbolic) {
  fmt::print("| {} |", robot);
  for (const std::string& name : standard_tree_functions()) {
    const int f = operations(frozen, name);
    const int s = operations(symbolic, name);
    fmt::print(" {} / {} ({:+.1f} %) |", f, s, 100.0 * (s - f) / f);
  }
  fmt::print(" {} |\n", symbolic.program.parameters.size());
}

struct Options {
  bool routes = false, passes = false, symbolic = false;
  std::set<std::string> fixed = bench::fixed_bases();
  std::string folder;
};

[[noreturn]] void usage() {
  std::fputs("usage: operation_table [--routes | --passes | --symbolic] [--fixed NAME]... FOLDER\n", stderr);
  std::exit(2);
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--routes") {
      options.routes = true;
    } else if (argument == "--passes") {
      options.passes = true;
    } else if (argument == "--symbolic") {
      options.symbolic = true;
    } else if (argument == "--fixed" && i + 1 < argc) {
      options.fixed.insert(argv[++i]);
    } else if (!argument.starts_with("--") && options.folder.empty()) {
      options.folder = argument;
    } else {
      usage();
    }
  }
  if (options.folder.empty()) usage();
  return options;
}

/// URDF and model files of a folder, by name.
std::vector<std::filesystem::path> files_of(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".urdf" || entry.path().extension() == ".toml")
      files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  const auto [routes, passes, symbolic, fixed, folder] = read_options(argc, argv);
  std::vector<std::filesystem::path> files;
  try {
    files = files_of(folder);
  } catch (const std::filesystem::filesystem_error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 3;
  }

  fmt::print("| robot |");
  for (const std::string& name : standard_tree_functions()) fmt::print(" {} |", name);
  const std::vector<std::string> more =
      symbolic ? std::vector<std::string>{"parameters"} : std::vector<std::string>{"sin + cos", "s"};
  for (const std::string& name : more) fmt::print(" {} |", name);
  fmt::print("\n|---|");
  for (std::size_t i = 0; i < standard_tree_functions().size() + more.size(); ++i) fmt::print("---:|");
  fmt::print("\n");
  int status = 0;
  for (const auto& file : files) {
    try {
      RobotOptions options;
      options.floating = !fixed.contains(file.stem().string());
      TreeRequest request;
      request.trace = passes;
      const auto derive_file = [&] {
        return derive_tree(file.extension() == ".urdf" ? read_robot(file, options) : read_model(file),
                           request);
      };
      const auto start = std::chrono::steady_clock::now();
      const auto derivation = derive_file();
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      if (symbolic) {
        options.symbolic_inertia = true;
        print_ratios(file.stem().string(), *derivation, *derive_file());
      } else {
        print_counts(file.stem().string(), *derivation, elapsed.count());
      }
      for (const PassReport& p : derivation->trace)
        fmt::print("    {:6} {}: {}\n", p.operations, p.function, p.pass);
      if (!routes) continue;
      for (const CandidateReport& c : derivation->candidates)
        fmt::print("    {} {:6} {}: {}\n", c.chosen ? '*' : ' ', c.operations, c.function, c.route);
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
      status = 1;
    }
  }
  return status;
}
