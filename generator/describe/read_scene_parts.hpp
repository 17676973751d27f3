// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The parts of a scene that are files of their own: imposed motion, torques and the initial state.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "describe/reading.hpp"
#include "describe/scene.hpp"
#include "describe/table_reader.hpp"

namespace anholon {

/// motion = { r1 = "sin(t)" } or { table = "gait.csv" }.
void read_motion(TableReader& root, const std::filesystem::path& scene_file, Scene& scene, Reading& reading);

/// torque = { r1 = "-2*dot(r1)" }, of torque-driven coordinates.
void read_torques(TableReader& root, Scene& scene, Reading& reading);

/// initial = { pose, coordinates, velocities }.
void read_initial_state(TableReader& root, Scene& scene, Reading& reading);

/// drive = { steer = "motion", r1 = "torque", r2 = "passive" }: in place of the description's. To be read
/// first of all, since it says what the other parts may name.
void read_drive(TableReader& root, Scene& scene, Reading& reading);

/// contact_sets, [[phase]], continuous, contact_elasticity and lambda_stat.
void read_phases(TableReader& root, Scene& scene, Reading& reading);

/// Index of an independent coordinate; other names are errors.
std::optional<int> read_coordinate_name(const std::string& name, const Location& where, Reading& reading);

/// A list of different names out of `known`.
std::vector<std::string> read_names(const Value& value, std::string_view what,
                                    const std::vector<std::string>& known, Findings& findings);

}  // namespace anholon
