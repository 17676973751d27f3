// SPDX-License-Identifier: MIT
//
// Small measures of how far a computed motion has strayed from laws that the exact one keeps: a rotation
// stays orthonormal, energy balances, constraints hold.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace anholon {

/// ||R^T R - 1||, the Frobenius norm; 0 for a rotation.
/// @param R  (3x3)
template <class Derived>
typename Derived::Scalar orthonormality_defect(const Eigen::MatrixBase<Derived>& R) {
  using Matrix3 = Eigen::Matrix<typename Derived::Scalar, 3, 3>;
  const Matrix3 rotation = R;
  return (rotation.transpose() * rotation - Matrix3::Identity()).norm();
}

/// Balance of energy along a motion,
///
///   defect = ( E(t) - E(0) - work(t) + dissipated(t) ) / scale
///
/// where work is what actuators and external forces have put in since the start and dissipated what dampers
/// have taken out (both best integrated along with the motion, as quadratures in y). Remembers the largest
/// defect.
template <class Real>
class EnergyBalance {
 public:
  /// @param initial_energy  E(0) = T + V [J]
  /// @param scale           an energy of ordinary size for this motion, such as its largest T [J], > 0;
  ///                        not E, whose zero is arbitrary
  EnergyBalance(Real initial_energy, Real scale) : initial_energy_(initial_energy), scale_(scale) {}

  /// @param energy, work, dissipated  E(t), and what has gone in and out since the start [J]
  /// @return defect, relative to the scale, with its sign
  Real observe(Real energy, Real work = Real(0), Real dissipated = Real(0)) {
    using std::abs;
    const Real defect = ((energy - initial_energy_) - work + dissipated) / scale_;
    if (abs(defect) > largest_ || defect != defect) largest_ = abs(defect);  // keeps not-a-number
    return defect;
  }

  Real largest() const { return largest_; }  ///< largest |defect| observed

 private:
  Real initial_energy_, scale_;
  Real largest_ = Real(0);
};

/// Largest violation of the constraints A v = 0, max_i |sum_j A_ij v_j|; 0 if there are none.
/// @param A  (m x n)     @param v  (n) velocities     @return in the unit of A v
template <class DerivedA, class DerivedV>
typename DerivedA::Scalar constraint_residual(const Eigen::MatrixBase<DerivedA>& A,
                                              const Eigen::MatrixBase<DerivedV>& v) {
  using std::abs;
  using Real = typename DerivedA::Scalar;
  Real largest = Real(0);
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    Real row = Real(0);
    for (Eigen::Index j = 0; j < A.cols(); ++j) row += A(i, j) * v[j];
    if (abs(row) > largest || row != row) largest = abs(row);  // keeps not-a-number
  }
  return largest;
}

/// The same in units of what cancels: max_i |sum_j A_ij v_j| / max_i sum_j |A_ij v_j|, from 0 to 1; about the
/// unit of rounding when only rounding is at fault. 0 where all terms vanish.
template <class DerivedA, class DerivedV>
typename DerivedA::Scalar relative_constraint_residual(const Eigen::MatrixBase<DerivedA>& A,
                                                       const Eigen::MatrixBase<DerivedV>& v) {
  using std::abs;
  using Real = typename DerivedA::Scalar;
  Real scale = Real(0);
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    Real row = Real(0);
    for (Eigen::Index j = 0; j < A.cols(); ++j) row += abs(A(i, j) * v[j]);
    scale = std::max(scale, row);
  }
  const Real residual = constraint_residual(A, v);
  return scale > Real(0) ? residual / scale : residual;
}

}  // namespace anholon
