// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/state_jacobian.hpp"

#include <algorithm>

#include "tape/derivative.hpp"
#include "tape/interpret.hpp"

namespace anholon {

StateDirections state_directions(Tape& tape, const ProgramSymbols& symbols, const Partition& partition,
                                 const std::vector<Expr>& nu, const std::vector<Expr>& r_a_dot,
                                 const std::vector<Expr>& r_a_ddot, const std::vector<Expr>& r_a_dddot) {
  StateDirections result;
  const NodeId t = symbols.position().t.id(tape);
  const std::size_t velocities = partition.passive.size() + partition.active.size();
  for (const int velocity : partition.passive) {  // a unit velocity moves what depends on it
    std::vector<Expr> v(velocities, Expr(0));
    v[static_cast<std::size_t>(velocity)] = Expr(1);
    Direction column = symbols.motion(v);
    std::erase_if(column, [t](const auto& moved) { return moved.first == t; });
    result.columns.push_back(std::move(column));
  }
  for (const Expr& x : nu) result.columns.push_back({{x.id(tape), tape.constant(1)}});
  result.time.emplace_back(t, tape.constant(1));
  const auto follow = [&](const Expr& x, const Expr& rate) {
    result.time.emplace_back(x.id(tape), rate.id(tape));
  };
  for (std::size_t i = 0; i < partition.active.size(); ++i) {
    follow(symbols.position().r[static_cast<std::size_t>(partition.active[i] - partition.n)], r_a_dot[i]);
    follow(r_a_dot[i], r_a_ddot[i]);
    follow(r_a_ddot[i], r_a_dddot[i]);
  }
  return result;
}

Matrix<Expr> derivatives(Tape& tape, const std::vector<NodeId>& roots, const StateDirections& directions) {
  const int rows = static_cast<int>(roots.size()), columns = static_cast<int>(directions.columns.size());
  Matrix<Expr> result(rows, columns + 1);
  for (int j = 0; j <= columns; ++j) {
    const Direction& along = j < columns ? directions.columns[static_cast<std::size_t>(j)] : directions.time;
    const std::vector<NodeId> column = directional_derivative(tape, roots, along);
    for (int i = 0; i < rows; ++i) result(i, j) = Expr(tape, column[static_cast<std::size_t>(i)]);
  }
  return result;
}

std::vector<NodeId> substituted(Tape& tape, const std::vector<NodeId>& nodes, const std::vector<Expr>& inputs,
                                const std::vector<Expr>& values) {
  std::vector<Expr> all;
  for (std::size_t i = 0; i < tape.inputs().size(); ++i) all.emplace_back(tape, tape.input_node(i));
  for (std::size_t i = 0; i < inputs.size(); ++i) all[tape.node(inputs[i].id(tape)).a] = values[i];
  std::vector<NodeId> result;
  for (const Expr& e : interpret<Expr>(tape, nodes, all, FromExact<Expr>{&tape}))
    result.push_back(e.id(tape));
  return result;
}

}  // namespace anholon
