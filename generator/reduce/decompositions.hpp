// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Dense decompositions, compiled once: in every file that used them they would be most of its compile time.

#include <Eigen/Core>

#include "anholon/reduction.hpp"
#include "number/exact_eigen.hpp"

namespace anholon {

extern template class ConstraintFactors<double>;
extern template class ConstraintFactors<long double>;
extern template class ConstraintFactors<Exact>;
extern template ConstrainedSolution<double> solve_constrained(const DynamicMatrix<double>&,
                                                              const DynamicVector<double>&,
                                                              const DynamicMatrix<double>&,
                                                              const DynamicVector<double>&, const double&);
extern template ConstrainedSolution<Exact> solve_constrained(const DynamicMatrix<Exact>&,
                                                             const DynamicVector<Exact>&,
                                                             const DynamicMatrix<Exact>&,
                                                             const DynamicVector<Exact>&, const Exact&);

/// m = U diag(sigma) V^T, sigma falling; V is square.
struct SingularValues {
  Eigen::VectorXd sigma;
  Eigen::MatrixXd V;
};
SingularValues singular_values(const Eigen::MatrixXd& m);

/// Of a symmetric matrix, rising.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& m);

}  // namespace anholon
