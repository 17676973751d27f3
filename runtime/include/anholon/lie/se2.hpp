// SPDX-License-Identifier: MIT
//
// SE(2): the pose of a body that moves on the plane Z = 0, as (x, y, heading). Tangent: (V_X, V_Y, Omega_Z).
// The heading is kept unwrapped: it counts the turns made. Conventions in lie_group.hpp.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "anholon/lie/angle_functions.hpp"
#include "anholon/lie/lie_group.hpp"

namespace anholon::lie {

template <class Real>
class SE2 {
 public:
  using Scalar = Real;
  static constexpr int dim = 3;
  static constexpr int linear_dim = 2;
  using Vector3 = Eigen::Matrix<Real, 3, 1>;
  using Tangent = Eigen::Matrix<Real, dim, 1>;
  using Matrix = Eigen::Matrix<Real, dim, dim>;

  SE2() : x_(0), y_(0), theta_(0) {}
  /// @param x, y  position in the world [m]     @param theta  heading from the world's X axis [rad]
  SE2(Real x, Real y, Real theta) : x_(x), y_(y), theta_(theta) {}

  static SE2 identity() { return SE2(); }

  SE2 operator*(const SE2& other) const {
    using std::cos;
    using std::sin;
    const Real c = cos(theta_), s = sin(theta_);
    return SE2(x_ + (c * other.x_ - s * other.y_), y_ + (s * other.x_ + c * other.y_), theta_ + other.theta_);
  }

  SE2 inverse() const {
    using std::cos;
    using std::sin;
    const Real c = cos(theta_), s = sin(theta_);
    return SE2(-(c * x_ + s * y_), s * x_ - c * y_, -theta_);
  }

  /// exp(rho, omega): the pose after unit time at the constant body twist (rho [m], omega [rad]).
  ///
  ///   (x, y) = sinc(omega) rho + omega A J rho,   A = (1 - cos)/omega^2,  J = [0, -1; 1, 0]
  ///
  /// The heading is omega itself, whole turns included.
  static SE2 exp(const Tangent& xi) {
    using std::cos;
    const Real omega = xi[2];
    const Real sinc_half = sinc(omega / 2);
    const Real along = sinc_half * cos(omega / 2);            // sinc omega
    const Real across = omega * (sinc_half * sinc_half / 2);  // (1 - cos omega)/omega
    return SE2(along * xi[0] - across * xi[1], across * xi[0] + along * xi[1], omega);
  }

  /// (rho, omega) with |omega| <= pi: whole turns of the heading are left out, since exp does not reach the
  /// poses with a heading of 2 pi and a displacement.   rho = (x cot x) p - omega/2 J p,  x = omega/2
  Tangent log() const {
    using std::cos;
    using std::remainder;
    const Real two_pi = Real(6.2831853071795864769L);
    const Real omega = remainder(theta_, two_pi);
    const Real along = cos(omega / 2) / sinc(omega / 2);
    const Real across = omega / 2;
    return Tangent(along * x_ + across * y_, along * y_ - across * x_, omega);
  }

  /// Ad (3x3): twist components from B to W,  V_W = R V_B - Omega J p,  Omega_W = Omega_B
  Matrix adjoint() const {
    using std::cos;
    using std::sin;
    const Real c = cos(theta_), s = sin(theta_);
    Matrix Ad;
    Ad << c, -s, y_,  //
        s, c, -x_,    //
        Real(0), Real(0), Real(1);
    return Ad;
  }

  /// [(rho, omega), (V, Omega)] = (omega J V - Omega J rho, 0)
  static Tangent bracket(const Tangent& xi, const Tangent& eta) {
    return Tangent(eta[2] * xi[1] - xi[2] * eta[1], xi[2] * eta[0] - eta[2] * xi[0], Real(0));
  }

  /// xi_dot = dexp^-1_{-xi}(eta) where g = g0 exp(xi) has body velocity eta; |omega| < 2 pi.
  ///
  ///   xi_dot = eta + 1/2 ad_xi eta + c ad_xi^2 eta
  ///
  /// exact because ad_xi^3 = -omega^2 ad_xi. The product ad_xi^2 eta is (omega (Omega rho - omega V), 0).
  static Tangent dexp_inv(const Tangent& xi, const Tangent& eta) {
    const Real omega = xi[2];
    const Real c = dexp_inv_coefficients(omega * omega).c;
    const Tangent ad_eta = bracket(xi, eta);
    const Real c_omega = c * omega;
    return Tangent(eta[0] + ad_eta[0] / 2 + c_omega * (eta[2] * xi[0] - omega * eta[0]),
                   eta[1] + ad_eta[1] / 2 + c_omega * (eta[2] * xi[1] - omega * eta[1]), eta[2]);
  }

  /// R_WB (3x3): a turn about Z.
  Eigen::Matrix<Real, 3, 3> R() const {
    using std::cos;
    using std::sin;
    const Real c = cos(theta_), s = sin(theta_);
    Eigen::Matrix<Real, 3, 3> matrix;
    matrix << c, -s, Real(0),  //
        s, c, Real(0),         //
        Real(0), Real(0), Real(1);
    return matrix;
  }

  /// p_WB (3) [m], with p_Z = 0
  Vector3 p() const { return Vector3(x_, y_, Real(0)); }

  /// Nothing to do: every triple is an element of the group.
  void normalize() {}

  bool is_finite() const { return std::isfinite(x_) && std::isfinite(y_) && std::isfinite(theta_); }

  Real x() const { return x_; }
  Real y() const { return y_; }
  Real theta() const { return theta_; }  ///< heading [rad], unwrapped

 private:
  Real x_, y_, theta_;
};

static_assert(LieGroup<SE2<double>>);

}  // namespace anholon::lie
