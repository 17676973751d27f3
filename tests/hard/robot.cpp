// SPDX-License-Identifier: GPL-2.0-or-later
#include "hard/robot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "check/evaluate_recursion.hpp"
#include "describe/mechanise.hpp"
#include "hard/model_file.hpp"
#include "reduce/decompositions.hpp"

namespace anholon::testing {
namespace {

constexpr double eps = 0x1p-53, eps_of_float = 0x1p-24;
constexpr double infinite = std::numeric_limits<double>::infinity();
const std::string function = "forward_dynamics";

/// Largest |a - b| over the largest |b|, of one output; infinite where a is not finite.
template <class S>
double relative_error(const std::vector<S>& a, const std::vector<Exact>& b) {
  Exact error = 0, size = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    Exact value;
    if constexpr (std::is_same_v<S, Exact>) {
      value = a[i];
    } else {
      if (!std::isfinite(a[i])) return infinite;
      value = Exact::from_double(static_cast<double>(a[i]));
    }
    error = std::max(error, abs(value - b[i]));
    size = std::max(size, abs(b[i]));
  }
  if (size.is_zero()) return error.is_zero() ? 0 : infinite;
  return (error / size).to_double();
}

/// The reduced mass matrix, scaled to a unit diagonal: largest eigenvalue by the smallest. Scaled exactly, so
/// that nothing is lost but in the last step, where 60 digits are more than double holds: a condition beyond
/// 1e16 is answered as such.
double scaled_condition(const std::vector<Exact>& M) {
  const auto n = static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(M.size()))));
  if (n < 2) return 1;
  const auto at = [&](Eigen::Index i, Eigen::Index j) { return M[static_cast<std::size_t>(i * n + j)]; };
  if (n == 2) {  // 1 +- c
    const Exact c = abs(at(0, 1)) / sqrt(at(0, 0) * at(1, 1));
    return ((Exact(1) + c) / (Exact(1) - c)).to_double();
  }
  Eigen::MatrixXd scaled(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) scaled(i, j) = (at(i, j) / sqrt(at(i, i) * at(j, j))).to_double();
  }
  const Eigen::VectorXd values = eigenvalues(scaled);
  return values(n - 1) / std::max(values(0), 1e-16);
}

}  // namespace

NamedValues<Exact> exactly(const NamedValues<double>& values) {
  NamedValues<Exact> result;
  for (const auto& [name, list] : values) {
    for (const double x : list) result[name].push_back(Exact::from_double(x));
  }
  return result;
}

Robot::Robot(const std::string& path, const Values& defaults) : model_(model_file(path)) {
  for (const auto& [name, value] : defaults) {
    const auto p = std::ranges::find(model_.parameters, name, &Parameter::name);
    if (p == model_.parameters.end()) throw std::invalid_argument("no parameter " + name);
    p->value = Exact::from_double(value);
  }
  DeriveRequest request;
  request.functions = {function, "reduced_dynamics", "kinematics"};
  derivation_ = derive(model_, request);
  code_ = std::make_unique<CompiledProgram>(derivation_->program);
}

std::string Robot::route() const {
  const auto chosen = std::ranges::find_if(
      derivation_->candidates, [](const CandidateReport& c) { return c.chosen && c.function == function; });
  return chosen == derivation_->candidates.end() ? "" : chosen->route;
}

std::vector<double> Robot::values_of(const Values& parameters) const {
  std::vector<double> values;
  for (const ParameterInfo& p : derivation_->program.parameters) {
    const auto found = parameters.find(p.name);
    values.push_back(found == parameters.end() ? p.value.to_double() : found->second);
  }
  for (const auto& [name, value] : parameters) {
    if (std::ranges::find(derivation_->program.parameters, name, &ParameterInfo::name) ==
        derivation_->program.parameters.end())
      throw std::invalid_argument("no parameter " + name);
  }
  return values;
}

NamedValues<double> Robot::call(const std::string& name, const NamedValues<double>& inputs,
                                const Values& parameters) {
  code_->set_parameters(values_of(parameters));
  const CompiledProgram::Blocks blocks(inputs.begin(), inputs.end());
  const CompiledProgram::Blocks outputs = code_->call(name, blocks);
  return {outputs.begin(), outputs.end()};
}

NamedValues<Exact> Robot::exact(const std::string& name, const NamedValues<Exact>& inputs,
                                const Values& parameters) {
  std::vector<Exact> values;
  for (const double x : values_of(parameters)) values.push_back(Exact::from_double(x));
  return interpreting_caller<Exact>(derivation_->program, values)(name, inputs);
}

std::vector<double> Robot::by_recursion(const NamedValues<double>& inputs,
                                        const std::vector<double>& parameters) const {
  const Partition partition = partition_of(model_);
  const auto n = static_cast<std::size_t>(partition.n);
  const auto components = free_components(model_.group);
  std::vector<Exact> exact_parameters;
  for (const double x : parameters) exact_parameters.push_back(Exact::from_double(x));
  // the velocities that nu and r_a_dot mean, rounded once
  const NamedValues<Exact> means =
      interpreting_caller<Exact>(derivation_->program, exact_parameters)("kinematics", exactly(inputs));
  EvaluationInput<double> input;
  input.has_acceleration = true;
  State<double>& state = input.state;
  state.r.assign(model_.coordinates.size(), 0.0), state.r_dot = state.r;
  input.r_ddot = state.r, input.tau = state.r;
  const auto place = [&](int velocity) { return static_cast<std::size_t>(velocity - partition.n); };
  const auto entry = [&](const char* block, std::size_t i) {
    const auto found = inputs.find(block);
    return found == inputs.end() ? 0.0 : found->second[i];
  };
  if (means.contains("eta")) {
    for (std::size_t i = 0; i < n; ++i) state.eta[components[i]] = means.at("eta")[i].to_double();
  }
  for (std::size_t i = 0; i + n < partition.passive.size(); ++i) {
    const std::size_t at = place(partition.passive[n + i]);
    state.r[at] = entry("r_p", i), state.r_dot[at] = means.at("r_p_dot")[i].to_double();
  }
  for (std::size_t i = 0; i < partition.active.size(); ++i) {
    const std::size_t at = place(partition.active[i]);
    state.r[at] = entry("r_a", i), state.r_dot[at] = entry("r_a_dot", i),
    input.r_ddot[at] = entry("r_a_ddot", i);
  }
  if (inputs.contains("R")) std::ranges::copy(inputs.at("R"), state.R.m.begin());
  if (model_.group == GroupKind::SE2 && inputs.contains("g")) {
    const double theta = inputs.at("g")[2];
    state.p.x = inputs.at("g")[0], state.p.y = inputs.at("g")[1];
    state.R = AxisRotation<double>{2, std::cos(theta), std::sin(theta)}.matrix();
  }
  const Evaluated<double> e =
      evaluate_recursion(mechanise<double>(describe_mechanism(model_), parameters), partition, input, 1e-12);
  std::vector<double> accelerations;
  for (const int i : partition.passive) accelerations.push_back(e.acceleration[static_cast<std::size_t>(i)]);
  return accelerations;
}

void Robot::compare(const NamedValues<double>& inputs, const Values& parameters, Kept& kept, bool with_float,
                    double of_recursion) {
  const WorkingDigits precision(400);  // sums of 1e-300 and 1 keep all their digits
  const std::vector<double> values = values_of(parameters);
  std::vector<Exact> exact_values;
  for (const double x : values) exact_values.push_back(Exact::from_double(x));
  const NamedValues<Exact> in = exactly(inputs);
  const auto at_these = interpreting_caller<Exact>(derivation_->program, exact_values);
  const auto want = at_these(function, in);

  // What a rounding of each input and parameter alone moves.
  std::map<std::string, double> condition;
  const double relative = std::ldexp(1.0, -60);
  const auto add_influence = [&](const NamedValues<Exact>& seen) {
    for (const auto& [name, list] : want) condition[name] += relative_error(seen.at(name), list) / relative;
  };
  const Exact factor = Exact(1) + Exact::from_double(relative);
  for (const auto& [name, list] : in) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      NamedValues<Exact> near = in;
      near[name][i] *= factor;
      add_influence(at_these(function, near));
    }
  }
  for (std::size_t i = 0; i < exact_values.size(); ++i) {
    std::vector<Exact> near = exact_values;
    near[i] *= factor;
    add_influence(interpreting_caller<Exact>(derivation_->program, near)(function, in));
  }
  const double kappa_M = scaled_condition(at_these("reduced_dynamics", in).at("M_r"));

  const auto got = call(function, inputs, parameters);
  for (const auto& [name, list] : want) {
    const double lost = relative_error(got.at(name), list), of_name = condition[name];
    if (lost >= kept.in_double) kept.in_double = lost, kept.kappa = of_name, kept.kappa_M = kappa_M;
    kept.of_bound = std::max(kept.of_bound, lost / std::max(1e-13, 10 * eps * (of_name + kappa_M)));
    kept.of_strict_bound = std::max(kept.of_strict_bound, lost / std::max(1e-13, 10 * eps * of_name));
  }
  std::vector<Exact> accelerations;
  for (const char* name : {"eta_dot", "r_p_ddot"}) {
    const auto found = want.find(name);
    if (found != want.end())
      accelerations.insert(accelerations.end(), found->second.begin(), found->second.end());
  }
  const double error = relative_error(by_recursion(inputs, values), accelerations);
  double kappa = 0;
  for (const auto& [name, value] : condition) kappa = std::max(kappa, value);
  kept.recursion = std::max(kept.recursion, error);
  kept.of_recursion_bound =
      std::max(kept.of_recursion_bound, error / std::max(1e-13, 10 * eps * (kappa + kappa_M + of_recursion)));
  if (!with_float) return;

  NamedValues<float> in_float;
  NamedValues<double> rounded;
  for (const auto& [name, list] : inputs) {
    in_float[name].assign(list.begin(), list.end());
    rounded[name].assign(in_float[name].begin(), in_float[name].end());
  }
  const std::vector<float> float_values(values.begin(), values.end());
  Values rounded_parameters;
  for (std::size_t i = 0; i < float_values.size(); ++i)
    rounded_parameters[derivation_->program.parameters[i].name] = static_cast<double>(float_values[i]);
  const auto got_float = interpreting_caller<float>(derivation_->program, float_values)(function, in_float);
  const auto want_float = exact(function, exactly(rounded), rounded_parameters);
  for (const auto& [name, list] : want_float) {
    const double lost = relative_error(got_float.at(name), list);
    kept.in_float = std::max(kept.in_float, lost);
    // 450 roundings are as good a natural scale here as 1e-13 is for double
    kept.of_float_bound =
        std::max(kept.of_float_bound,
                 lost / std::max(450 * eps_of_float, 10 * eps_of_float * (condition[name] + kappa_M)));
  }
}

}  // namespace anholon::testing
