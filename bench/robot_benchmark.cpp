// SPDX-License-Identifier: GPL-2.0-or-later

// Times of the functions of robots on one core: generated code, the project's recursion in double and the
// other engines that were found at configure time. All take turns within one run, at the same random states
// within the joint limits. Prints a Markdown table for each robot and function; fails if values disagree.
//
//   robot_benchmark [--rounds N] [--orders] [--functions NAME,...] [--fixed NAME]... URDF...

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sched.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "contenders.hpp"
#include "derive/tree_functions.hpp"
#include "optimise/tape/count.hpp"
#include "optimise/tree_loops.hpp"

namespace {

using namespace anholon;
using namespace anholon::bench;

struct Options {
  int rounds = 101;
  bool orders = false;  // compare the orders in which operations may be emitted
  std::vector<std::string> functions = {"inverse_dynamics", "mass_matrix", "forward_dynamics"};
  std::set<std::string> fixed = fixed_bases();
  std::vector<std::string> robots;
};

[[noreturn]] void usage() {
  std::fputs(
      "usage: robot_benchmark [--rounds N] [--orders] [--functions NAME,...] [--fixed NAME]... URDF...\n",
      stderr);
  std::exit(2);
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (!argument.starts_with("--")) {
      options.robots.push_back(argument);
      continue;
    }
    if (argument == "--orders") {
      options.orders = true;
      continue;
    }
    if (++i == argc) usage();
    const std::string value = argv[i];
    if (argument == "--rounds") {
      const auto read = std::from_chars(value.data(), value.data() + value.size(), options.rounds);
      if (read.ec != std::errc() || options.rounds < 1) usage();
    } else if (argument == "--functions") {
      options.functions = split(value);
    } else if (argument == "--fixed") {
      options.fixed.insert(value);
    } else {
      usage();
    }
  }
  if (options.robots.empty()) usage();
  return options;
}

/// One core from here on: the one that the process is on.
void stay_on_one_core() {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(std::max(0, sched_getcpu())), &set);
  sched_setaffinity(0, sizeof set, &set);
}

/// Largest difference between two contenders over some samples, relative to the largest component; infinite
/// where a value is not finite.
double disagreement(const Contender& a, const Contender& b) {
  double worst = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    const std::vector<double> x = a.values(i);
    const std::vector<double> y = b.values(i);
    if (x.size() != y.size()) return INFINITY;
    double scale = 0, difference = 0;
    for (std::size_t j = 0; j < x.size(); ++j) {
      scale = std::max(scale, std::abs(x[j]));
      const double d = std::abs(x[j] - y[j]);
      if (!std::isfinite(d)) return INFINITY;  // std::max would drop not-a-number
      difference = std::max(difference, d);
    }
    if (difference > 0) worst = std::max(worst, difference / scale);  // all zero on both sides: they agree
  }
  return worst;
}

/// The robot's functions with its inertial figures as constants, and as parameters.
struct Programs {
  std::unique_ptr<TreeDerivation> frozen, symbolic;
};

/// Every way to compute one function of one robot; the first is what the others are compared with.
std::vector<Contender> contenders_of(const Robot& robot, const Programs& programs,
                                     const std::string& function, bool orders) {
  StatementStyle batch;
  batch.sincos = SinCos::batch;
  batch.order = NodeOrder::lifetimes;
  const Program& frozen = programs.frozen->program;
  const Program& symbolic = programs.symbolic->program;
  std::vector<Contender> all =
      generated_contenders(robot, frozen, function, "generated, --sincos batch --order lifetimes", batch);
  const auto add = [&](std::vector<Contender> more) {
    for (Contender& c : more) all.push_back(std::move(c));
  };
  StatementStyle plain = batch;
  plain.sincos = SinCos::cmath;
  add(generated_contenders(robot, frozen, function, "generated, --order lifetimes", plain));
  add(generated_contenders(robot, symbolic, function, "the first row's with --symbolic-inertia", batch));
  add(preparation_contenders(robot, symbolic, "its prepare(), once for all functions", batch));
  if (orders) {
    for (const auto& [order, name] : {std::pair(NodeOrder::depth_first, "batch, depth first in sections"),
                                      std::pair(NodeOrder::levels, "batch, by levels in sections")}) {
      batch.order = order;
      add(generated_contenders(robot, frozen, function, name, batch));
    }
  }
  add(recursion_contenders(robot, function));
#ifdef ANHOLON_HAVE_MUJOCO
  add(mujoco_contenders(robot, function));
#endif
#ifdef ANHOLON_HAVE_KDL
  add(kdl_contenders(robot, function));
#endif
#ifdef ANHOLON_HAVE_DART
  add(dart_contenders(robot, function));
#endif
#ifdef ANHOLON_HAVE_SIMBODY
  add(simbody_contenders(robot, function));
#endif
#ifdef ANHOLON_HAVE_PINOCCHIO
  add(pinocchio_contenders(robot, function));
#endif
#ifdef ANHOLON_HAVE_RBDL
  add(rbdl_contenders(robot, function));
#endif
  return all;
}

int operations(const Program& program, const std::string& function) {
  return operations_per_call(program, *std::ranges::find(program.functions, function, &Function::name))
      .total();
}

/// Those of prepare(): of what depends on parameters alone and a function reads.
int preparation(const Program& program) {
  std::vector<NodeId> roots;
  for (const Function& f : program.functions) {
    for (const OutputBlock& b : f.outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  }
  return count_operations(program.tape, roots).total() - operations_per_call(program, roots).total();
}

/// Prints the table of one function. @return whether all values agree
bool compete(const Robot& robot, const Programs& programs, const std::string& function,
             const Options& options) {
  const std::vector<Contender> contenders = contenders_of(robot, programs, function, options.orders);
  const std::vector<Timing> timings = measure(contenders, robot.samples.size(), options.rounds);
  fmt::print("\n### {}, {}: {} operations, {} with symbolic inertia\n\n", robot.name, function,
             operations(programs.frozen->program, function),
             operations(programs.symbolic->program, function));
  fmt::print("| | median ns | quartiles | least | times the generated code | difference |\n");
  fmt::print("| --- | ---: | ---: | ---: | ---: | ---: |\n");
  bool agree = true;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    const Timing& t = timings[i];
    std::string difference;
    if (i > 0 && contenders[i].values) {
      const double d = disagreement(contenders[0], contenders[i]);
      difference = fmt::format("{:.0e}", d);
      agree = agree && d < contenders[i].tolerance;
    }
    fmt::print("| {} | {:.0f} | {:.0f} .. {:.0f} | {:.0f} | {:.2f} | {} |\n", contenders[i].name, t.median,
               t.lower, t.upper, t.least, t.ratio, difference);
  }
  std::fflush(stdout);
  return agree;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  stay_on_one_core();
  fmt::print("Generated code: `c++ {}`.\n", fmt::join(generated_flags(), " "));
  bool agree = true;
  try {
    for (const std::string& file : options.robots) {
      const std::string name = std::filesystem::path(file).stem().string();
      const Robot robot = load_robot(file, !options.fixed.contains(name), 1024);
      TreeRequest request;
      request.functions = options.functions;
      const Programs programs = {derive_tree(robot.model, request), derive_tree(robot.symbolic, request)};
      fmt::print("\n## {}: {} inertial parameters, of which prepare() takes {} operations\n", robot.name,
                 robot.symbolic.parameters.size(), preparation(programs.symbolic->program));
      for (const std::string& function : options.functions)
        agree = compete(robot, programs, function, options) && agree;
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 3;
  }
  if (!agree) std::fputs("robot_benchmark: values disagree\n", stderr);
  return agree ? 0 : 1;
}
