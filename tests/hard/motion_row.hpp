// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Quantities of a row of a trajectory by their names.

#include <fmt/format.h>

#include <array>
#include <string>

#include "simulate/columns.hpp"
#include "simulate/simulation.hpp"

namespace anholon::testing {

struct MotionRow {
  const SimulationResult& result;
  std::size_t row;
  double operator()(const std::string& name) const { return result.rows[row][column_index(result, name)]; }
};

inline std::array<double, 3> Omega(const MotionRow& at) {
  return {at("Omega_X"), at("Omega_Y"), at("Omega_Z")};
}

/// World axes of a vector with these components in the body's.
inline std::array<double, 3> in_world(const MotionRow& at, const std::array<double, 3>& v) {
  std::array<double, 3> w{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) w[i] += at(fmt::format("R_{}{}", "XYZ"[i], "XYZ"[j])) * v[j];
  }
  return w;
}

}  // namespace anholon::testing
