// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The reader of URDF files (the format of the ROS packages urdf and urdfdom). Every link becomes a body and
// every joint that moves a coordinate, in the order of the file, parents first; passes on the mechanism merge
// what is fixed.

#include <filesystem>
#include <string>
#include <string_view>

#include "describe/model.hpp"

namespace anholon {

struct UrdfOptions {
  bool floating = false;          // the root link moves freely (SE3); else it is fixed to the world
  bool as_written = false;        // angles and axes exactly as their digits say; else those within 1e-10 of a
                                  // multiple of pi/4 or of a coordinate axis are taken for it
  bool symbolic_inertia = false;  // inertial figures become parameters, those that are zero stay zero
  Exact gravity = Exact::from_decimal("9.81");  // along -z of the world, m/s^2
};

/// @throws ModelError with everything that is wrong with it
Model read_urdf(const std::filesystem::path& path, const UrdfOptions& options = {});

/// Likewise from text. @param file_name  stands in messages; its last component becomes Model::file
Model read_urdf_text(std::string_view text, const std::string& file_name, const UrdfOptions& options = {});

}  // namespace anholon
