// SPDX-License-Identifier: GPL-2.0-or-later
// Contacts and loops: wheels on a plane, held points, lines and surfaces, joints that close a loop.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "describe/contact.hpp"
#include "describe/names.hpp"
#include "describe/read_parts.hpp"

namespace anholon {

std::optional<int> read_body_name(TableReader& table, const Value& value, Reading& reading) {
  const int index = body_index(reading.model, value.text);
  if (value.kind == Value::Kind::string && index >= 0) return index;
  std::vector<std::string> names;
  for (const BodyDescription& body : reading.model.bodies) names.push_back(body.name);
  reading.findings.error(value.where, fmt::format("'{}' is not a body", value.text),
                         did_you_mean(value.text, names, fmt::format("bodies are {}", listed(names))));
  table.accept_all_keys();
  return std::nullopt;
}

std::optional<int> read_body(TableReader& table, std::string_view key, Reading& reading) {
  const Value* value = table.required(key, Value::Kind::string, "name a body");
  if (value == nullptr) return std::nullopt;
  return read_body_name(table, *value, reading);
}

namespace {

Ground read_ground(TableReader& table, Reading& reading) {
  Ground ground;
  const Value* value = table.optional("ground", Value::Kind::table);
  if (value == nullptr) return ground;
  TableReader plane(*value, fmt::format("the ground of {}", table.what()), reading.findings);
  if (const Value* normal = plane.optional("normal"))
    ground.normal = reading.direction(*normal, fmt::format("the normal of {}", plane.what()));
  if (const Value* height = plane.optional("height"))
    ground.height = reading.number(*height, fmt::format("the height of {}", plane.what()), units::m);
  plane.report_unknown_keys();
  return ground;
}

/// Keys of a wheel: wheel, axle, radius, crown, ground.
std::optional<Wheel> read_wheel(TableReader& table, Reading& reading) {
  Wheel wheel;
  const auto body = read_body(table, "wheel", reading);
  const Value* radius = table.required("radius", "write it in m; 0 with a crown is a sphere");
  if (radius != nullptr)
    wheel.radius = reading.number(*radius, fmt::format("the radius of {}", table.what()), units::m);
  if (const Value* crown = table.optional("crown"))
    wheel.crown = reading.number(*crown, fmt::format("the crown of {}", table.what()), units::m);
  const Value* axle = table.optional("axle");
  if (axle != nullptr) wheel.axle = reading.direction(*axle, fmt::format("the axle of {}", table.what()));
  wheel.ground = read_ground(table, reading);
  if (const Value* upright = table.optional("upright", Value::Kind::boolean))
    wheel.upright = upright->text == "true";
  if (!body || radius == nullptr) return std::nullopt;
  const BodyDescription& described = reading.model.bodies[static_cast<std::size_t>(*body)];
  wheel.body = *body;
  if (axle == nullptr && described.joint.kind == JointKind::revolute) wheel.axle = described.joint.axis;
  for (const auto& [size, name] : {std::pair(wheel.radius, "radius"), std::pair(wheel.crown, "crown")}) {
    if (reading.at_defaults(size, table.find_where(name), table.what()) < Exact(0)) {
      reading.findings.error(table.find_where(name),
                             fmt::format("the {} of {} is negative", name, table.what()),
                             "write a length of zero or more");
      return std::nullopt;
    }
  }
  if (wheel.radius.is_zero() && wheel.crown.is_zero()) {
    reading.findings.error(table.find_where("radius"), fmt::format("{} has no size", table.what()),
                           "give a radius, a crown or both");
    return std::nullopt;
  }
  return wheel;
}

/// Keys of an ellipsoid: body, centre, semi_axes, ground.
std::optional<Ellipsoid> read_ellipsoid(TableReader& table, Reading& reading) {
  Ellipsoid ellipsoid;
  const auto body = read_body(table, "body", reading);
  const Value* axes = table.required("semi_axes", "write three lengths in m, along the body's axes");
  if (axes != nullptr)
    ellipsoid.semi_axes = reading.vector3(*axes, fmt::format("the semi-axes of {}", table.what()), units::m);
  if (const Value* centre = table.optional("centre"))
    ellipsoid.centre = reading.vector3(*centre, fmt::format("the centre of {}", table.what()), units::m);
  ellipsoid.ground = read_ground(table, reading);
  if (!body || axes == nullptr) return std::nullopt;
  ellipsoid.body = *body;
  for (const Expr& a : ellipsoid.semi_axes) {
    if (reading.at_defaults(a, axes->where, table.what()) > Exact(0)) continue;
    reading.findings.error(axes->where, fmt::format("a semi-axis of {} is not positive", table.what()),
                           "write three lengths above zero");
    return std::nullopt;
  }
  return ellipsoid;
}

/// Keys of what holds: body, point, and of a loop other, other_point.
std::optional<Attachment> read_attachment(TableReader& table, bool loop, Reading& reading) {
  Attachment a;
  const auto body = read_body(table, "body", reading);
  if (const Value* point = table.optional("point"))
    a.point = reading.vector3(*point, fmt::format("the point of {}", table.what()), units::m);
  if (loop) {
    a.other = read_body(table, "other", reading);
    if (const Value* point = table.optional("other_point"))
      a.other_point = reading.vector3(*point, fmt::format("the other point of {}", table.what()), units::m);
    if (body && a.other == body) {
      reading.findings.error(table.find_where("other"), fmt::format("{} ties a body to itself", table.what()),
                             "name two bodies");
      return std::nullopt;
    }
    if (!a.other) return std::nullopt;
  } else {
    a.ground = read_ground(table, reading);
  }
  if (!body) return std::nullopt;
  a.body = *body;
  return a;
}

std::array<Expr, 3> read_axis(TableReader& table, std::string_view key, Reading& reading) {
  const Value* axis =
      table.required(key, fmt::format("write it in the body's frame, for instance [1, 0, 0]"));
  if (axis == nullptr) return {0, 0, 1};
  return reading.direction(*axis, fmt::format("the {} of {}", key, table.what()));
}

/// Reads the keys of a kind; the returned function makes the rows, once all of the description is known to be
/// sound.
using MakeContact = std::function<Contact(const ContactGeometry&)>;

MakeContact read_kind(TableReader& table, ContactKind kind, Reading& reading) {
  switch (kind) {
    case ContactKind::wheel: {
      const auto wheel = read_wheel(table, reading);
      if (!wheel) return {};
      return [w = *wheel](const ContactGeometry& geometry) { return geometry.rolling(w); };
    }
    case ContactKind::ellipsoid: {
      const auto ellipsoid = read_ellipsoid(table, reading);
      if (!ellipsoid) return {};
      return [e = *ellipsoid](const ContactGeometry& geometry) { return geometry.rolling(e); };
    }
    case ContactKind::rollers: {
      const Value* angle = table.optional("roller_angle");
      const Expr gamma =
          angle == nullptr
              ? Expr(0)
              : reading.number(*angle, fmt::format("the roller angle of {}", table.what()), units::one);
      const auto wheel = read_wheel(table, reading);
      if (!wheel) return {};
      if (wheel->radius.is_zero()) {
        reading.findings.error(table.find_where("radius"), fmt::format("{} has no rim", table.what()),
                               "a wheel with rollers needs a radius");
        return {};
      }
      return [w = *wheel, gamma](const ContactGeometry& geometry) { return geometry.rollers(w, gamma); };
    }
    case ContactKind::point:
    case ContactKind::line:
    case ContactKind::surface: {
      const std::array<Expr, 3> axis =
          kind == ContactKind::line ? read_axis(table, "along", reading) : std::array<Expr, 3>{0, 0, 1};
      const auto a = read_attachment(table, false, reading);
      if (!a) return {};
      const FreeTurns turns = kind == ContactKind::point  ? FreeTurns::all
                              : kind == ContactKind::line ? FreeTurns::about_axis
                                                          : FreeTurns::none;
      return [=](const ContactGeometry& geometry) { return geometry.attachment(*a, turns, axis, axis); };
    }
    case ContactKind::loop:
      break;
  }
  const auto joint = table.required_choice("joint", {"ball", "revolute", "fixed", "rod"});
  if (!joint) {
    table.accept_all_keys();
    return {};
  }
  std::array<Expr, 3> axis = {0, 0, 1};
  Expr length = 0;
  if (*joint == 1) axis = read_axis(table, "axis", reading);
  std::array<Expr, 3> other_axis = axis;
  if (*joint == 1 && table.optional("other_axis") != nullptr)
    other_axis = read_axis(table, "other_axis", reading);
  if (*joint == 3) {
    const Value* value = table.required("length", "write it in m");
    if (value == nullptr) {
      table.accept_all_keys();
      return {};
    }
    length = reading.number(*value, fmt::format("the length of {}", table.what()), units::m);
    if (!(reading.at_defaults(length, value->where, table.what()) > Exact(0))) {
      reading.findings.error(value->where, fmt::format("the length of {} is not positive", table.what()),
                             "two points that coincide are a ball joint");
      return {};
    }
  }
  const auto a = read_attachment(table, true, reading);
  if (!a) return {};
  if (*joint == 3) return [=](const ContactGeometry& geometry) { return geometry.rod(*a, length); };
  const FreeTurns turns = *joint == 0   ? FreeTurns::all
                          : *joint == 1 ? FreeTurns::about_axis
                                        : FreeTurns::none;
  return [=](const ContactGeometry& geometry) { return geometry.attachment(*a, turns, axis, other_axis); };
}

}  // namespace

namespace {

/// friction = 0.8
std::optional<Expr> read_friction(TableReader& table, Reading& reading) {
  const Value* value = table.optional("friction");
  if (value == nullptr) return std::nullopt;
  const std::string what = fmt::format("the friction of {}", table.what());
  const Expr friction = reading.number(*value, what, units::one);
  if (!(reading.at_defaults(friction, value->where, what) > Exact(0)))
    reading.findings.error(value->where, fmt::format("{} is not positive", what),
                           "write the coefficient, for instance 0.8");
  return friction;
}

}  // namespace

std::vector<RowDescription> read_contact(TableReader& table, ContactKind kind, const std::string& name,
                                         Reading& reading) {
  const MakeContact make = read_kind(table, kind, reading);
  const std::optional<Expr> friction =
      kind == ContactKind::loop ? std::nullopt : read_friction(table, reading);
  if (!make || reading.findings.size() > 0) return {};
  Contact contact = make(ContactGeometry(reading.model));
  std::vector<RowDescription> rows;
  ContactForceDescription force;
  force.contact = name;
  force.has_directions = contact.has_directions;
  force.friction = friction;
  // Wheels and stones stand on the ground; a foot grips it unless it is said to rub.
  force.unilateral = friction || kind == ContactKind::wheel || kind == ContactKind::ellipsoid ||
                     kind == ContactKind::rollers;
  for (ContactRow& row : contact.rows) {
    if (row.row.is_zero()) {  // holds by itself: a plane motion has no velocity across the plane
      force.has_normal = force.has_normal && !row.is_force;
      continue;
    }
    rows.push_back({fmt::format("{}_{}", name, row.suffix), name, {}, row.row, {}});
    if (row.is_force) force.shares.push_back({rows.back().name, row.share[0], row.share[1], row.share[2]});
  }
  if (contact.has_normal) reading.model.contact_forces.push_back(std::move(force));
  for (PositionDescription& position : contact.positions) {
    const NodeId root = position.value.id(*reading.model.tape);
    const std::vector<NodeId> reached = reading.model.tape->reachable({root});
    const auto moves = [&](NodeId id) {
      const StateSymbols& s = reading.model.symbols;
      return std::ranges::count(s.R, id) + std::ranges::count(s.p, id) + std::ranges::count(s.r, id) > 0;
    };
    if (std::ranges::none_of(reached, moves)) continue;
    position.contact = name;
    reading.model.positions.push_back(std::move(position));
  }
  return rows;
}

}  // namespace anholon
