// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The links and joints of a URDF file as it writes them, after strict reading: every element and attribute is
// known, every number is exact. What they mean together is read_urdf's matter.

#include <optional>
#include <string>
#include <vector>

#include "describe/exact_rotation.hpp"
#include "describe/findings.hpp"
#include "describe/xml_source.hpp"

namespace anholon {

struct UrdfOrigin {
  ExactVector xyz = {0, 0, 0};
  ExactVector rpy = {0, 0, 0};
};

struct UrdfInertial {
  UrdfOrigin origin;
  Exact mass;
  std::array<Exact, 6> inertia;  // xx yy zz xy xz yz about the centre of mass
  Location where;
};

struct UrdfLink {
  std::string name;
  std::optional<UrdfInertial> inertial;
  Location where;
};

enum class UrdfJointType { revolute, continuous, prismatic, fixed, floating, planar };

struct UrdfMimic {
  std::string joint;
  Exact multiplier = 1;
  Exact offset = 0;
  Location where;
};

struct UrdfJoint {
  std::string name;
  UrdfJointType type = UrdfJointType::fixed;
  std::string parent, child;
  UrdfOrigin origin;
  ExactVector axis = {1, 0, 0};
  std::optional<std::array<Exact, 2>> limit;
  Exact damping = 0;
  Exact friction = 0;
  std::optional<UrdfMimic> mimic;
  Location where, parent_where, child_where;
};

struct UrdfFile {
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  std::vector<std::string> notes;  // what was left out
};

/// @throws ModelError with everything that is wrong with single elements
UrdfFile read_urdf_elements(const XmlSource& source);

}  // namespace anholon
