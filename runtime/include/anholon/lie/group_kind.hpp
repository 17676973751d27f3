// SPDX-License-Identifier: MIT
#pragma once

// The groups of net motions that a description may name, and which components of a twist each leaves free.

#include <array>
#include <span>
#include <string_view>

namespace anholon {

enum class GroupKind { SE3, SE2, SO3, R1, R2, R3, fixed };

namespace detail {
inline constexpr std::array<int, 6> spatial_components = {0, 1, 2, 3, 4, 5};
inline constexpr std::array<int, 3> planar_components = {0, 1, 5};
}  // namespace detail

/// Components of the six-dimensional twist (V_X, V_Y, V_Z, Omega_X, Omega_Y, Omega_Z) that the group leaves
/// free.
constexpr std::span<const int> free_components(GroupKind group) {
  const std::span<const int> se3(detail::spatial_components);
  switch (group) {
    case GroupKind::SE3:
      return se3;
    case GroupKind::SE2:
      return detail::planar_components;
    case GroupKind::SO3:
      return se3.subspan(3, 3);
    case GroupKind::R1:
      return se3.first(1);
    case GroupKind::R2:
      return se3.first(2);
    case GroupKind::R3:
      return se3.first(3);
    case GroupKind::fixed:
      break;
  }
  return {};
}

constexpr std::string_view name(GroupKind group) {
  constexpr std::array<std::string_view, 7> names = {"SE3", "SE2", "SO3", "R1", "R2", "R3", "fixed"};
  return names[static_cast<std::size_t>(group)];
}

constexpr std::array<std::string_view, 6> twist_component_names = {"V_X",     "V_Y",     "V_Z",
                                                                   "Omega_X", "Omega_Y", "Omega_Z"};

}  // namespace anholon
