// SPDX-License-Identifier: GPL-2.0-or-later
// The inputs of a model's tape, in their one order, and the names by which expressions call them.
#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/outline.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

std::optional<Dimension> unit_of(const Parameter& parameter) {
  try {
    return read_unit(parameter.unit);
  } catch (const UnitError&) {
    return std::nullopt;  // was reported where the parameter was read
  }
}

Dimension unit_of(const Coordinate& coordinate) { return coordinate.is_angle ? units::one : units::m; }

}  // namespace

void make_symbols(Reading& reading) {
  Model& model = reading.model;
  Tape& tape = *model.tape;
  StateSymbols& symbols = model.symbols;
  const auto input = [&](const std::string& name, Exact value) {
    reading.defaults.add_input(std::move(value));
    return tape.input(name);
  };
  const auto symbol = [&](SymbolKind kind, NodeId id, std::optional<Dimension> unit) {
    return Symbol{kind, {Expr(tape, id), unit}, ""};
  };

  for (const Parameter& parameter : model.parameters) {
    symbols.parameters.push_back(input(parameter.name, parameter.value));
    reading.scope.add(parameter.name,
                      symbol(SymbolKind::parameter, symbols.parameters.back(), unit_of(parameter)));
  }
  symbols.t = input("t", 0);
  reading.scope.add("t", symbol(SymbolKind::time, symbols.t, std::nullopt));  // people write sin(t)
  constexpr std::array<char, 3> axes = {'X', 'Y', 'Z'};
  for (std::size_t i = 0; i < 9; ++i) {
    const std::string name = fmt::format("R_{}{}", axes[i / 3], axes[i % 3]);
    symbols.R[i] = input(name, i % 4 == 0 ? 1 : 0);
    reading.scope.add(name, symbol(SymbolKind::pose, symbols.R[i], units::one));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string name = fmt::format("p_{}", axes[i]);
    symbols.p[i] = input(name, 0);
    reading.scope.add(name, symbol(SymbolKind::pose, symbols.p[i], units::m));
  }
  for (const Coordinate& coordinate : model.coordinates) {
    symbols.r.push_back(input(coordinate.name, 0));
    reading.scope.add(coordinate.name, symbol(SymbolKind::coordinate, symbols.r.back(), unit_of(coordinate)));
  }
  const auto free = free_components(model.group);
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string component(twist_component_names[i]);
    symbols.eta[i] = input(component, 0);
    Symbol velocity = symbol(SymbolKind::velocity, symbols.eta[i], i < 3 ? units::m_per_s : units::per_s);
    if (std::find(free.begin(), free.end(), static_cast<int>(i)) == free.end())
      velocity.objection = fmt::format("is always zero where the group is {}", name(model.group));
    reading.scope.add(component, std::move(velocity));
  }
  for (const Coordinate& coordinate : model.coordinates) {
    symbols.r_dot.push_back(input(fmt::format("{}_dot", coordinate.name), 0));
    reading.scope.add_rate(
        coordinate.name, symbol(SymbolKind::velocity, symbols.r_dot.back(), unit_of(coordinate) / units::s));
  }
}

void read_couplings(Outline& outline, Reading& reading) {
  Model& model = reading.model;
  Tape& tape = *model.tape;
  for (const CouplingOutline& coupling : outline.couplings) {
    Symbol symbol;
    symbol.kind = SymbolKind::coordinate;
    symbol.objection = "is a coupled coordinate itself";
    reading.scope.add(coupling.coordinate, symbol);
  }
  std::vector<std::pair<NodeId, NodeId>> motion;  // d/dt
  for (std::size_t i = 0; i < model.coordinates.size(); ++i)
    motion.emplace_back(model.symbols.r[i], model.symbols.r_dot[i]);

  std::vector<Expr> displacements;
  for (const CouplingOutline& coupling : outline.couplings) {
    const std::string what = fmt::format("the coupling of '{}'", coupling.coordinate);
    const auto body = std::find_if(model.bodies.begin(), model.bodies.end(), [&](const BodyDescription& b) {
      return b.joint.coordinate == coupling.coordinate;
    });
    const bool is_angle = body->joint.kind != JointKind::prismatic;
    body->joint.displacement = reading.number(*coupling.equals, what, is_angle ? units::one : units::m,
                                              SymbolKind::parameter | SymbolKind::coordinate);
    displacements.push_back(body->joint.displacement);
    for (const NodeId id : tape.reachable({body->joint.displacement.id(tape)})) {
      if (tape.node(id).op == Op::abs || tape.node(id).op == Op::sign)
        reading.findings.error(coupling.equals->where, fmt::format("{} has a kink", what),
                               "it needs two derivatives: do without abs and sign");
    }
  }
  for (std::size_t i = 0; i < displacements.size(); ++i) {
    const std::string& name = outline.couplings[i].coordinate;
    const Symbol known{SymbolKind::coordinate, {displacements[i], std::nullopt}, ""};
    const NodeId rate = directional_derivative(tape, {displacements[i].id(tape)}, motion).front();
    reading.scope.add(name, known);
    reading.scope.add_rate(name, Symbol{SymbolKind::velocity, {Expr(tape, rate), std::nullopt}, ""});
  }
}

}  // namespace anholon
