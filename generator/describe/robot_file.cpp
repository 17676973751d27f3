// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/robot_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace anholon {
namespace {

ExactVector cross(const ExactVector& a, const ExactVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Up to the rounding of computed frames.
bool is_zero(const ExactVector& v) {
  return std::ranges::all_of(v, [](const Exact& x) { return abs(x) < rounding_distance(); });
}

/// A slide may be anywhere; a turn has to be on its axis.
bool passes_origin(const PlacedJoint& placed) {
  const RobotJointType type = placed.joint.type;
  const bool turns = type == RobotJointType::revolute || type == RobotJointType::continuous;
  return !turns || is_zero(cross(placed.joint.axis, placed.at));
}

std::string new_link_name(const RobotFile& file, const std::string& wanted) {
  std::string name = wanted;
  for (int i = 2; std::ranges::find(file.links, name, &RobotLink::name) != file.links.end(); ++i)
    name = fmt::format("{}_{}", wanted, i);
  return name;
}

}  // namespace

void join(RobotFile& file, const std::string& parent, const std::string& child, const ExactPose& pose,
          std::vector<PlacedJoint> joints, const RobotJoint& fixed) {
  std::string from = parent;
  ExactPose next = pose;           // of what comes next, if it stood at the child's origin
  ExactVector before = {0, 0, 0};  // where the frame `from` stands, in the child's frame
  const auto attach = [&](RobotJoint joint, const std::string& link, const ExactVector& at,
                          const ExactPose& back) {
    joint.parent = from;
    joint.child = link;
    const ExactVector step = {at[0] - before[0], at[1] - before[1], at[2] - before[2]};
    joint.pose = compose(compose(next, {identity_matrix(), step}), back);
    file.joints.push_back(std::move(joint));
    from = link;
    before = at;
    next = {};
  };
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const PlacedJoint& placed = joints[i];
    const bool last = i + 1 == joints.size();
    const bool centred = passes_origin(placed);
    if (last && centred) {
      attach(placed.joint, child, {0, 0, 0}, placed.back);
      return;
    }
    const std::string name = new_link_name(file, fmt::format("{}_at_{}", child, placed.joint.name));
    file.links.push_back({name, std::nullopt, true, placed.joint.where});
    if (!centred)
      file.notes.push_back(
          fmt::format("added: massless frame '{}': the axis of joint '{}' misses the origin of '{}'", name,
                      placed.joint.name, child));
    else
      file.notes.push_back(fmt::format("added: massless frame '{}' between the joints of '{}'", name, child));
    attach(placed.joint, name, centred ? ExactVector{0, 0, 0} : placed.at, placed.back);
  }
  attach(fixed, child, {0, 0, 0}, {});
}

}  // namespace anholon
