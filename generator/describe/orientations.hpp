// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The ways in which robot files write orientations, as exact rotation matrices. Angles within 1e-10 of a
// multiple of pi/4, and matrices within 1e-10 of those of the cube's turns by such angles, are taken for them
// where snapping is on; a note is kept of each.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "describe/exact_rotation.hpp"

namespace anholon {

class Orientations {
 public:
  explicit Orientations(bool snap) : snap_(snap) {}

  /// Rz(yaw) Ry(pitch) Rx(roll). @param of  whose orientation it is, for notes
  ExactMatrix rpy(const ExactVector& angles, const std::string& of);
  /// Turns about axes 0, 1, 2 one after the other, each about the axis as the one before left it.
  ExactMatrix euler(const std::array<std::size_t, 3>& axes, const ExactVector& angles, const std::string& of);
  /// Of a quaternion of any length but zero, scalar part first.
  ExactMatrix quaternion(const std::array<Exact, 4>& wxyz, const std::string& of);
  /// The turn by an angle about an axis of any length but zero.
  ExactMatrix axis_angle(const ExactVector& axis, const Exact& angle, const std::string& of);
  /// The frame with the x axis along x and the y axis next to y; they are not parallel.
  ExactMatrix x_and_y(const ExactVector& x, const ExactVector& y, const std::string& of);
  /// The least turn that takes the z axis to a direction; half a turn about x to the opposite one.
  ExactMatrix z_axis(const ExactVector& z, const std::string& of);

  /// "snapped: ..." for each orientation that was
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  ExactMatrix angle(std::size_t axis, const Exact& value, std::string_view name, const std::string& of);
  ExactMatrix snapped(const ExactMatrix& R, const std::string& of);

  bool snap_;
  std::vector<std::string> notes_;
};

}  // namespace anholon
