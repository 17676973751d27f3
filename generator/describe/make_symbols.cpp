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

constexpr std::array<char, 3> axes = {'X', 'Y', 'Z'};

Dimension unit_of(const Coordinate& coordinate) { return coordinate.is_angle ? units::one : units::m; }

}  // namespace

void make_symbols(Reading& reading) {
  Model& model = reading.model;
  Tape& tape = *model.tape;
  StateSymbols& symbols = model.symbols;
  for (const Parameter& parameter : model.parameters)
    symbols.parameters.push_back(tape.input(parameter.name));
  symbols.t = tape.input("t");
  for (std::size_t i = 0; i < 9; ++i)
    symbols.R[i] = tape.input(fmt::format("R_{}{}", axes[i / 3], axes[i % 3]));
  for (std::size_t i = 0; i < 3; ++i) symbols.p[i] = tape.input(fmt::format("p_{}", axes[i]));
  for (const Coordinate& coordinate : model.coordinates) symbols.r.push_back(tape.input(coordinate.name));
  for (std::size_t i = 0; i < 6; ++i) symbols.eta[i] = tape.input(std::string(twist_component_names[i]));
  for (const Coordinate& coordinate : model.coordinates)
    symbols.r_dot.push_back(tape.input(fmt::format("{}_dot", coordinate.name)));
  name_symbols(reading);
}

void name_symbols(Reading& reading) {
  const Model& model = reading.model;
  Tape& tape = *model.tape;
  const StateSymbols& symbols = model.symbols;
  const auto symbol = [&](SymbolKind kind, NodeId id, std::optional<Dimension> unit) {
    return Symbol{kind, {Expr(tape, id), unit}, "", ""};
  };
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const Parameter& parameter = model.parameters[i];
    reading.defaults.add_input(parameter.value);
    reading.scope.add(parameter.name,
                      symbol(SymbolKind::parameter, symbols.parameters[i], unit_of(parameter)));
  }
  reading.defaults.add_input(0);
  reading.scope.add("t", symbol(SymbolKind::time, symbols.t, std::nullopt));  // people write sin(t)
  for (std::size_t i = 0; i < 9; ++i) {
    reading.defaults.add_input(i % 4 == 0 ? 1 : 0);
    reading.scope.add(fmt::format("R_{}{}", axes[i / 3], axes[i % 3]),
                      symbol(SymbolKind::pose, symbols.R[i], units::one));
  }
  for (std::size_t i = 0; i < 3; ++i)
    reading.scope.add(fmt::format("p_{}", axes[i]), symbol(SymbolKind::pose, symbols.p[i], units::m));
  const auto free = free_components(model.group);
  for (std::size_t i = 0; i < 6; ++i) {
    Symbol velocity = symbol(SymbolKind::velocity, symbols.eta[i], i < 3 ? units::m_per_s : units::per_s);
    if (std::find(free.begin(), free.end(), static_cast<int>(i)) == free.end()) {
      velocity.objection = fmt::format("is always zero where the group is {}", name(model.group));
      velocity.mend = "remove it";
    }
    reading.scope.add(std::string(twist_component_names[i]), std::move(velocity));
  }
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    const Coordinate& coordinate = model.coordinates[i];
    const Dimension unit = unit_of(coordinate);
    reading.scope.add(coordinate.name, symbol(SymbolKind::coordinate, symbols.r[i], unit));
    reading.scope.add_rate(coordinate.name, symbol(SymbolKind::velocity, symbols.r_dot[i], unit / units::s));
  }
  const std::size_t state = 3 + 6 + 2 * model.coordinates.size() + symbols.local.size();
  for (std::size_t i = 0; i < state; ++i) reading.defaults.add_input(0);
}

void name_coupled_coordinates(Reading& reading) {
  const Model& model = reading.model;
  Tape& tape = *model.tape;
  std::vector<std::pair<NodeId, NodeId>> motion;  // d/dt
  for (std::size_t i = 0; i < model.coordinates.size(); ++i)
    motion.emplace_back(model.symbols.r[i], model.symbols.r_dot[i]);
  for (const BodyDescription& body : model.bodies) {
    const JointDescription& joint = body.joint;
    if (joint.coordinate.empty() || coordinate_index(model, joint.coordinate) >= 0) continue;
    const NodeId rate = directional_derivative(tape, {joint.displacement.id(tape)}, motion).front();
    reading.scope.add(joint.coordinate,
                      Symbol{SymbolKind::coordinate, {joint.displacement, std::nullopt}, "", ""});
    reading.scope.add_rate(joint.coordinate,
                           Symbol{SymbolKind::velocity, {Expr(tape, rate), std::nullopt}, "", ""});
  }
}

void read_couplings(Outline& outline, Reading& reading) {
  Model& model = reading.model;
  Tape& tape = *model.tape;
  for (const CouplingOutline& coupling : outline.couplings) {
    Symbol symbol;
    symbol.kind = SymbolKind::coordinate;
    symbol.objection = "is a coupled coordinate itself";
    symbol.mend = "write the coupling with independent ones";
    reading.scope.add(coupling.coordinate, symbol);
  }
  for (const CouplingOutline& coupling : outline.couplings) {
    const std::string what = fmt::format("the coupling of '{}'", coupling.coordinate);
    const auto body = std::find_if(model.bodies.begin(), model.bodies.end(), [&](const BodyDescription& b) {
      return b.joint.coordinate == coupling.coordinate;
    });
    const bool is_angle = body->joint.kind != JointKind::prismatic;
    body->joint.displacement = reading.number(*coupling.equals, what, is_angle ? units::one : units::m,
                                              SymbolKind::parameter | SymbolKind::coordinate);
    for (const NodeId id : tape.reachable({body->joint.displacement.id(tape)})) {
      if (tape.node(id).op == Op::abs || tape.node(id).op == Op::sign)
        reading.findings.error(coupling.equals->where, fmt::format("{} has a kink", what),
                               "it needs two derivatives: do without abs and sign");
    }
  }
  name_coupled_coordinates(reading);
}

}  // namespace anholon
