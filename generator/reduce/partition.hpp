// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Which velocities are ruled by the dynamics (eta and the passive coordinates) and which are imposed.

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "describe/model.hpp"

namespace anholon {

/// Indices into the velocity vector (eta, r_dot) of size n + s, r in declared order.
struct Partition {
  int n = 0;
  std::vector<int> passive;  // eta, then r_p
  std::vector<int> active;   // r_a
  [[nodiscard]] int s_p() const { return static_cast<int>(passive.size()) - n; }
  [[nodiscard]] int s_a() const { return static_cast<int>(active.size()); }
};

/// @param torque_driven  active coordinates whose torque is given, reduced like passive ones; "*" for all of
/// them
inline Partition partition_of(const Model& model, const std::set<std::string>& torque_driven = {}) {
  Partition p;
  p.n = static_cast<int>(free_components(model.group).size());
  for (int i = 0; i < p.n; ++i) p.passive.push_back(i);
  std::vector<int> driven;
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    const Coordinate& c = model.coordinates[i];
    const int index = p.n + static_cast<int>(i);
    if (c.drive == Drive::passive) {
      p.passive.push_back(index);
    } else if (torque_driven.contains("*") || torque_driven.contains(c.name)) {
      driven.push_back(index);
    } else {
      p.active.push_back(index);
    }
  }
  p.passive.insert(p.passive.end(), driven.begin(), driven.end());
  return p;
}

/// Names of velocities: V_X, ..., and the coordinates.
inline std::vector<std::string> velocity_names(const Model& model) {
  std::vector<std::string> names;
  for (const int c : free_components(model.group))
    names.emplace_back(twist_component_names[static_cast<std::size_t>(c)]);
  for (const Coordinate& c : model.coordinates) names.push_back(c.name);
  return names;
}

}  // namespace anholon
