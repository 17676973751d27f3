// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/evaluate_program.hpp"

#include <algorithm>

#include "check/evaluate_recursion.hpp"

namespace anholon {

template <class S>
Evaluated<S> evaluate_program(const Model& model, const Derivation& derivation, const ProgramCaller<S>& call,
                              const EvaluationInput<S>& input) {
  const Program& program = derivation.program;
  const Partition partition = partition_of(model);
  const int n = partition.n;
  const int size = n + static_cast<int>(model.coordinates.size());
  NamedValues<S> in = position_inputs(model, partition, input.state);
  const auto components = free_components(model.group);
  for (const int c : components) in["eta"].push_back(input.state.eta[c]);
  for (auto i = static_cast<std::size_t>(n); i < partition.passive.size(); ++i)
    in["r_p_dot"].push_back(input.state.r_dot[static_cast<std::size_t>(partition.passive[i] - n)]);
  for (const int i : partition.active) {
    const auto a = static_cast<std::size_t>(i - n);
    in["r_a_dot"].push_back(input.state.r_dot[a]);
    in["r_a_ddot"].push_back(input.has_acceleration ? input.r_ddot[a] : S(0));
    in["tau_a"].push_back(input.has_torque ? input.tau[a] : S(0));
  }
  const std::size_t chart = chart_finder<S>(derivation)(in);
  const std::size_t torque_driven_chart = chart_finder<S>(derivation, "torque_driven_")(in);
  const auto run = [&](const std::string& name) {
    const std::string of_chart =
        chart_prefix(name.starts_with("torque_driven_") ? torque_driven_chart : chart) + name;
    if (find_function(program, of_chart) != nullptr) return call(of_chart, in);
    return find_function(program, name) != nullptr ? call(name, in) : NamedValues<S>{};
  };
  const auto matrix = [](const NamedValues<S>& out, const std::string& name, int rows, int cols) {
    Matrix<S> m(rows, cols);
    const auto found = out.find(name);
    if (found == out.end()) return m;
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) m(i, j) = found->second[static_cast<std::size_t>(i * cols + j)];
    }
    return m;
  };
  const auto get = [](const NamedValues<S>& out, const std::string& name) {
    const auto found = out.find(name);
    return found == out.end() ? std::vector<S>{} : found->second;
  };
  std::vector<int> eta, r_p(partition.passive.begin() + n, partition.passive.end());
  for (int i = 0; i < n; ++i) eta.push_back(i);
  const std::vector<int>& r_a = partition.active;

  Evaluated<S> e;
  e.least_norm = derivation.reduction.inverse == Inverse::pseudo;
  e.M = Matrix<S>(size, size);
  const NamedValues<S> free = run("free_dynamics");
  const auto place = [&](const std::string& name, const std::vector<int>& rows,
                         const std::vector<int>& cols) {
    const Matrix<S> m = matrix(free, name, static_cast<int>(rows.size()), static_cast<int>(cols.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t j = 0; j < cols.size(); ++j)
        e.M(rows[i], cols[j]) = e.M(cols[j], rows[i]) = m(static_cast<int>(i), static_cast<int>(j));
    }
  };
  place("M_eta_eta", eta, eta), place("M_p", r_p, eta), place("M_a", r_a, eta);
  place("m_pp", r_p, r_p), place("m_pa", r_p, r_a), place("m_aa", r_a, r_a);
  const auto scatter_into = [&](std::vector<S>& to, const std::vector<S>& from, const std::vector<int>& at) {
    for (std::size_t i = 0; i < from.size(); ++i) to[static_cast<std::size_t>(at[i])] = from[i];
  };
  e.force.assign(static_cast<std::size_t>(size), S(0));
  scatter_into(e.force, get(free, "f"), eta), scatter_into(e.force, get(free, "Q_p"), r_p),
      scatter_into(e.force, get(free, "Q_a"), r_a);

  const int rows = static_cast<int>(model.rows.size());
  const NamedValues<S> constraints = run("constraints");
  e.G = Matrix<S>(rows, size);
  const auto place_columns = [&](const std::string& name, const std::vector<int>& cols) {
    const Matrix<S> m = matrix(constraints, name, rows, static_cast<int>(cols.size()));
    for (int i = 0; i < rows; ++i) {
      for (std::size_t j = 0; j < cols.size(); ++j) e.G(i, cols[j]) = m(i, static_cast<int>(j));
    }
  };
  place_columns("A", eta), place_columns("B_p", r_p), place_columns("B_a", r_a);
  e.bias = get(constraints, "bias");

  const int passive = static_cast<int>(partition.passive.size());
  const int k = derivation.reduction.kernel.H.cols();
  e.nu = in["nu"] = get(run("reduced_velocities"), "nu");
  const NamedValues<S> kinematics = run("kinematics");
  e.H = matrix(kinematics, "H", passive, k);
  e.J = matrix(kinematics, "J", passive, partition.s_a());
  e.basis = derivation.reduction.charts[chart].description;
  if (k > 0) {
    e.projector = range_projector(e.H);
  } else {
    e.projector = Matrix<S>(passive, passive);
  }
  const NamedValues<S> energies = run("energies");
  const auto energy = [&](const char* name) {
    const auto v = get(energies, name);
    return v.empty() ? S(0) : v[0];
  };
  e.kinetic = energy("kinetic"), e.gravity = energy("gravity"), e.elastic = energy("elastic"),
  e.dissipated_power = energy("dissipated_power");

  const bool passive_alone = partition.s_a() == 0;  // then the motion is the same, whatever is given
  if (input.has_acceleration || (input.has_torque && passive_alone)) {
    const NamedValues<S> reduced = run("reduced_dynamics");
    e.M_r = matrix(reduced, "M_r", k, k);
    e.f_r = get(reduced, "f_r");
    const NamedValues<S> forward = run("forward_dynamics");
    e.nu_dot = in["nu_dot"] = get(forward, "nu_dot");
    e.acceleration.assign(static_cast<std::size_t>(size), S(0));
    scatter_into(e.acceleration, get(forward, "eta_dot"), eta);
    scatter_into(e.acceleration, get(forward, "r_p_ddot"), r_p);
    scatter_into(e.acceleration, in["r_a_ddot"], r_a);
    const auto& stat = std::ranges::find(program.inputs, "lambda_stat", &InputBlock::name);
    if (stat != program.inputs.end()) {
      in["lambda_stat"] = input.lambda_stat;
      if (input.lambda_stat.empty()) in["lambda_stat"].assign(stat->nodes.size(), S(0));
    }
    e.tau_a = get(run("inverse_torques"), "tau_a");
    e.lambda = get(run("multipliers"), "lambda");
  }
  if (input.has_torque && passive_alone) {
    e.free_acceleration = e.acceleration;
    e.free_lambda = e.lambda;
  } else if (input.has_torque) {
    in["w"] = get(run("torque_driven_velocities"), "w");
    const NamedValues<S> forward = run("torque_driven_dynamics");
    in["w_dot"] = get(forward, "w_dot");
    e.free_acceleration.assign(static_cast<std::size_t>(size), S(0));
    scatter_into(e.free_acceleration, get(forward, "eta_dot"), eta);
    scatter_into(e.free_acceleration, get(forward, "r_p_ddot"), r_p);
    scatter_into(e.free_acceleration, get(forward, "r_a_ddot"), r_a);
    e.free_lambda = get(run("torque_driven_multipliers"), "lambda");
  }
  return e;
}

template Evaluated<double> evaluate_program(const Model&, const Derivation&, const ProgramCaller<double>&,
                                            const EvaluationInput<double>&);
template Evaluated<Exact> evaluate_program(const Model&, const Derivation&, const ProgramCaller<Exact>&,
                                           const EvaluationInput<Exact>&);

}  // namespace anholon
