// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The reader of SDFormat, versions 1.5 to 1.12: one model of links and joints. Its poses are those of the
// initial configuration, in the frames that the file names; numbers stand in the text of elements.

#include "describe/robot_file.hpp"
#include "describe/xml_source.hpp"

namespace anholon {

/// @param snap  whether angles near exact ones are taken for them
/// @throws ModelError with everything that is wrong with single elements
RobotFile read_sdf_elements(const XmlSource& source, bool snap);

}  // namespace anholon
