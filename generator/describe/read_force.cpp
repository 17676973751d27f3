// SPDX-License-Identifier: GPL-2.0-or-later
// Wrenches on bodies and generalised forces, as expressions of parameters, state and time.
#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/read_parts.hpp"

namespace anholon {
namespace {

constexpr std::array<const char*, 6> local_names = {"v_x", "v_y", "v_z", "omega_x", "omega_y", "omega_z"};

bool dissipates(TableReader& table) {
  const Value* value = table.optional("dissipative", Value::Kind::boolean);
  return value != nullptr && value->text == "true";
}

constexpr Allowed force_symbols = SymbolKind::parameter | SymbolKind::coordinate | SymbolKind::velocity |
                                  SymbolKind::pose | SymbolKind::time;

void read_coordinate_force(TableReader& table, const Value& coordinate, Reading& reading) {
  const Value* force = table.required("force", "write it as an expression");
  const Symbol* symbol = reading.scope.find(coordinate.text);
  const Symbol* rate = reading.scope.find_rate(coordinate.text);
  if (symbol == nullptr || rate == nullptr) {
    const std::vector<std::string> known = reading.scope.names_with_rate();
    reading.findings.error(
        coordinate.where, fmt::format("'{}' is not a coordinate", coordinate.text),
        did_you_mean(coordinate.text, known,
                     known.empty() ? "there are none" : fmt::format("coordinates are {}", listed(known))));
    return;
  }
  if (force == nullptr) return;
  std::optional<Dimension> unit;
  if (symbol->quantity.unit) unit = symbol->quantity.unit->is_number() ? units::newton_m : units::newton;
  const Expr value =
      reading.number(*force, fmt::format("the force of {}", table.what()), unit, force_symbols);
  add_force_on(symbol->quantity.value, value, reading, dissipates(table));
}

void read_component_force(TableReader& table, const Value& component, Reading& reading) {
  const Value* force = table.required("force", "write it as an expression");
  const auto free = free_components(reading.model.group);
  std::vector<std::string> known;
  for (const int i : free) known.emplace_back(twist_component_names[static_cast<std::size_t>(i)]);
  const auto found = std::find(known.begin(), known.end(), component.text);
  if (found == known.end()) {
    reading.findings.error(
        component.where,
        fmt::format("'{}' is not a velocity of the group {}", component.text, name(reading.model.group)),
        did_you_mean(component.text, known,
                     known.empty() ? "the base is fixed" : fmt::format("it has {}", listed(known))));
    return;
  }
  if (force == nullptr) return;
  const int index = free[static_cast<std::size_t>(found - known.begin())];
  const Expr value = reading.number(*force, fmt::format("the force of {}", table.what()),
                                    index < 3 ? units::newton : units::newton_m, force_symbols);
  reading.model.forces.push_back({index, value, dissipates(table)});
}

void read_wrench(TableReader& table, const Value& body, Reading& reading) {
  WrenchDescription wrench;
  wrench.body = body_index(reading.model, body.text);
  if (wrench.body < 0) {
    std::vector<std::string> names;
    for (const BodyDescription& other : reading.model.bodies) names.push_back(other.name);
    reading.findings.error(body.where, fmt::format("'{}' is not a body", body.text),
                           did_you_mean(body.text, names, fmt::format("bodies are {}", listed(names))));
  }
  const Value* force = table.optional("force");
  const Value* torque = table.optional("torque");
  if (force == nullptr && torque == nullptr)
    reading.findings.error(table.table().where, fmt::format("{} has neither force nor torque", table.what()),
                           "give it one");
  const Scope of_all = reading.scope;  // local velocities are names of this wrench alone
  const std::array<Expr, 6> local = local_velocity(reading);
  for (std::size_t i = 0; i < 6; ++i) {
    if (of_all.find(local_names[i]) == nullptr)  // what the description calls so keeps its name
      reading.scope.add(
          local_names[i],
          Symbol{SymbolKind::velocity, {local[i], i < 3 ? units::m_per_s : units::per_s}, "", ""});
  }
  if (force != nullptr)
    wrench.force =
        reading.vector3(*force, fmt::format("the force of {}", table.what()), units::newton, force_symbols);
  if (torque != nullptr)
    wrench.torque = reading.vector3(*torque, fmt::format("the torque of {}", table.what()), units::newton_m,
                                    force_symbols);
  reading.scope = of_all;
  wrench.dissipates = dissipates(table);
  if (const Value* point = table.optional("point"))
    wrench.point = reading.vector3(*point, fmt::format("the point of {}", table.what()), units::m);
  if (const auto axes = table.optional_choice("axes", {"body", "world"})) wrench.in_world_axes = *axes == 1;
  reading.model.wrenches.push_back(wrench);
}

}  // namespace

std::array<Expr, 6> local_velocity(Reading& reading) {
  Tape& tape = *reading.model.tape;
  std::vector<NodeId>& inputs = reading.model.symbols.local;
  for (std::size_t i = inputs.size(); i < 6; ++i) {
    inputs.push_back(tape.input(local_names[i]));
    reading.defaults.add_input(0);
  }
  std::array<Expr, 6> velocity;
  for (std::size_t i = 0; i < 6; ++i) velocity[i] = Expr(tape, inputs[i]);
  return velocity;
}

void read_forces(TableReader& root, Reading& reading) {
  std::size_t number = 0;
  for (const Value* value : tables_of(root, "force", reading.findings)) {
    TableReader table(*value, fmt::format("force {}", ++number), reading.findings);
    const Value* coordinate = table.optional("coordinate", Value::Kind::string);
    const Value* component = table.optional("component", Value::Kind::string);
    const Value* body = table.optional("body", Value::Kind::string);
    const int targets =
        (coordinate != nullptr ? 1 : 0) + (component != nullptr ? 1 : 0) + (body != nullptr ? 1 : 0);
    if (targets != 1) {
      reading.findings.error(value->where, fmt::format("{} acts on {} things", table.what(), targets),
                             "name one: a body, a coordinate or a component such as \"V_X\"");
      continue;
    }
    if (coordinate != nullptr) read_coordinate_force(table, *coordinate, reading);
    if (component != nullptr) read_component_force(table, *component, reading);
    if (body != nullptr) read_wrench(table, *body, reading);
    table.report_unknown_keys();
  }
}

}  // namespace anholon
