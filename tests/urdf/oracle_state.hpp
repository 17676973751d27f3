// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Derived functions against an engine that is not ours: the same numbers in, the largest relative difference
// out.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "derive/tree_functions.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_robot.hpp"
#include "urdf/central_inertia.hpp"
#include "urdf/random_state.hpp"

namespace anholon::testing {

inline double difference(const std::vector<double>& got, const std::vector<double>& want) {
  double worst = got.size() == want.size() ? 0 : 1, scale = 0;
  for (std::size_t i = 0; i < std::min(got.size(), want.size()); ++i) {
    worst = std::max(worst, std::abs(got[i] - want[i]));
    scale = std::max(scale, std::abs(want[i]));
  }
  return scale > 0 ? worst / scale : worst;
}

inline Mechanism<double> mechanism_of(const Model& model) {
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  return mechanise<double>(describe_mechanism(model), parameters);
}

/// A robot that this project ships.
inline Model shipped_robot(const std::string& name) {
  RobotOptions options;
  options.floating = name != "arm7";
  return read_robot(std::filesystem::path(ANHOLON_SOURCE_DIR) / "models" / name / (name + ".urdf"), options);
}

}  // namespace anholon::testing
