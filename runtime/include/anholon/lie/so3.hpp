// SPDX-License-Identifier: MIT
//
// SO(3): the orientation of a body that turns about a fixed point, as a unit quaternion. Tangent: Omega.
// Conventions in lie_group.hpp; quaternion formulas as in Shuster 1993, "A survey of attitude
// representations", with the scalar first and R(q1 q2) = R(q1) R(q2).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "anholon/lie/angle_functions.hpp"
#include "anholon/lie/lie_group.hpp"

namespace anholon::lie {

template <class Real>
class SO3 {
 public:
  using Scalar = Real;
  static constexpr int dim = 3;
  static constexpr int linear_dim = 0;
  using Vector3 = Eigen::Matrix<Real, 3, 1>;
  using Vector4 = Eigen::Matrix<Real, 4, 1>;
  using Tangent = Eigen::Matrix<Real, dim, 1>;
  using Matrix = Eigen::Matrix<Real, dim, dim>;

  SO3() : quaternion_wxyz_(Real(1), Real(0), Real(0), Real(0)) {}
  /// @param quaternion_wxyz  (4) scalar first; divided by its norm, which must not vanish
  explicit SO3(const Vector4& quaternion_wxyz) : quaternion_wxyz_(quaternion_wxyz) { normalize(); }

  static SO3 identity() { return SO3(); }

  SO3 operator*(const SO3& other) const {
    const Vector3 u = vector_part(), v = other.vector_part();
    const Real w = scalar_part(), s = other.scalar_part();
    return from_parts(w * s - u.dot(v), w * v + s * u + u.cross(v));
  }

  SO3 inverse() const { return from_parts(scalar_part(), -vector_part()); }

  /// exp(theta): turn by |theta| about theta.   q = (cos x, 1/2 sinc(x) theta),  x = |theta|/2
  /// @param theta  (3) rotation vector [rad]
  static SO3 exp(const Tangent& theta) {
    using std::cos;
    const Real x = theta.norm() / 2;
    return from_parts(cos(x), (sinc(x) / 2) * theta);
  }

  /// Rotation vector of least length, |log| <= pi; at half a turn one of the two.
  ///
  /// theta = 2 atan2(|u|, w) u/|u| of the quaternion (w, u) with w >= 0. The quotient keeps its digits for
  /// every |u| > 0, and near half a turn w, not |u|, carries the information, which is what atan2 uses.
  Tangent log() const {
    using std::abs;
    using std::atan2;
    const Real w = abs(scalar_part());
    const Real sign = scalar_part() < Real(0) ? Real(-1) : Real(1);  // q and -q are the same rotation
    const Real u_norm = vector_part().norm();
    if (u_norm == Real(0)) return (sign * 2 / w) * vector_part();
    return (sign * 2 * atan2(u_norm, w) / u_norm) * vector_part();
  }

  /// Ad: twist components from B to W, Omega_W = Ad Omega_B. Here Ad = R.
  Matrix adjoint() const { return R(); }

  /// [xi, eta] = ad_xi eta = xi x eta
  static Tangent bracket(const Tangent& xi, const Tangent& eta) { return xi.cross(eta); }

  /// theta_dot = dexp^-1_{-theta}(eta) where g = g0 exp(theta) has body velocity eta; |theta| < 2 pi.
  ///
  ///   theta_dot = eta + 1/2 theta x eta + c theta x (theta x eta)
  static Tangent dexp_inv(const Tangent& theta, const Tangent& eta) {
    const Real c = dexp_inv_coefficients(theta.squaredNorm()).c;
    const Tangent ad_eta = theta.cross(eta);
    return eta + ad_eta / 2 + c * theta.cross(ad_eta);
  }

  /// R_WB (3x3): columns are the axes of the body in the world.
  Eigen::Matrix<Real, 3, 3> R() const {
    const Real w = scalar_part();
    const Vector3 u = vector_part();
    const Real xx = u[0] * u[0], yy = u[1] * u[1], zz = u[2] * u[2];
    const Real xy = u[0] * u[1], yz = u[1] * u[2], zx = u[2] * u[0];
    Eigen::Matrix<Real, 3, 3> matrix;
    matrix << 1 - 2 * (yy + zz), 2 * (xy - w * u[2]), 2 * (zx + w * u[1]),  //
        2 * (xy + w * u[2]), 1 - 2 * (zz + xx), 2 * (yz - w * u[0]),        //
        2 * (zx - w * u[1]), 2 * (yz + w * u[0]), 1 - 2 * (xx + yy);
    return matrix;
  }

  /// p_WB (3) [m]: the fixed point is the origin.
  Vector3 p() const { return Vector3::Zero(); }

  /// Brings the norm back to 1 after many products; a change of the size of rounding only.
  void normalize() { quaternion_wxyz_ /= quaternion_wxyz_.norm(); }

  bool is_finite() const { return quaternion_wxyz_.allFinite(); }

  /// R v, from body to world components: v + 2 w (u x v) + 2 u x (u x v)
  Vector3 rotate(const Vector3& v) const {
    const Vector3 u = vector_part();
    const Vector3 twice_uv = 2 * u.cross(v);
    return v + scalar_part() * twice_uv + u.cross(twice_uv);
  }

  const Vector4& quaternion_wxyz() const { return quaternion_wxyz_; }

  /// From the scalar and vector parts of a quaternion that is already of unit length.
  static SO3 from_parts(Real w, const Vector3& u) {
    SO3 g;
    g.quaternion_wxyz_ << w, u;
    return g;
  }

 private:
  Real scalar_part() const { return quaternion_wxyz_[0]; }
  Vector3 vector_part() const { return quaternion_wxyz_.template tail<3>(); }

  Vector4 quaternion_wxyz_;
};

static_assert(LieGroup<SO3<double>>);

}  // namespace anholon::lie
