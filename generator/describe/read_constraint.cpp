// SPDX-License-Identifier: GPL-2.0-or-later
// Constraint rows: written by the user as an expression linear in the velocities, declared in the plane, or
// those of contacts and loops (read_contact.cpp).
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
  if (!wheel.station.modes.empty()) {
    reading.findings.error(table.find_where("wheel"),
                           fmt::format("'{}' hangs on a compliant body", wheel.name),
                           "put a body without mass between them, which carries the wheel");
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

/// The rows of one [[constraint]]; `name` is the user's own or empty.
std::vector<RowDescription> read_rows(TableReader& table, std::size_t number, const std::string& name,
                                      Reading& reading) {
  static const std::vector<std::string> kinds = {
      "no_lateral_slip", "rolling", "wheel", "ellipsoid", "rollers", "point", "line", "surface", "loop"};
  const Value* written = table.optional("row");
  const Value* kind = table.optional("kind");
  if (written != nullptr && kind != nullptr) {
    reading.findings.error(kind->where, fmt::format("{} has a row and a kind", table.what()), "keep one");
    return {};
  }
  if (written != nullptr) {
    RowDescription row;
    const std::size_t before = reading.findings.size();
    row.name = fmt::format("row_{}", number);
    row.expression = reading.number(*written, table.what(), std::nullopt, row_symbols);
    if (reading.findings.size() == before)
      check_linear(*row.expression, written->where, table.what(), reading);
    return {row};
  }
  const auto choice = table.required_choice("kind", kinds);
  if (!choice) {
    table.accept_all_keys();
    return {};
  }
  if (*choice == 0) return {read_blade(table, reading)};
  if (*choice == 1) return {read_rolling(table, reading)};
  const std::string own = name.empty() ? fmt::format("{}_{}", kinds[*choice], number) : name;
  return read_contact(table, static_cast<ContactKind>(*choice - 2), own, reading);
}

}  // namespace

void read_constraints(TableReader& root, Reading& reading) {
  std::vector<RowDescription>& rows = reading.model.rows;
  const auto is_taken = [&](const std::string& name) {
    return !name.empty() && std::any_of(rows.begin(), rows.end(), [&](const RowDescription& other) {
      return other.name == name || other.contact == name;
    });
  };
  std::size_t number = 0;
  for (const Value* value : tables_of(root, "constraint", reading.findings)) {
    ++number;
    const Value* name = value->find("name");
    TableReader table(*value,
                      name != nullptr && name->kind == Value::Kind::string
                          ? fmt::format("constraint '{}'", name->text)
                          : fmt::format("constraint {}", number),
                      reading.findings);
    std::string own_name;
    if (const Value* given = table.optional("name", Value::Kind::string)) {
      own_name = reading.new_name(*given, "a constraint");
      if (is_taken(own_name))
        reading.findings.error(given->where, fmt::format("there is a constraint '{}' already", own_name),
                               "rename one");
    }
    std::vector<RowDescription> read = read_rows(table, number, own_name, reading);
    table.report_unknown_keys();
    for (RowDescription& row : read) {
      if (row.contact.empty()) {  // a single row goes by the name of its table
        if (!own_name.empty()) row.name = own_name;
        if (own_name.empty() && is_taken(row.name)) row.name += fmt::format("_{}", number);
        row.contact = row.name;
      }
      row.where = value->where;
      rows.push_back(std::move(row));
    }
  }
}

}  // namespace anholon
