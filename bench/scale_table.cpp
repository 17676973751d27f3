// SPDX-License-Identifier: GPL-2.0-or-later

// How generation grows with the robot: operations, processor time and memory for chains of 10 to 500 links,
// and for one robot the time of all its functions and of compiling them.
//
//   scale_table                 chains
//   scale_table [--fixed] FILE  a URDF file: generation of every function, and g++ -O2 of the header

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "derive/tree_functions.hpp"
#include "describe/read_robot.hpp"
#include "emit/c_abi.hpp"
#include "emit/header.hpp"
#include "optimise/tree_loops.hpp"
#include "urdf/chain.hpp"

namespace anholon {
namespace {

double seconds(int who) {
  rusage used{};
  getrusage(who, &used);
  const auto of = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return of(used.ru_utime) + of(used.ru_stime);
}
long megabytes() {  // the most that the program held so far
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss / 1024;
}

/// Slope of log y over log x between the first and the last entry.
double exponent(const std::map<int, double>& y) {
  return std::log(y.rbegin()->second / y.begin()->second) /
         std::log(static_cast<double>(y.rbegin()->first) / y.begin()->first);
}

/// One table: the functions together at each length, and the exponent of operations and of time.
void chains(const std::vector<std::string>& functions, const std::vector<int>& lengths) {
  std::map<std::string, std::map<int, double>> operations;
  std::map<int, double> time;
  fmt::print("| links |");
  for (const std::string& name : functions) fmt::print(" {} |", name);
  fmt::print(" derive and emit, s | MB |\n|---:|");
  for (std::size_t i = 0; i < functions.size() + 2; ++i) fmt::print("---:|");
  fmt::print("\n");
  for (const int n : lengths) {
    const Model model = read_robot_text(testing::chain(n), "chain.urdf");
    TreeRequest request;
    request.functions = functions;
    const double start = seconds(RUSAGE_SELF);
    const auto derivation = derive_tree(model, request);
    const std::string header = emit_header(derivation->program);
    time[n] = seconds(RUSAGE_SELF) - start;
    fmt::print("| {} |", n);
    for (const std::string& name : functions) {
      const auto f = std::ranges::find(derivation->program.functions, name, &Function::name);
      operations[name][n] = operations_per_call(derivation->program, *f).total();
      fmt::print(" {} |", operations[name][n]);
    }
    fmt::print(" {:.2f} | {} |\n", time[n], megabytes());
    std::fflush(stdout);
  }
  fmt::print("| exponent |");
  for (const std::string& name : functions) fmt::print(" {:.2f} |", exponent(operations[name]));
  fmt::print(" {:.2f} | |\n\n", exponent(time));
}

void robot(const std::filesystem::path& file, bool fixed) {
  RobotOptions options;
  options.floating = !fixed;
  TreeRequest request;
  request.functions = tree_function_names();
  double start = seconds(RUSAGE_SELF);
  const auto derivation = derive_tree(read_robot(file, options), request);
  const double derived = seconds(RUSAGE_SELF) - start;
  start = seconds(RUSAGE_SELF);
  const std::string header = emit_header(derivation->program);
  const double emitted = seconds(RUSAGE_SELF) - start;
  fmt::print("| function | operations |\n|---|---:|\n");
  for (const Function& f : derivation->program.functions)
    fmt::print("| {} | {} |\n", f.name, operations_per_call(derivation->program, f).total());
  fmt::print("\nderived in {:.2f} s, emitted in {:.2f} s: {} kB, at most {} MB of memory\n", derived, emitted,
             header.size() / 1000, megabytes());
  std::fflush(stdout);

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("anholon-scale-{}", getpid());
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "robot.hpp") << header;
  std::ofstream(folder / "robot.cpp")
      << emit_c_abi(derivation->program, "robot.hpp");  // all functions, of double
  start = seconds(RUSAGE_CHILDREN);
  const std::string command =
      fmt::format("g++ -std=c++17 -O2 -I '{}' -c '{}' -o '{}'", ANHOLON_RUNTIME_INCLUDE,
                  (folder / "robot.cpp").string(), (folder / "robot.o").string());
  const int status = std::system(command.c_str());
  const double compiled = seconds(RUSAGE_CHILDREN) - start;
  if (status != 0) throw std::runtime_error("the compiler failed: " + command);
  fmt::print("g++ -O2: {:.2f} s, object of {} kB\n", compiled,
             std::filesystem::file_size(folder / "robot.o") / 1000);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace anholon

int main(int argc, char** argv) {
  using namespace anholon;
  try {
    if (argc == 1) {
      chains({"inverse_dynamics", "bias_forces", "gravity_forces", "forward_kinematics", "forward_dynamics"},
             {10, 20, 50, 100, 200, 500});
      chains({"mass_matrix", "jacobians", "centroidal_momentum"}, {10, 20, 50, 100, 200});
      return 0;
    }
    const bool fixed = std::string(argv[1]) == "--fixed";
    if (argc != (fixed ? 3 : 2)) throw std::invalid_argument("usage: scale_table [[--fixed] FILE]");
    robot(argv[argc - 1], fixed);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
