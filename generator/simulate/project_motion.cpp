// SPDX-License-Identifier: GPL-2.0-or-later
#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "check/evaluate_program.hpp"
#include "reduce/elimination.hpp"
#include "reduce/samples.hpp"
#include "simulate/scene_program.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

std::vector<Expr> input_block(Program& program, const std::string& name, const std::string& unit,
                              const std::string& meaning, int size) {
  InputBlock block{name, unit, meaning, size, 1, {}};
  std::vector<Expr> entries;
  for (int i = 0; i < size; ++i) {
    block.nodes.push_back(program.tape.input(name + "[" + std::to_string(i) + "]"));
    entries.emplace_back(program.tape, block.nodes.back());
  }
  program.inputs.push_back(std::move(block));
  return entries;
}

/// C = N^T B_a: the residual of the rates is linear in them.
Matrix<Expr> condition_matrix(Program& program, const OutputBlock& residual, const InputBlock& r_a_dot) {
  Matrix<Expr> C(residual.rows, r_a_dot.rows);
  for (int j = 0; j < C.cols(); ++j) {
    const auto column =
        directional_derivative(program.tape, residual.nodes,
                               {{r_a_dot.nodes[static_cast<std::size_t>(j)], program.tape.constant(1)}});
    for (int i = 0; i < C.rows(); ++i) C(i, j) = Expr(program.tape, column[static_cast<std::size_t>(i)]);
  }
  return C;
}

/// Rows of C that are independent at a random configuration: rows that are redundant altogether give zero or
/// dependent conditions.
std::vector<int> independent_conditions(const SceneProgram& p, const Matrix<Expr>& C) {
  constexpr double zero = 1e-9;  // of the size that is left of ordinary rows
  Program& program = p.derivation->program;
  std::vector<NodeId> nodes;
  for (const Expr& e : C.entries()) nodes.push_back(e.id(program.tape));
  SampleSource source;
  const State<Exact> state = random_state(p.model, source);
  std::vector<double> inputs(program.tape.inputs().size(), 0.0), values(nodes.size());
  for (const ParameterInfo& parameter : program.parameters)
    inputs[program.tape.node(parameter.node).a] = parameter.value.to_double();
  for (const auto& [name, block] : position_inputs(p.model, p.original, state)) {
    const auto found = std::ranges::find(program.inputs, name, &InputBlock::name);
    for (std::size_t i = 0; found != program.inputs.end() && i < found->nodes.size(); ++i)
      inputs[program.tape.node(found->nodes[i]).a] = block[i].to_double();
  }
  Interpreter<double>(program.tape, nodes)(inputs, values);
  std::vector<Eigen::VectorXd> basis;
  std::vector<int> chosen;
  for (int i = 0; i < C.rows(); ++i) {
    Eigen::VectorXd row = Eigen::Map<const Eigen::VectorXd>(values.data() + i * C.cols(), C.cols());
    const double size = row.norm();
    for (const Eigen::VectorXd& b : basis) row -= b * b.dot(row);
    if (!(row.norm() > zero * std::max(size, zero))) continue;
    basis.push_back(row.normalized());
    chosen.push_back(i);
  }
  return chosen;
}

}  // namespace

void add_projection(SceneProgram& p) {
  Program& program = p.derivation->program;
  const Function* compatibility = find_function(program, "compatibility");
  const auto r_a_dot = std::ranges::find(program.inputs, "r_a_dot", &InputBlock::name);
  if (compatibility == nullptr || r_a_dot == program.inputs.end()) return;
  const auto residual = std::ranges::find(compatibility->outputs, "velocity_residual", &OutputBlock::name);
  const int size = r_a_dot->rows;
  const Matrix<Expr> all = condition_matrix(program, *residual, *r_a_dot);
  std::vector<int> columns;
  for (int j = 0; j < size; ++j) columns.push_back(j);
  const Matrix<Expr> C = all.block(independent_conditions(p, all), columns);
  const std::vector<Expr> wanted =
      input_block(program, "r_m_dot", "rad/s or m/s", "wanted rates of r_a", size);
  const std::vector<Expr> wanted_change =
      input_block(program, "r_m_ddot", "rad/s^2 or m/s^2", "their derivatives", size);
  const Matrix<Expr> Ct = C.transposed();
  const std::vector<Expr> mu = solve_symmetric(C * Ct, {C * wanted}).front();
  const std::vector<Expr> step = Ct * mu;
  std::vector<NodeId> rates;
  for (int i = 0; i < size; ++i)
    rates.push_back(
        (wanted[static_cast<std::size_t>(i)] - step[static_cast<std::size_t>(i)]).id(program.tape));
  program.functions.push_back({"projected_rates",
                               "The compatible rates that are nearest to the wanted ones.",
                               {{"r_a_dot", "rad/s or m/s", "rates of r_a", size, 1, rates}},
                               ""});
  for (std::size_t c = 0; c < p.derivation->rates.size(); ++c) {
    auto motion = p.derivation->rates[c];
    for (std::size_t i = 0; i < wanted.size(); ++i)
      motion.emplace_back(wanted[i].id(program.tape), wanted_change[i].id(program.tape));
    program.functions.push_back({chart_prefix(c) + "projected_accelerations",
                                 "Time derivatives of the compatible rates.",
                                 {{"r_a_ddot", "rad/s^2 or m/s^2", "second derivatives of r_a", size, 1,
                                   directional_derivative(program.tape, rates, motion)}},
                                 ""});
  }
  p.projects_motion = true;
}

}  // namespace anholon
