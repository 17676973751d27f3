// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Engines keep velocities in their own order and take those of a free base in axes of their own choice. A
// layout says which, and turns motions, forces and matrices into ours (eta linear first, then r_dot) and
// back.

#include <cstddef>
#include <functional>
#include <vector>

#include "robot.hpp"

namespace anholon::bench {

struct Layout {
  std::vector<std::size_t> at;  // of each of our velocities in theirs
  bool free_base = false;
  bool linear_in_world = false;   // velocity of the base's origin in world axes, else in the base's
  bool angular_in_world = false;  // angular velocity likewise

  [[nodiscard]] std::vector<double> velocity(const Sample& s) const;
  /// Derivatives of velocity(): in world axes that of the origin's velocity is its acceleration.
  [[nodiscard]] std::vector<double> acceleration(const Sample& s) const;
  /// Joint forces tau; none on the base.
  [[nodiscard]] std::vector<double> force(const Sample& s) const;

  using Entry = std::function<double(std::size_t)>;
  using MatrixEntry = std::function<double(std::size_t, std::size_t)>;
  /// (base wrench, tau) of theirs.
  [[nodiscard]] std::vector<double> our_force(const Sample& s, const Entry& theirs) const;
  /// (eta_dot, r_ddot) of theirs.
  [[nodiscard]] std::vector<double> our_acceleration(const Sample& s, const Entry& theirs) const;
  /// Mass matrix, row-major, of theirs.
  [[nodiscard]] std::vector<double> our_matrix(const Sample& s, const MatrixEntry& theirs) const;

 private:
  [[nodiscard]] std::vector<double> theirs(const Sample& s, const Spatial<double>& base,
                                           const std::vector<double>& joints) const;
  /// Turns the base's components into its own axes.
  void turn_base(const Sample& s, std::vector<double>& v) const;
};

/// A vector of one of these libraries, by its operator().
template <class Vector>
Layout::Entry entries_of(const Vector& v) {
  return [&v](std::size_t i) { return v(static_cast<int>(i)); };
}
template <class Matrix>
Layout::MatrixEntry matrix_entries_of(const Matrix& m) {
  return [&m](std::size_t i, std::size_t j) { return m(static_cast<int>(i), static_cast<int>(j)); };
}

}  // namespace anholon::bench
