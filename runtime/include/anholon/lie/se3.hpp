// SPDX-License-Identifier: MIT
//
// SE(3): the pose of a free body, as a unit quaternion and a position. Tangent: (V, Omega), linear part
// first. Conventions in lie_group.hpp. SE(3) is SO(3) over the dual numbers, Omega + epsilon V, so dexp^-1 of
// SE(3) is that of SO(3) together with its derivative (dual numbers: Selig 2005, "Geometric Fundamentals of
// Robotics").
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "anholon/lie/angle_functions.hpp"
#include "anholon/lie/lie_group.hpp"
#include "anholon/lie/so3.hpp"

namespace anholon::lie {

template <class Real>
class SE3 {
 public:
  using Scalar = Real;
  static constexpr int dim = 6;
  static constexpr int linear_dim = 3;
  using Vector3 = Eigen::Matrix<Real, 3, 1>;
  using Vector4 = Eigen::Matrix<Real, 4, 1>;
  using Tangent = Eigen::Matrix<Real, dim, 1>;
  using Matrix = Eigen::Matrix<Real, dim, dim>;

  SE3() : p_(Vector3::Zero()) {}
  /// @param rotation  R_WB     @param p  (3) p_WB [m]
  SE3(const SO3<Real>& rotation, const Vector3& p) : rotation_(rotation), p_(p) {}
  /// @param quaternion_wxyz  (4) scalar first, divided by its norm     @param p  (3) p_WB [m]
  SE3(const Vector4& quaternion_wxyz, const Vector3& p) : rotation_(quaternion_wxyz), p_(p) {}

  static SE3 identity() { return SE3(); }

  SE3 operator*(const SE3& other) const {
    return SE3(rotation_ * other.rotation_, p_ + rotation_.rotate(other.p_));
  }

  SE3 inverse() const {
    const SO3<Real> transposed = rotation_.inverse();
    return SE3(transposed, -transposed.rotate(p_));
  }

  /// exp(rho, theta): the pose after unit time at the constant body twist (rho, theta).
  ///
  ///   p = rho + A theta x rho + B theta x (theta x rho),   A = (1 - cos)/theta^2,  B = (theta - sin)/theta^3
  ///
  /// @param xi  (6) (rho [m], theta [rad])
  static SE3 exp(const Tangent& xi) {
    using std::cos;
    const Vector3 rho = xi.template head<3>(), theta = xi.template tail<3>();
    const Real square = theta.squaredNorm();
    const Real x = theta.norm() / 2;
    const Real cos_x = cos(x), sinc_x = sinc(x);
    const Real A = sinc_x * sinc_x / 2;
    const Real B = one_minus_sinc_over_square(square, sinc_x * cos_x);  // sinc 2x = sinc x cos x
    const Vector3 ad_rho = theta.cross(rho);
    return SE3(SO3<Real>::from_parts(cos_x, (sinc_x / 2) * theta),
               rho + A * ad_rho + B * theta.cross(ad_rho));
  }

  /// (rho, theta) with |theta| <= pi.   rho = p - 1/2 theta x p + c theta x (theta x p)
  Tangent log() const {
    const Vector3 theta = rotation_.log();
    const Real c = dexp_inv_coefficients(theta.squaredNorm()).c;
    const Vector3 ad_p = theta.cross(p_);
    Tangent xi;
    xi << p_ - ad_p / 2 + c * theta.cross(ad_p), theta;
    return xi;
  }

  /// Ad (6x6): twist components from B to W,  [V_W; Omega_W] = [R, p^ R; 0, R] [V_B; Omega_B]
  Matrix adjoint() const {
    const Eigen::Matrix<Real, 3, 3> rotation = R();
    Matrix Ad = Matrix::Zero();
    Ad.template topLeftCorner<3, 3>() = rotation;
    for (int j = 0; j < 3; ++j) Ad.template block<3, 1>(0, 3 + j) = p_.cross(rotation.col(j));
    Ad.template bottomRightCorner<3, 3>() = rotation;
    return Ad;
  }

  /// [(rho, theta), (V, Omega)] = (theta x V + rho x Omega, theta x Omega)
  static Tangent bracket(const Tangent& xi, const Tangent& eta) {
    const Vector3 rho = xi.template head<3>(), theta = xi.template tail<3>();
    const Vector3 V = eta.template head<3>(), Omega = eta.template tail<3>();
    Tangent result;
    result << theta.cross(V) + rho.cross(Omega), theta.cross(Omega);
    return result;
  }

  /// xi_dot = dexp^-1_{-xi}(eta) where g = g0 exp(xi) has body velocity eta; |theta| < 2 pi.
  ///
  ///   theta_dot = F(theta) Omega,     F = 1 + 1/2 theta^ + c theta^ theta^
  ///   rho_dot   = F(theta) V + (dF/dtheta · rho) Omega
  ///   dF/dtheta · rho = 1/2 rho^ + c (rho^ theta^ + theta^ rho^) + (c'/theta)(theta·rho) theta^ theta^
  static Tangent dexp_inv(const Tangent& xi, const Tangent& eta) {
    const Vector3 rho = xi.template head<3>(), theta = xi.template tail<3>();
    const Vector3 V = eta.template head<3>(), Omega = eta.template tail<3>();
    const auto [c, c_slope] = dexp_inv_coefficients(theta.squaredNorm());
    const Vector3 ad_Omega = theta.cross(Omega);
    const Vector3 ad_V = theta.cross(V) + rho.cross(Omega);  // linear part of ad_xi eta
    const Vector3 ad_ad_Omega = theta.cross(ad_Omega);
    const Vector3 ad_ad_V = theta.cross(ad_V) + rho.cross(ad_Omega);
    Tangent xi_dot;
    xi_dot << V + ad_V / 2 + c * ad_ad_V + (c_slope * theta.dot(rho)) * ad_ad_Omega,
        Omega + ad_Omega / 2 + c * ad_ad_Omega;
    return xi_dot;
  }

  /// R_WB (3x3): columns are the axes of the body in the world.
  Eigen::Matrix<Real, 3, 3> R() const { return rotation_.R(); }

  /// p_WB (3) [m]
  Vector3 p() const { return p_; }

  /// Brings the quaternion's norm back to 1 after many products; a change of the size of rounding only.
  void normalize() { rotation_.normalize(); }

  bool is_finite() const { return rotation_.is_finite() && p_.allFinite(); }

  const Vector4& quaternion_wxyz() const { return rotation_.quaternion_wxyz(); }
  const SO3<Real>& rotation() const { return rotation_; }

 private:
  SO3<Real> rotation_;
  Vector3 p_;
};

static_assert(LieGroup<SE3<double>>);

}  // namespace anholon::lie
