// SPDX-License-Identifier: MIT
//
// The group of one element: a fixed base, whose frame is the world's. Tangents have size 0.
// Conventions in lie_group.hpp.
#pragma once

#include <Eigen/Core>

#include "anholon/lie/lie_group.hpp"

namespace anholon::lie {

template <class Real>
class Trivial {
 public:
  using Scalar = Real;
  static constexpr int dim = 0;
  static constexpr int linear_dim = 0;
  using Vector3 = Eigen::Matrix<Real, 3, 1>;
  using Tangent = Eigen::Matrix<Real, dim, 1>;
  using Matrix = Eigen::Matrix<Real, dim, dim>;

  static Trivial identity() { return Trivial(); }

  Trivial operator*(const Trivial&) const { return Trivial(); }

  Trivial inverse() const { return Trivial(); }

  static Trivial exp(const Tangent&) { return Trivial(); }

  Tangent log() const { return Tangent(); }

  Matrix adjoint() const { return Matrix(); }

  static Tangent bracket(const Tangent&, const Tangent&) { return Tangent(); }

  static Tangent dexp_inv(const Tangent&, const Tangent&) { return Tangent(); }

  /// R_WB (3x3) = 1
  Eigen::Matrix<Real, 3, 3> R() const { return Eigen::Matrix<Real, 3, 3>::Identity(); }

  /// p_WB (3) [m] = 0
  Vector3 p() const { return Vector3::Zero(); }

  void normalize() {}

  bool is_finite() const { return true; }
};

static_assert(LieGroup<Trivial<double>>);

}  // namespace anholon::lie
