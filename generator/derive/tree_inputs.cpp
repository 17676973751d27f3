// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/tree_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace anholon {

TreeInputs::TreeInputs(const Model& model, Program& program) {
  Tape& tape = program.tape;
  for (const Parameter& p : model.parameters) {
    const NodeId node = tape.input(p.name);
    program.parameters.push_back({p.name, p.unit, p.meaning, p.value, node});
    parameters.emplace_back(tape, node);
  }
  const auto block = [&](const std::string& name, std::size_t size, const std::string& unit,
                         const std::string& meaning) {
    InputBlock b{name, unit, meaning, static_cast<int>(size), 1, {}};
    std::vector<Expr> entries;
    for (std::size_t i = 0; i < size; ++i) {
      b.nodes.push_back(tape.input(fmt::format("{}[{}]", name, i)));
      entries.emplace_back(tape, b.nodes.back());
    }
    if (size > 0) program.inputs.push_back(std::move(b));
    return entries;
  };
  const auto components = free_components(model.group);
  const auto twist = [&](Spatial<Expr>& to, const std::string& name, const std::string& unit,
                         const std::string& meaning) {
    const auto entries = block(name, components.size(), unit, meaning);
    for (std::size_t i = 0; i < components.size(); ++i) to[components[i]] = entries[i];
  };
  const bool can_turn = std::ranges::any_of(components, [](int c) { return c >= 3; });
  if (can_turn)
    std::ranges::copy(block("R", 9, "1", "orientation of the reference body in the world, row-major"),
                      R.m.begin());
  if (!components.empty()) {
    const auto entries = block("p", 3, "m", "position of the reference body in the world");
    p = {entries[0], entries[1], entries[2]};
  }
  std::string names;
  for (const Coordinate& c : model.coordinates) names += (names.empty() ? "" : ", ") + c.name;
  const std::size_t s = model.coordinates.size();
  r = block("r", s, "rad or m", names);
  twist(eta, "eta", "m/s, rad/s", "twist of the reference body in its own axes, linear part first");
  r_dot = block("r_dot", s, "rad/s or m/s", "rates of r");
  twist(eta_dot, "eta_dot", "m/s^2, rad/s^2", "derivative of eta");
  r_ddot = block("r_ddot", s, "rad/s^2 or m/s^2", "second derivatives of r");
  tau = block("tau", s, "N m or N", "forces of the joints");
}

State<Expr> TreeInputs::state() const {
  State<Expr> state;
  state.R = R;
  state.p = p;
  state.r = r;
  state.r_dot = r_dot;
  state.eta = eta;
  return state;
}

}  // namespace anholon
