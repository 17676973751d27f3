// SPDX-License-Identifier: GPL-2.0-or-later
// Constraint rows: written by the user as an expression linear in the velocities, or declared by what touches
// the ground.
#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/read_parts.hpp"
#include "tape/derivative.hpp"
#include "tape/interpret.hpp"

namespace anholon {
namespace {

constexpr Allowed row_symbols = SymbolKind::parameter | SymbolKind::coordinate | SymbolKind::velocity |
                                SymbolKind::pose | SymbolKind::time;

/// Body named by a key; empty after an error.
std::optional<int> read_body(TableReader& table, std::string_view key, Reading& reading) {
  const Value* value = table.required(key, Value::Kind::string, "name a body");
  if (value == nullptr) return std::nullopt;
  const int index = body_index(reading.model, value->text);
  if (index >= 0) return index;
  std::vector<std::string> names;
  for (const BodyDescription& body : reading.model.bodies) names.push_back(body.name);
  reading.findings.error(value->where, fmt::format("'{}' is not a body", value->text),
                         did_you_mean(value->text, names, fmt::format("bodies are {}", listed(names))));
  return std::nullopt;
}

std::array<Expr, 3> times(const std::array<Expr, 9>& R, const std::array<Expr, 3>& v) {
  std::array<Expr, 3> result;
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = dot(std::array<Expr, 3>{R[3 * i], R[3 * i + 1], R[3 * i + 2]}, v);
  return result;
}

/// The derivatives of a row by the velocities hold no velocity, and the row vanishes at rest.
void check_linear(const Expr& row, const Location& where, const std::string& what, Reading& reading) {
  Tape& tape = *reading.model.tape;
  const NodeId root = row.id(tape);
  const StateSymbols& symbols = reading.model.symbols;
  std::vector<NodeId> velocities(symbols.eta.begin(), symbols.eta.end());
  velocities.insert(velocities.end(), symbols.r_dot.begin(), symbols.r_dot.end());
  const auto is_velocity = [&](NodeId id) {
    return std::find(velocities.begin(), velocities.end(), id) != velocities.end();
  };
  const auto not_linear = [&](NodeId velocity) {
    return fmt::format("{} is not linear in {}", what, tape.inputs()[tape.node(velocity).a]);
  };
  const std::string mend = "a row is a sum of velocities times expressions without velocities";
  std::vector<NodeId> used;
  for (const NodeId id : tape.reachable({root})) {
    if (is_velocity(id)) used.push_back(id);
  }
  if (used.empty()) {
    reading.findings.error(where, fmt::format("{} has no velocity", what),
                           "write it with V_X ... Omega_Z or dot(...) of coordinates");
    return;
  }
  for (const NodeId id : tape.reachable({root})) {  // the derivative of a sign hides what it depends on
    if (tape.node(id).op != Op::sign) continue;
    const std::vector<NodeId> inside = tape.reachable({tape.node(id).a});
    if (const auto found = std::find_if(inside.begin(), inside.end(), is_velocity); found != inside.end()) {
      reading.findings.error(where, not_linear(*found), mend);
      return;
    }
  }
  std::vector<NodeId> coefficients;
  for (const NodeId velocity : used) coefficients.push_back(derivative(tape, root, velocity));
  const std::vector<NodeId> reached = tape.reachable(coefficients);
  if (const auto found = std::find_if(reached.begin(), reached.end(), is_velocity); found != reached.end()) {
    reading.findings.error(where, not_linear(*found), mend);
    return;
  }
  std::vector<Expr> at_rest;
  for (std::size_t i = 0; i < tape.inputs().size(); ++i) {
    const NodeId id = tape.input_node(i);
    at_rest.push_back(is_velocity(id) ? Expr(0) : Expr(tape, id));
  }
  if (!interpret<Expr>(tape, {root}, std::span<const Expr>(at_rest), FromExact<Expr>{&tape})
           .front()
           .is_zero()) {
    reading.findings.error(where, fmt::format("{} does not vanish at rest", what),
                           "each of its terms needs a velocity as a factor");
  }
}

/// A blade or a passive wheel: direction . (velocity of the point) = 0, in the body's axes.
RowDescription read_blade(TableReader& table, Reading& reading) {
  RowDescription row;
  const auto body = read_body(table, "body", reading);
  RowTermDescription term;
  term.body = body.value_or(0);
  term.linear = {0, 1, 0};
  if (const Value* point = table.optional("point"))
    term.point = reading.vector3(*point, fmt::format("the point of {}", table.what()), units::m);
  if (const Value* direction = table.optional("direction"))
    term.linear = reading.direction(*direction, fmt::format("the direction of {}", table.what()));
  if (body)
    row.name = fmt::format("no_lateral_slip_{}", reading.model.bodies[static_cast<std::size_t>(*body)].name);
  row.terms.push_back(term);
  return row;
}

/// A wheel of radius h that rolls along its plane without slip:
///   d . v_C - h (omega_wheel . axis) = 0,   C the wheel's centre, a point of its parent; d = axis x normal
RowDescription read_rolling(TableReader& table, Reading& reading) {
  static const Exact rounding = Exact::from_decimal("1e-40");
  RowDescription row;
  const auto index = read_body(table, "wheel", reading);
  const Value* radius = table.required("radius", "write it in m");
  std::array<Expr, 3> normal = {0, 0, 1};
  if (const Value* value = table.optional("normal"))
    normal = reading.direction(*value, fmt::format("the normal of {}", table.what()));
  std::optional<std::array<Expr, 3>> direction;
  if (const Value* value = table.optional("direction"))
    direction = reading.direction(*value, fmt::format("the direction of {}", table.what()));
  if (!index || radius == nullptr) return row;
  const BodyDescription& wheel = reading.model.bodies[static_cast<std::size_t>(*index)];
  row.name = fmt::format("rolling_{}", wheel.name);
  if (wheel.joint.kind != JointKind::revolute) {
    reading.findings.error(table.find_where("wheel"), fmt::format("'{}' has no revolute joint", wheel.name),
                           "a wheel turns about the axis of a revolute joint");
    return row;
  }
  const Expr h = reading.number(*radius, fmt::format("the radius of {}", table.what()), units::m);
  const std::array<Expr, 3> axle = times(wheel.R, wheel.joint.axis);  // in the parent's frame
  if (!direction) {
    direction = cross(axle, normal);
    const Expr square = dot(*direction, *direction);
    const Exact length = reading.at_defaults(square, table.table().where, table.what());
    if (abs(length - Exact(1)) > rounding)
      reading.findings.error(table.table().where,
                             fmt::format("the axle of '{}' is not perpendicular to the normal", wheel.name),
                             "state the direction of rolling in the parent's frame");
  }
  RowTermDescription centre;
  centre.body = wheel.parent;
  centre.point = wheel.p;
  centre.linear = *direction;
  RowTermDescription spin;
  spin.body = *index;
  for (std::size_t i = 0; i < 3; ++i) spin.angular[i] = -(h * wheel.joint.axis[i]);
  row.terms = {centre, spin};
  return row;
}

RowDescription read_row(TableReader& table, std::size_t number, Reading& reading) {
  RowDescription row;
  const Value* written = table.optional("row");
  const Value* kind = table.optional("kind");
  if (written != nullptr && kind != nullptr) {
    reading.findings.error(kind->where, fmt::format("{} has a row and a kind", table.what()), "keep one");
  } else if (written != nullptr) {
    const std::size_t before = reading.findings.size();
    row.name = fmt::format("row_{}", number);
    row.expression = reading.number(*written, table.what(), std::nullopt, row_symbols);
    if (reading.findings.size() == before)
      check_linear(*row.expression, written->where, table.what(), reading);
  } else if (const auto choice = table.required_choice("kind", {"no_lateral_slip", "rolling"})) {
    row = *choice == 0 ? read_blade(table, reading) : read_rolling(table, reading);
  } else {
    table.accept_all_keys();
  }
  return row;
}

}  // namespace

void read_constraints(TableReader& root, Reading& reading) {
  std::vector<RowDescription>& rows = reading.model.rows;
  for (const Value* value : tables_of(root, "constraint", reading.findings)) {
    const Value* name = value->find("name");
    const std::size_t number = rows.size() + 1;
    TableReader table(*value,
                      name != nullptr && name->kind == Value::Kind::string
                          ? fmt::format("constraint '{}'", name->text)
                          : fmt::format("constraint {}", number),
                      reading.findings);
    const Value* own_name = table.optional("name", Value::Kind::string);
    RowDescription row = read_row(table, number, reading);
    if (own_name != nullptr) row.name = reading.new_name(*own_name, "a constraint");
    row.where = value->where;
    table.report_unknown_keys();
    const bool is_taken = std::any_of(rows.begin(), rows.end(), [&](const RowDescription& other) {
      return !row.name.empty() && other.name == row.name;
    });
    if (is_taken && own_name != nullptr) {
      reading.findings.error(own_name->where, fmt::format("there is a constraint '{}' already", row.name),
                             "rename one");
    } else if (is_taken) {
      row.name += fmt::format("_{}", number);
    }
    rows.push_back(std::move(row));
  }
}

}  // namespace anholon
