// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The reader of URDF files (the format of the ROS packages urdf and urdfdom). Every link becomes a body and
// every joint that moves a coordinate, in the order of the file, parents first; passes on the mechanism merge
// what is fixed.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "describe/model.hpp"

namespace anholon {

struct UrdfOptions {
  bool floating = false;          // the root link moves freely (SE3); else it is fixed to the world
  bool as_written = false;        // angles and axes exactly as their digits say; else those within 1e-10 of a
                                  // multiple of pi/4 or of a coordinate axis are taken for it
  bool symbolic_inertia = false;  // inertial figures become parameters; those that are zero stay zero, equal
                                  // ones among Ixx, Iyy and Izz of a link stay equal
  Exact gravity = Exact::from_decimal("9.81");  // along -z of the world, m/s^2
};

/// What a supplement adds before the inputs of the model's tape are made.
struct UrdfSupplement {
  std::vector<Parameter> parameters;
  std::vector<std::string> coupled;     // coordinates whose joints follow others: they are left out
  std::vector<Coordinate> coordinates;  // of bodies that the supplement adds, behind those of the file
};

/// Whether a path is that of a URDF file, by its ending: .urdf or .xml.
bool is_urdf(const std::filesystem::path& path);

/// @throws ModelError with everything that is wrong with it
Model read_urdf(const std::filesystem::path& path, const UrdfOptions& options = {},
                const UrdfSupplement& supplement = {});

/// Likewise from text. @param file_name  stands in messages; its last component becomes Model::file
Model read_urdf_text(std::string_view text, const std::string& file_name, const UrdfOptions& options = {},
                     const UrdfSupplement& supplement = {});

}  // namespace anholon
