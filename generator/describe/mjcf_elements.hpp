// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The reader of MJCF, the format of MuJoCo: nested bodies with any number of hinges and slides each, and
// classes of defaults.

#include "describe/robot_file.hpp"
#include "describe/xml_source.hpp"

namespace anholon {

/// @param snap  whether angles near exact ones are taken for them
/// @throws ModelError with everything that is wrong with single elements
RobotFile read_mjcf_elements(const XmlSource& source, bool snap);

}  // namespace anholon
