// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The robots of this folder, each written in three formats.

#include <filesystem>
#include <string>

#include "describe/read_robot.hpp"

namespace anholon::testing {

/// @param file  "arm.sdf", ...; the URDF of the walker does not say that it moves freely
inline Model robot(const std::string& file) {
  RobotOptions options;
  options.floating = file == "walker.urdf";
  return read_robot(std::filesystem::path(ANHOLON_SOURCE_DIR) / "tests" / "robot_files" / file, options);
}

}  // namespace anholon::testing
