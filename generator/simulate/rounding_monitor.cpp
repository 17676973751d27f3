// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/rounding_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "check/evaluate_program.hpp"
#include "check/relative_condition.hpp"

namespace anholon {
namespace {

constexpr unsigned monitor_digits = 60;
constexpr double infinite = std::numeric_limits<double>::infinity();
const char* const of_parameters = "parameters";  // no block of inputs has this name

}  // namespace

RoundingLoss rounding_loss(const SceneProgram& program, Runner<double>& run) {
  RoundingLoss loss;
  loss.t = run.b.t[0];
  if (!run.rates || run.b.nu.empty()) return loss;
  run.rates();
  const Program& code = program.derivation->program;
  const std::string function = chart_prefix(run.chart()) + "rates";
  const auto is_finite = [](double x) { return std::isfinite(x); };
  NamedValues<Exact> in;
  for (const InputBlock& block : code.inputs) {
    const std::vector<double>& values = run.b[block.name];
    if (values.size() != block.nodes.size()) continue;  // nothing reads it
    if (!std::ranges::all_of(values, is_finite)) return {loss.t, infinite, 0};
    for (const double x : values) in[block.name].push_back(Exact::from_double(x));
  }
  std::vector<Exact>& parameters = in[of_parameters];  // there also where the program has none
  for (const ParameterInfo& p : code.parameters)
    parameters.push_back(Exact::from_double(p.value.to_double()));

  const WorkingDigits precision(monitor_digits);
  const auto accelerations = [&](const NamedValues<Exact>& at) {
    return interpreting_caller<Exact>(code, at.at(of_parameters))(function, at).at("nu_dot");
  };
  try {
    const std::vector<Exact> want = accelerations(in);
    double error = 0, size = std::numeric_limits<double>::min();
    for (std::size_t i = 0; i < want.size(); ++i) {
      const double got = run.b.nu_dot[i];
      error = std::max(error, is_finite(got) ? abs(Exact::from_double(got) - want[i]).to_double() : infinite);
      size = std::max(size, std::abs(want[i].to_double()));
    }
    loss.error = error / size;
    if (loss.error > RoundingLoss::large)
      loss.least = relative_condition(accelerations, in, size) * std::numeric_limits<double>::epsilon() / 2;
  } catch (const std::domain_error&) {  // a quotient by zero, exactly: no rounding makes it one
    loss.error = loss.least = infinite;
  }
  return loss;
}

}  // namespace anholon
