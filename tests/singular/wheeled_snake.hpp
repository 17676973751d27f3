// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "describe/read_model.hpp"

namespace anholon::test {

inline std::string models_folder() { return std::string(ANHOLON_SOURCE_DIR) + "/models/"; }

inline Model shipped(const std::string& name) {
  return read_model(models_folder() + name + "/" + name + ".toml");
}

/// The shipped wheeled snake with other drives: each joint "passive" or "active".
inline Model wheeled_snake(const std::string& drive_1, const std::string& drive_2) {
  Model model = shipped("wheeled_snake3");
  model.coordinates[0].drive = drive_1 == "active" ? Drive::active : Drive::passive;
  model.coordinates[1].drive = drive_2 == "active" ? Drive::active : Drive::passive;
  return model;
}

}  // namespace anholon::test
