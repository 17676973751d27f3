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
#include "urdf/random_state.hpp"

namespace anholon::testing {

/// Central inertia of a body about its mass centre, in the body's axes.
inline Mat3<double> central_inertia(const Body<double>& b, Vec3<double>& centre) {
  centre = b.mass == 0 ? Vec3<double>{} : (1 / b.mass) * b.first_moment;
  const double square = dot(centre, centre);
  Mat3<double> I = b.inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) I(i, j) -= b.mass * ((i == j ? square : 0.0) - centre[i] * centre[j]);
  }
  return I;
}

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
