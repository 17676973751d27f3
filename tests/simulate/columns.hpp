// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "simulate/simulation.hpp"

namespace anholon::testing {

inline const std::string root = ANHOLON_SOURCE_DIR;

inline Scene scene_of(const std::string& file) {
  return read_scene(root + "/models/" + file + ".scene.toml");
}

/// Index of the column of that name, whatever its unit.
inline std::size_t column_index(const SimulationResult& result, const std::string& name) {
  for (std::size_t i = 0; i < result.columns.size(); ++i) {
    if (result.columns[i].starts_with(name + " [")) return i;
  }
  ADD_FAILURE() << "no column " << name;
  return 0;
}

/// The last value of a column.
inline double column(const SimulationResult& result, const std::string& name) {
  return result.rows.back()[column_index(result, name)];
}

}  // namespace anholon::testing
