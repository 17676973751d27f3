// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/decompositions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace anholon {

template class ConstraintFactors<double>;
template class ConstraintFactors<long double>;
template ConstrainedSolution<double> solve_constrained(const DynamicMatrix<double>&,
                                                       const DynamicVector<double>&,
                                                       const DynamicMatrix<double>&,
                                                       const DynamicVector<double>&, const double&);

SingularValues singular_values(const Eigen::MatrixXd& m) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(m, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace anholon
