// SPDX-License-Identifier: GPL-2.0-or-later
// Poses: { translation, rotation }.
#include <fmt/format.h>

#include "describe/read_parts.hpp"

namespace anholon {
namespace {

using RotationMatrix = std::array<Expr, 9>;

RotationMatrix product(const RotationMatrix& a, const RotationMatrix& b) {
  RotationMatrix c;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::array<Expr, 3> row = {a[3 * i], a[3 * i + 1], a[3 * i + 2]};
      const std::array<Expr, 3> column = {b[j], b[3 + j], b[6 + j]};
      c[3 * i + j] = dot(row, column);
    }
  }
  return c;
}

/// Turn by an angle about coordinate axis 0, 1 or 2.
RotationMatrix turn(std::size_t axis, const Expr& angle) {
  const std::size_t i = (axis + 1) % 3;
  const std::size_t j = (axis + 2) % 3;
  const Expr c = cos(angle);
  const Expr s = sin(angle);
  RotationMatrix R = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  R[4 * axis] = 1;
  R[4 * i] = c;
  R[4 * j] = c;
  R[3 * i + j] = -s;
  R[3 * j + i] = s;
  return R;
}

/// One turn of a rotation: { axis = "x", angle = ... }.
RotationMatrix read_turn(const Value& value, const std::string& what, Reading& reading) {
  TableReader table(value, what, reading.findings);
  RotationMatrix R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const auto axis = table.required_choice("axis", {"x", "y", "z"});
  const Value* angle = table.required("angle", "write it in rad");
  if (axis && angle != nullptr)
    R = turn(*axis, reading.number(*angle, fmt::format("the angle of {}", what), units::one));
  table.report_unknown_keys();
  return R;
}

/// A turn, a list of turns each about the axes that the ones before it have moved, or { rpy = [roll, pitch,
/// yaw] }.
RotationMatrix read_rotation(const Value& value, const std::string& what, Reading& reading) {
  RotationMatrix R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (value.kind == Value::Kind::array) {
    for (const Value& item : value.items) {
      if (item.kind == Value::Kind::table) {
        R = product(R, read_turn(item, what, reading));
      } else {
        reading.findings.error(item.where, fmt::format("a turn of {} is {}", what, item.kind_name()),
                               "write { axis = \"x\", angle = ... }");
      }
    }
    return R;
  }
  if (value.kind != Value::Kind::table) {
    reading.findings.error(value.where, fmt::format("{} is {}", what, value.kind_name()),
                           "write { axis = \"x\", angle = ... }, a list of such turns or { rpy = [...] }");
    return R;
  }
  const Value* rpy = value.find("rpy");
  if (rpy == nullptr) return read_turn(value, what, reading);
  TableReader table(value, what, reading.findings);
  table.optional("rpy");
  table.report_unknown_keys();
  const auto angles = reading.vector3(*rpy, fmt::format("rpy of {}", what), units::one);
  const RotationMatrix yaw = turn(2, angles[2]);
  const RotationMatrix pitch = turn(1, angles[1]);
  return product(product(yaw, pitch), turn(0, angles[0]));
}

}  // namespace

PoseDescription read_pose(const Value& pose, const std::string& what, Reading& reading) {
  PoseDescription described;
  TableReader table(pose, what, reading.findings);
  if (const Value* translation = table.optional("translation"))
    described.p = reading.vector3(*translation, fmt::format("the translation of {}", what), units::m);
  if (const Value* rotation = table.optional("rotation"))
    described.R = read_rotation(*rotation, fmt::format("the rotation of {}", what), reading);
  table.report_unknown_keys();
  return described;
}

void read_pose(BodyOutline& body, BodyDescription& described, Reading& reading) {
  if (described.parent < 0) return;  // the reference body has none
  const Value* pose = body.table.optional("pose", Value::Kind::table);
  if (pose == nullptr) return;
  const PoseDescription read = read_pose(*pose, fmt::format("the pose of {}", body.table.what()), reading);
  described.R = read.R;
  described.p = read.p;
}

}  // namespace anholon
