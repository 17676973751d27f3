// SPDX-License-Identifier: MIT
//
// R^k, k = 1, 2 or 3: the position of a body that slides without turning along the first k axes of the world.
// Tangent: its velocity. Everything is linear here. Conventions in lie_group.hpp.
#pragma once

#include <Eigen/Core>

#include "anholon/lie/lie_group.hpp"

namespace anholon::lie {

template <class Real, int k>
class Translation {
  static_assert(1 <= k && k <= 3, "a translation group has one, two or three axes");

 public:
  using Scalar = Real;
  static constexpr int dim = k;
  static constexpr int linear_dim = k;
  using Vector3 = Eigen::Matrix<Real, 3, 1>;
  using Tangent = Eigen::Matrix<Real, dim, 1>;
  using Matrix = Eigen::Matrix<Real, dim, dim>;

  Translation() : position_(Tangent::Zero()) {}
  /// @param position  (k) along the first k axes of the world [m]
  explicit Translation(const Tangent& position) : position_(position) {}

  static Translation identity() { return Translation(); }

  Translation operator*(const Translation& other) const { return Translation(position_ + other.position_); }

  Translation inverse() const { return Translation(-position_); }

  static Translation exp(const Tangent& xi) { return Translation(xi); }

  Tangent log() const { return position_; }

  Matrix adjoint() const { return Matrix::Identity(); }

  static Tangent bracket(const Tangent&, const Tangent&) { return Tangent::Zero(); }

  /// xi_dot = eta
  static Tangent dexp_inv(const Tangent&, const Tangent& eta) { return eta; }

  /// R_WB (3x3) = 1
  Eigen::Matrix<Real, 3, 3> R() const { return Eigen::Matrix<Real, 3, 3>::Identity(); }

  /// p_WB (3) [m]: the axes that are not used stay 0
  Vector3 p() const {
    Vector3 position = Vector3::Zero();
    position.template head<k>() = position_;
    return position;
  }

  /// Nothing to do: every vector is an element of the group.
  void normalize() {}

  bool is_finite() const { return position_.allFinite(); }

 private:
  Tangent position_;
};

static_assert(LieGroup<Translation<double, 1>>);

}  // namespace anholon::lie
