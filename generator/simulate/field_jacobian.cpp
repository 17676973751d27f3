// SPDX-License-Identifier: GPL-2.0-or-later
// The Jacobian of the field that an integrator sees: state_jacobian of the program, torques that answer to
// the state, and the quadratures of work and dissipated energy.
#include <algorithm>
#include <string>

#include "optimise/tape/count.hpp"
#include "simulate/scene_program.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

std::vector<NodeId> input_of(const Program& program, const std::string& block) {
  const auto found = std::ranges::find(program.inputs, block, &InputBlock::name);
  return found == program.inputs.end() ? std::vector<NodeId>{} : found->nodes;
}

OutputBlock part(Tape& tape, const std::string& name, const Matrix<Expr>& m, int first, int columns) {
  OutputBlock block{name, "mixed", "of the field", m.rows(), columns, {}};
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = first; j < first + columns; ++j) block.nodes.push_back(m(i, j).id(tape));
  }
  return block;
}

}  // namespace

void add_field_jacobian(SceneProgram& p, std::size_t chart) {
  Program& program = p.derivation->program;
  Tape& tape = program.tape;
  const std::string prefix = chart_prefix(chart);
  const StateDirections& directions = p.derivation->directions;
  const int columns = static_cast<int>(directions.columns.size());
  const std::vector<NodeId> by_state = output_of(program, prefix + "state_jacobian", "rates_x");
  const std::vector<NodeId> by_time = output_of(program, prefix + "state_jacobian", "rates_t");
  const int rows = static_cast<int>(by_time.size());
  Matrix<Expr> rates(rows, columns + 1);  // the last column is by time
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j)
      rates(i, j) = Expr(tape, by_state[static_cast<std::size_t>(i * columns + j)]);
    rates(i, columns) = Expr(tape, by_time[static_cast<std::size_t>(i)]);
  }

  // torques on driven coordinates are inputs of the dynamics, and functions of the state here
  const std::vector<NodeId> torque = output_of(program, prefix + "imposed_torque", "torque");
  const std::vector<NodeId> tau =
      torque.empty() ? torque : input_of(program, p.reduced.active.empty() ? "tau_a" : "tau_d");
  const std::vector<NodeId> nu_dot = output_of(program, prefix + "forward_dynamics", "nu_dot");
  const int first_nu = rows - static_cast<int>(nu_dot.size());
  const Matrix<Expr> torque_slopes = derivatives(tape, torque, directions);
  for (std::size_t i = 0; i < tau.size(); ++i) {
    const std::vector<NodeId> answer = directional_derivative(tape, nu_dot, {{tau[i], tape.constant(1)}});
    for (int r = first_nu; r < rows; ++r) {
      for (int j = 0; j <= columns; ++j)
        rates(r, j) += Expr(tape, answer[static_cast<std::size_t>(r - first_nu)]) *
                       torque_slopes(static_cast<int>(i), j);
    }
  }

  // power, a function of the state and of the rates that follow from it
  Expr power = 0;
  const std::vector<NodeId> tau_a = output_of(program, prefix + "inverse_torques", "tau_a");
  const std::vector<NodeId> r_a_dot = input_of(program, "r_a_dot");
  for (std::size_t i = 0; i < tau_a.size(); ++i) power += Expr(tape, tau_a[i]) * Expr(tape, r_a_dot[i]);
  const std::vector<NodeId> r_d_dot = output_of(program, prefix + "kinematics", "r_d_dot");
  for (std::size_t i = 0; i < tau.size(); ++i) power += Expr(tape, tau[i]) * Expr(tape, r_d_dot[i]);
  Expr dissipated = 0;
  for (const NodeId x : output_of(program, "energies", "applied_power")) power += Expr(tape, x);
  for (const NodeId x : output_of(program, "energies", "dissipated_power")) dissipated = Expr(tape, x);
  StateDirections following = directions;
  for (int j = 0; j <= columns; ++j) {
    Direction& along = j < columns ? following.columns[static_cast<std::size_t>(j)] : following.time;
    int row = 0;
    for (const char* block : {"eta", "r_p_dot", "r_d_dot", "nu_dot"}) {
      const std::string function = std::string(block) == "nu_dot" ? "forward_dynamics" : "kinematics";
      const std::vector<NodeId> inputs = input_of(program, block);
      const std::size_t size = output_of(program, prefix + function, block).size();
      for (std::size_t i = 0; i < size; ++i, ++row) {
        if (i < inputs.size()) along.emplace_back(inputs[i], rates(row, j).id(tape));
      }
    }
    for (std::size_t i = 0; i < tau.size(); ++i)
      along.emplace_back(tau[i], torque_slopes(static_cast<int>(i), j).id(tape));
  }
  const Matrix<Expr> powers = derivatives(tape, {power.id(tape), dissipated.id(tape)}, following);

  Function jacobian{prefix + "field_jacobian", "Derivatives of the field by the state and by time.", {}, ""};
  jacobian.outputs = {part(tape, "rates_x", rates, 0, columns), part(tape, "rates_t", rates, columns, 1),
                      part(tape, "power_x", powers, 0, columns), part(tape, "power_t", powers, columns, 1)};
  std::vector<NodeId> roots;
  for (const OutputBlock& b : jacobian.outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  p.jacobian_operations = std::max(p.jacobian_operations, operations_per_call(program, roots).total());
  std::erase_if(program.functions, [&](const Function& f) { return f.name == prefix + "state_jacobian"; });
  program.functions.push_back(std::move(jacobian));
}

}  // namespace anholon
