// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The reader of URDF (the format of the ROS packages urdf and urdfdom): every element and attribute is known,
// every number is exact.

#include "describe/robot_file.hpp"
#include "describe/xml_source.hpp"

namespace anholon {

/// @param snap  whether angles near exact ones are taken for them
/// @throws ModelError with everything that is wrong with single elements
RobotFile read_urdf_elements(const XmlSource& source, bool snap);

}  // namespace anholon
