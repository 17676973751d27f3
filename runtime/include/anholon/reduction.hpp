// SPDX-License-Identifier: MIT
#pragma once

// Numeric reduction at one state: rank decisions by pivoted orthogonal factorisation, accelerations from the
// projection onto the kernel (section III), minimum-norm multipliers (26) and torques (27). Basis-free: no
// derivative of a kernel is taken. Works over double, long double and any scalar that Eigen can factorise.

#include <Eigen/Dense>
#include <vector>

#include "anholon/matrix.hpp"

namespace anholon {

template <class S>
using DynamicMatrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
template <class S>
using DynamicVector = Eigen::Matrix<S, Eigen::Dynamic, 1>;

template <class S>
DynamicMatrix<S> to_eigen(const Matrix<S>& a) {
  DynamicMatrix<S> r(a.rows(), a.cols());
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < a.cols(); ++j) r(i, j) = a(i, j);
  }
  return r;
}
template <class S>
DynamicVector<S> to_eigen(const std::vector<S>& a) {
  DynamicVector<S> r(static_cast<Eigen::Index>(a.size()));
  for (std::size_t i = 0; i < a.size(); ++i) r(static_cast<Eigen::Index>(i)) = a[i];
  return r;
}

/// Complete orthogonal factorisations of a constraint matrix A (rows x cols): kernel, particular and dual
/// solutions.
template <class S>
class ConstraintFactors {
 public:
  /// @param threshold  relative size below which a pivot counts as zero
  ConstraintFactors(const DynamicMatrix<S>& A, const S& threshold);

  [[nodiscard]] Eigen::Index rank() const { return rank_; }
  /// Orthonormal basis of ker A, cols x (cols - rank).
  [[nodiscard]] DynamicMatrix<S> kernel() const;
  /// A^+ b: minimum-norm least-squares solution of A x = b.
  [[nodiscard]] DynamicVector<S> solve(const DynamicVector<S>& b) const;
  /// (A^T)^+ c: minimum-norm multipliers with A^T lambda = c.
  [[nodiscard]] DynamicVector<S> solve_transposed(const DynamicVector<S>& c) const;

 private:
  Eigen::Index rows_, cols_, rank_ = 0;
  Eigen::CompleteOrthogonalDecomposition<DynamicMatrix<S>> primal_, dual_;
};

// Not inline: a program may compile them once a scalar and declare them `extern template` elsewhere.
template <class S>
ConstraintFactors<S>::ConstraintFactors(const DynamicMatrix<S>& A, const S& threshold)
    : rows_(A.rows()), cols_(A.cols()) {
  if (rows_ == 0 || cols_ == 0) return;
  primal_.setThreshold(threshold);
  dual_.setThreshold(threshold);
  primal_.compute(A);
  dual_.compute(A.transpose());
  rank_ = dual_.rank();
}
template <class S>
DynamicMatrix<S> ConstraintFactors<S>::kernel() const {
  if (rank_ == 0) return DynamicMatrix<S>::Identity(cols_, cols_);
  return DynamicMatrix<S>(dual_.householderQ())
      .rightCols(cols_ - rank_);  // the first columns span the row space
}
template <class S>
DynamicVector<S> ConstraintFactors<S>::solve(const DynamicVector<S>& b) const {
  if (rank_ == 0) return DynamicVector<S>::Zero(cols_);
  return primal_.solve(b);
}
template <class S>
DynamicVector<S> ConstraintFactors<S>::solve_transposed(const DynamicVector<S>& c) const {
  if (rank_ == 0) return DynamicVector<S>::Zero(rows_);
  return dual_.solve(c);
}

/// Accelerations and multipliers of M x_dot = force + A^T lambda under A x_dot = -bias.
template <class S>
struct ConstrainedSolution {
  DynamicVector<S> acceleration;
  DynamicVector<S> multipliers;  // minimum norm
  Eigen::Index rank = 0;
};

template <class S>
ConstrainedSolution<S> solve_constrained(const DynamicMatrix<S>& M, const DynamicVector<S>& force,
                                         const DynamicMatrix<S>& A, const DynamicVector<S>& bias,
                                         const S& threshold) {
  const ConstraintFactors<S> factors(A, threshold);
  ConstrainedSolution<S> solution;
  solution.rank = factors.rank();
  const DynamicMatrix<S> Z = factors.kernel();
  solution.acceleration = factors.solve(-bias);
  if (Z.cols() > 0) {
    const DynamicMatrix<S> reduced = Z.transpose() * M * Z;
    const DynamicVector<S> reduced_force = Z.transpose() * (force - M * solution.acceleration);
    solution.acceleration += Z * reduced.partialPivLu().solve(reduced_force);
  }
  solution.multipliers = factors.solve_transposed(DynamicVector<S>(M * solution.acceleration - force));
  return solution;
}

}  // namespace anholon
