// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The reader of robot files: URDF, SDFormat and MJCF. Every link becomes a body and every joint that moves a
// coordinate, in the order of the file, parents first; passes on the mechanism merge what is fixed.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "describe/model.hpp"

namespace anholon {

struct RobotOptions {
  bool floating = false;          // the root link moves freely (SE3), where the format does not say it
  bool as_written = false;        // angles and axes exactly as their digits say; else those within 1e-10 of a
                                  // multiple of pi/4 or of a coordinate axis are taken for it
  bool symbolic_inertia = false;  // inertial figures become parameters; those that are zero stay zero, equal
                                  // ones among Ixx, Iyy and Izz of a link stay equal
  std::optional<Exact> gravity;   // along -z of the world, m/s^2; else the file's, or 9.81
};

/// What a supplement adds before the inputs of the model's tape are made.
struct RobotSupplement {
  std::vector<Parameter> parameters;
  std::vector<std::string> coupled;     // coordinates whose joints follow others: they are left out
  std::vector<Coordinate> coordinates;  // of bodies that the supplement adds, behind those of the file
};

enum class RobotFormat { urdf, sdf, mjcf };

/// Whether a path is that of a robot file, by its ending: .urdf, .sdf, .mjcf or .xml. Which format it is, its
/// outermost element says.
bool is_robot_file(const std::filesystem::path& path);
/// "URDF", "SDFormat", "MJCF"
std::string_view name_of(RobotFormat format);

/// @param expected  an error where the file is of another format
/// @throws ModelError with everything that is wrong with it
Model read_robot(const std::filesystem::path& path, const RobotOptions& options = {},
                 const RobotSupplement& supplement = {}, std::optional<RobotFormat> expected = {});

/// Likewise from text. @param file_name  stands in messages; its last component becomes Model::file
Model read_robot_text(std::string_view text, const std::string& file_name, const RobotOptions& options = {},
                      const RobotSupplement& supplement = {});

}  // namespace anholon
