// SPDX-License-Identifier: GPL-2.0-or-later
// Joints: axis, range, drive and what resists their motion.
#include <fmt/format.h>

#include "describe/read_parts.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

/// Units of the efforts of a joint: force or torque, and what multiplies displacement and velocity.
struct EffortUnits {
  Dimension effort, stiffness, damping, rate;
};

EffortUnits effort_units(bool is_angle) {
  const Dimension effort = is_angle ? units::newton_m : units::newton;
  const Dimension rate = is_angle ? units::per_s : units::m_per_s;
  return {effort, is_angle ? effort : effort / units::m, effort / rate, rate};
}

/// A joint's coefficient that must not be negative at the default parameters.
Expr read_positive(const Value& value, const std::string& what, Dimension unit, bool may_vanish,
                   Reading& reading) {
  const std::size_t before = reading.findings.size();
  const Expr x = reading.number(value, what, unit);
  const Exact at_defaults = reading.at_defaults(x, value.where, what);
  if (reading.findings.size() == before && (at_defaults < Exact(0) || (!may_vanish && at_defaults.is_zero())))
    reading.findings.error(value.where, fmt::format("{} is {}", what, at_defaults.decimal(8)),
                           may_vanish ? "it must not be negative" : "it must be positive");
  return x;
}

/// Spring, damper and friction, which act on the displacement r of the joint and its rate.
void read_joint_forces(TableReader& joint, const Expr& r, const Expr& rate, bool is_angle, Reading& reading) {
  const EffortUnits unit = effort_units(is_angle);
  const Value* stiffness = joint.optional("stiffness");
  const Value* rest = joint.optional("rest");
  if (stiffness != nullptr) {
    // k/2 (r - rest)^2
    const Expr k =
        reading.number(*stiffness, fmt::format("the stiffness of {}", joint.what()), unit.stiffness);
    Expr stretch = r;
    if (rest != nullptr)
      stretch = r - reading.number(*rest, fmt::format("the rest of {}", joint.what()),
                                   is_angle ? units::one : units::m);
    const Expr square = stretch * stretch;
    reading.model.potential += k * square / Expr(2);
  } else if (rest != nullptr) {
    reading.findings.error(rest->where, fmt::format("{} has a rest but no stiffness", joint.what()),
                           "give it a stiffness, or remove the rest");
  }
  if (const Value* damping = joint.optional("damping")) {
    // c/2 rate^2
    const Expr c =
        read_positive(*damping, fmt::format("the damping of {}", joint.what()), unit.damping, true, reading);
    const Expr square = rate * rate;
    reading.model.dissipation += c * square / Expr(2);
  }
  if (const Value* friction = joint.optional("friction", Value::Kind::table)) {
    // -F tanh(rate / v)
    TableReader table(*friction, fmt::format("the friction of {}", joint.what()), reading.findings);
    const std::string effort = is_angle ? "torque" : "force";
    const Value* size = table.required(effort, "write its size while the joint moves");
    const Value* speed = table.required("velocity", "write the speed at which it has built up to 76 %");
    table.report_unknown_keys();
    if (size == nullptr || speed == nullptr) return;
    const Expr F =
        read_positive(*size, fmt::format("the {} of {}", effort, table.what()), unit.effort, true, reading);
    const Expr v =
        read_positive(*speed, fmt::format("the velocity of {}", table.what()), unit.rate, false, reading);
    if (!v.is_zero()) add_force_on(r, -(F * tanh(rate / v)), reading, true);
  }
}

/// Range and drive of the coordinate that moves the joint, where they are said.
void read_coordinate(TableReader& joint, Coordinate& coordinate, Reading& reading) {
  if (const auto drive = joint.optional_choice("drive", {"active", "passive"}))
    coordinate.drive = *drive == 0 ? Drive::active : Drive::passive;
  const Value* range = joint.optional("range");
  if (range == nullptr) return;
  const std::string what = fmt::format("the range of {}", joint.what());
  if (const auto bounds = reading.range(*range, what, coordinate.is_angle ? units::one : units::m)) {
    coordinate.lower = (*bounds)[0];
    coordinate.upper = (*bounds)[1];
  }
}

}  // namespace

void add_force_on(const Expr& displacement, const Expr& force, Reading& reading, bool dissipates) {
  Model& model = reading.model;
  Tape& tape = *model.tape;
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    const NodeId share = derivative(tape, displacement.id(tape), model.symbols.r[i]);
    if (!tape.is_zero(share))
      model.forces.push_back({static_cast<int>(6 + i), Expr(tape, share) * force, dissipates});
  }
}

void read_joint(BodyOutline& body, BodyDescription& described, Reading& reading) {
  if (!body.joint) return;
  TableReader& joint = *body.joint;
  Model& model = reading.model;
  const JointKind kind = described.joint.kind;
  if (kind == JointKind::fixed) {
    joint.report_unknown_keys();
    return;
  }
  const bool is_angle = kind != JointKind::prismatic;
  if (const Value* axis = joint.required("axis", "write its direction, for example axis = [0, 0, 1]"))
    described.joint.axis = reading.direction(*axis, fmt::format("the axis of {}", joint.what()));
  if (kind == JointKind::helical) {
    if (const Value* pitch = joint.required("pitch", "write its advance in m/rad"))
      described.joint.pitch = reading.number(*pitch, fmt::format("the pitch of {}", joint.what()), units::m);
  }
  if (body.coordinate >= 0) {
    const auto i = static_cast<std::size_t>(body.coordinate);
    described.joint.displacement = Expr(*model.tape, model.symbols.r[i]);
    Coordinate& coordinate = model.coordinates[i];
    if (is_angle) {
      coordinate.upper = Exact::pi();
      coordinate.lower = -coordinate.upper;
    } else {
      joint.required("range", "write its working range, range = [lower, upper]");
    }
  }
  read_joint_supplement(joint, described, body.coordinate, reading);
  joint.report_unknown_keys();
}

void read_joint_supplement(TableReader& joint, BodyDescription& described, int coordinate, Reading& reading) {
  if (coordinate >= 0) {
    read_coordinate(joint, reading.model.coordinates[static_cast<std::size_t>(coordinate)], reading);
  } else {
    for (const std::string_view key : {"drive", "range"}) {
      if (const Value* value = joint.optional(key))
        reading.findings.error(value->where, fmt::format("{} is coupled and has a '{}'", joint.what(), key),
                               "it belongs to the coordinates that the joint follows; remove it");
    }
  }
  const bool is_angle = described.joint.kind != JointKind::prismatic;
  if (const Value* armature = joint.optional("armature")) {
    const Dimension unit = is_angle ? units::kg * units::m * units::m : units::kg;
    described.joint.armature +=
        read_positive(*armature, fmt::format("the armature of {}", joint.what()), unit, true, reading);
  }
  const Symbol* rate = reading.scope.find_rate(described.joint.coordinate);
  if (rate != nullptr)
    read_joint_forces(joint, described.joint.displacement, rate->quantity.value, is_angle, reading);
}

}  // namespace anholon
