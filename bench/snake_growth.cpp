// SPDX-License-Identifier: GPL-2.0-or-later
//
// How the dynamics of a wheeled snake with passive joints grow with its links: operations of the chosen route
// and of the plain one, (66)-(68), time of generation, time of a call, and the exponents fitted to them.
//
//   snake_growth [LINKS...]      default 3 5 10 20 30
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "check/compile_cache.hpp"
#include "derive/derive.hpp"
#include "describe/read_model.hpp"

namespace {

using namespace anholon;

std::string snake(int links) {
  std::string text = R"(anholon = 1
name  = "snake"
group = "SE2"
[parameters]
m = { value = 0.4, unit = "kg" }
J = { value = 1e-3, unit = "kg m^2" }
l = { value = 0.1, unit = "m" }
[[body]]
name = "link_1"
inertia = { mass = "m", about_com = { zz = "J" } }
[[constraint]]
kind = "no_lateral_slip"
body = "link_1"
)";
  for (int i = 2; i <= links; ++i) {
    text += fmt::format(
        "[[body]]\nname = \"link_{0}\"\nparent = \"link_{1}\"\npose = {{ translation = [\"{2}\", 0, 0] }}\n"
        "joint = {{ kind = \"revolute\", axis = [0, 0, 1], coordinate = \"r{1}\", range = [-1, 1] }}\n"
        "inertia = {{ mass = \"m\", com = [\"-l\", 0, 0], about_com = {{ zz = \"J\" }} }}\n"
        "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"link_{0}\"\npoint = [\"-l\", 0, 0]\n",
        i, i - 1, i == 2 ? "-l" : "-2*l");
  }
  return text;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Least of several rounds, ns a call.
double time_of_a_call(const Program& program) {
  CompiledProgram code(program);
  const anholon_function& function = code.function("forward_dynamics");
  std::vector<std::vector<double>> in, out;
  std::vector<const double*> inputs;
  std::vector<double*> outputs;
  const auto size = [](const anholon_block& b) {
    return static_cast<std::size_t>(b.rows) * static_cast<std::size_t>(b.cols);
  };
  for (int i = 0; i < function.input_count; ++i) {
    std::vector<double>& values = in.emplace_back(size(function.inputs[i]));
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = 0.3 + 0.1 * std::sin(static_cast<double>(k));
  }
  for (int i = 0; i < function.output_count; ++i) out.emplace_back(size(function.outputs[i]));
  for (const auto& x : in) inputs.push_back(x.data());
  for (auto& x : out) outputs.push_back(x.data());
  double least = 1e9;
  for (int round = 0; round < 20; ++round) {
    constexpr int calls = 2000;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < calls; ++i) code.call(function, inputs.data(), outputs.data());
    least = std::min(least, 1e9 * seconds_since(start) / calls);
  }
  return least;
}

/// Slope of log y over log x.
double exponent(const std::vector<double>& x, const std::vector<double>& y) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(x.size()), 2);
  Eigen::VectorXd b(static_cast<Eigen::Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) {
    A.row(static_cast<Eigen::Index>(i)) << std::log(x[i]), 1;
    b(static_cast<Eigen::Index>(i)) = std::log(y[i]);
  }
  return A.colPivHouseholderQr().solve(b)(0);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> sizes;
  for (int i = 1; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
  if (sizes.empty()) sizes = {3, 5, 10, 20, 30};
  if (std::ranges::any_of(sizes, [](int n) { return n < 3 || n > 100; })) {
    fmt::print(stderr, "usage: snake_growth [LINKS...], each 3 to 100\n");
    return 2;
  }
  fmt::print(
      "| links | operations | plain route | generation s | ns a call |\n| --- | --- | --- | --- | --- |\n");
  std::vector<double> links, operations, plain, generation, call;
  for (const int n : sizes) {
    const auto start = std::chrono::steady_clock::now();
    const Model model = read_model_text(snake(n), "snake.toml");
    DeriveRequest request;
    request.functions = {"forward_dynamics"};
    request.closed_forms = false;
    const auto derivation = derive(model, request);
    generation.push_back(seconds_since(start));
    links.push_back(n);
    for (const CandidateReport& c : derivation->candidates) {
      if (c.chosen) operations.push_back(c.operations);
      if (c.route.starts_with("all blocks")) plain.push_back(c.operations);
    }
    call.push_back(time_of_a_call(derivation->program));
    fmt::print("| {} | {} | {} | {:.2f} | {:.0f} |\n", n, operations.back(), plain.back(), generation.back(),
               call.back());
  }
  if (sizes.size() > 1)
    fmt::print("| exponent | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", exponent(links, operations),
               exponent(links, plain), exponent(links, generation), exponent(links, call));
  return 0;
}
