// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the robot formats have in common, after strict reading: links, and joints between them, with exact
// numbers. Readers of URDF, SDFormat and MJCF end here; what it means as a mechanism is read_robot's matter.

#include <optional>
#include <string>
#include <vector>

#include "describe/exact_rotation.hpp"
#include "describe/location.hpp"

namespace anholon {

struct RobotInertial {
  ExactPose pose;  // of the central axes in which the inertia is given, in the link's frame
  Exact mass;
  std::array<Exact, 6> inertia;  // xx yy zz xy xz yz about the centre of mass
  Location where;
};

struct RobotLink {
  std::string name;
  std::optional<RobotInertial> inertial;
  bool is_frame = false;  // put in by a reader: a frame on the way, or the world; massless by itself
  Location where;
};

enum class RobotJointType { revolute, continuous, prismatic, fixed, floating, planar };

/// The coordinate is multiplier * (that of `joint`) + offset.
struct RobotMimic {
  std::string joint;
  Exact multiplier = 1;
  Exact offset = 0;
  Location where;
};

struct RobotJoint {
  std::string name;
  RobotJointType type = RobotJointType::fixed;
  std::string parent, child;
  ExactPose pose;                             // of the child's frame in the parent's, at zero displacement
  ExactVector axis = {1, 0, 0};               // in the child's frame, of any length
  std::optional<std::array<Exact, 2>> limit;  // of the coordinate
  Exact armature = 0;                         // inertia of the motor as the joint feels it, kg m^2 or kg
  Exact damping = 0;
  Exact friction = 0;
  Exact stiffness = 0;  // of a spring
  Exact rest = 0;       // coordinate at which it is at rest
  std::optional<RobotMimic> mimic;
  Location where, parent_where, child_where;
};

/// What a file says of the root link.
enum class RobotBase { unsaid, fixed, free };

struct RobotFile {
  std::string name;
  std::vector<RobotLink> links;
  std::vector<RobotJoint> joints;
  RobotBase base = RobotBase::unsaid;
  std::optional<ExactVector> gravity;  // acceleration in the world
  std::vector<std::string> notes;      // what was left out, snapped, assumed
};

/// A joint whose axis may pass anywhere in the child.
struct PlacedJoint {
  RobotJoint joint;
  ExactVector at = {0, 0, 0};  // a point of the axis, in the child's frame
  ExactPose back;              // what the joint does from the pose of the file to its zero
};

/// Joins a link to another by joints that follow each other, all given in the child's frame; by a fixed one
/// where there are none. Where an axis misses the child's origin, or there are several joints, massless
/// frames with the child's orientation are put in between.
/// @param pose  of the child in the parent, at the pose of the file
/// @param fixed  name and places of the joint that is fixed, where there is one
void join(RobotFile& file, const std::string& parent, const std::string& child, const ExactPose& pose,
          std::vector<PlacedJoint> joints, const RobotJoint& fixed);

}  // namespace anholon
