// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/numeric_reduction.hpp"

namespace anholon {
namespace {

constexpr double rank_threshold =
    1e-10;  // relative: between rounding (1e-16) and pivots of regular configurations

}  // namespace

DynamicVector<double> passive_accelerations(FreeDynamics<double>& dynamics, const State<double>& state,
                                            const Partition& partition, const DynamicVector<double>& active,
                                            const DynamicVector<double>& applied) {
  const std::vector<int>&p = partition.passive, &a = partition.active;
  const Matrix<double> M = dynamics.mass_matrix(state);
  const DynamicVector<double> force = to_eigen(dynamics.forces(state)) + applied;
  const auto [A, bias] = dynamics.constraints(state);
  std::vector<int> rows(static_cast<std::size_t>(A.rows()));
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<int>(i);
  DynamicVector<double> passive_force(static_cast<Eigen::Index>(p.size()));
  for (std::size_t i = 0; i < p.size(); ++i) passive_force(static_cast<Eigen::Index>(i)) = force(p[i]);
  passive_force -= to_eigen(M.block(p, a)) * active;
  return solve_constrained<double>(to_eigen(M.block(p, p)), passive_force, to_eigen(A.block(rows, p)),
                                   to_eigen(bias) + to_eigen(A.block(rows, a)) * active, rank_threshold)
      .acceleration;
}

DynamicVector<double> least_norm(const DynamicMatrix<double>& A, const DynamicVector<double>& b) {
  return ConstraintFactors<double>(A, rank_threshold).solve(b);
}

}  // namespace anholon
