// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/evaluate_recursion.hpp"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <type_traits>

#include "anholon/free_dynamics.hpp"
#include "reduce/decompositions.hpp"

namespace anholon {

namespace {

template <class S>
std::vector<S> from_eigen(const DynamicVector<S>& x) {
  return {x.data(), x.data() + x.size()};
}
template <class S>
Matrix<S> from_eigen(const DynamicMatrix<S>& x) {
  Matrix<S> m(static_cast<int>(x.rows()), static_cast<int>(x.cols()));
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) m(i, j) = x(i, j);
  }
  return m;
}

/// Constrained accelerations where the given rows carry everything: the others hold by themselves, at no
/// force.
template <class S>
ConstrainedSolution<S> solve_by_rows(const DynamicMatrix<S>& M, const DynamicVector<S>& force,
                                     const DynamicMatrix<S>& A, const DynamicVector<S>& bias,
                                     const S& threshold, const std::vector<int>& rows) {
  const DynamicMatrix<S> loaded = A(rows, Eigen::all);
  auto solution = solve_constrained<S>(M, force, loaded, bias(rows), threshold);
  const DynamicVector<S> carried = solution.multipliers;
  solution.multipliers = DynamicVector<S>::Zero(A.rows());
  for (std::size_t i = 0; i < rows.size(); ++i)
    solution.multipliers(rows[i]) = carried(static_cast<Eigen::Index>(i));
  return solution;
}

/// N s: each row beyond the leading ones carries its entry of s, and the leading ones balance it. The basis
/// N of ker A^T is that of the programs (lambda_stat_basis).
template <class S>
DynamicVector<S> static_loading(const DynamicMatrix<S>& A, const std::vector<int>& leading,
                                const std::vector<S>& s, const S& threshold) {
  DynamicVector<S> lambda = DynamicVector<S>::Zero(A.rows());
  const DynamicMatrix<S> loaded = A(leading, Eigen::all);
  const ConstraintFactors<S> factors(loaded, threshold);
  std::size_t next = 0;
  for (int row = 0; row < static_cast<int>(A.rows()); ++row) {
    if (std::ranges::find(leading, row) != leading.end()) continue;
    if (next == s.size()) throw std::invalid_argument("lambda_stat has too few entries");
    const DynamicVector<S> weights = factors.solve_transposed(A.row(row).transpose());
    for (std::size_t i = 0; i < leading.size(); ++i)
      lambda(leading[i]) -= s[next] * weights(static_cast<Eigen::Index>(i));
    lambda(row) += s[next++];
  }
  if (next != s.size()) throw std::invalid_argument("lambda_stat has too many entries");
  return lambda;
}

}  // namespace

template <class S>
Evaluated<S> evaluate_recursion(const Mechanism<S>& mechanism, const Partition& partition,
                                const EvaluationInput<S>& input, const S& threshold,
                                const RowSharing& sharing) {
  FreeDynamics<S> dynamics(mechanism);
  Evaluated<S> e;
  e.M = dynamics.mass_matrix(input.state);
  e.force = dynamics.forces(input.state);
  std::tie(e.G, e.bias) = dynamics.constraints(input.state);
  const auto energies = dynamics.energies(input.state);
  e.kinetic = energies.kinetic, e.gravity = energies.gravity, e.elastic = energies.elastic,
  e.dissipated_power = energies.dissipated_power;

  const std::vector<int>& passive = partition.passive;
  const std::vector<int>& active = partition.active;
  std::vector<int> rows(mechanism.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<int>(i);
  const DynamicMatrix<S> A = to_eigen(e.G.block(rows, passive));
  const DynamicMatrix<S> B = to_eigen(e.G.block(rows, active));
  const DynamicMatrix<S> M_pp = to_eigen(e.M.block(passive, passive));
  const DynamicMatrix<S> M_pa = to_eigen(e.M.block(passive, active));
  const DynamicVector<S> bias = to_eigen(e.bias);
  const auto pick = [](const std::vector<S>& v, const std::vector<int>& indices) {
    DynamicVector<S> r(static_cast<Eigen::Index>(indices.size()));
    for (std::size_t i = 0; i < indices.size(); ++i)
      r(static_cast<Eigen::Index>(i)) = v[static_cast<std::size_t>(indices[i])];
    return r;
  };
  e.least_norm = !sharing.leading;
  const auto solve = [&](const DynamicMatrix<S>& M, const DynamicVector<S>& force, const DynamicMatrix<S>& G,
                         const DynamicVector<S>& b, const std::vector<int>& leading) {
    return sharing.leading ? solve_by_rows<S>(M, force, G, b, threshold, leading)
                           : solve_constrained<S>(M, force, G, b, threshold);
  };
  const DynamicMatrix<S> Z = ConstraintFactors<S>(A, threshold).kernel();
  e.projector = from_eigen<S>(DynamicMatrix<S>(Z * Z.transpose()));

  if (input.has_acceleration) {
    DynamicVector<S> r_a_ddot(static_cast<Eigen::Index>(active.size()));
    for (std::size_t i = 0; i < active.size(); ++i)
      r_a_ddot(static_cast<Eigen::Index>(i)) =
          input.r_ddot[static_cast<std::size_t>(active[i] - partition.n)];
    DynamicVector<S> force = pick(e.force, passive) - M_pa * r_a_ddot;
    for (std::size_t i = 0; i < passive.size() && !input.tau.empty(); ++i) {
      if (passive[i] >= partition.n)  // torque-driven joints that the partition counts with the passive ones
        force(static_cast<Eigen::Index>(i)) += input.tau[static_cast<std::size_t>(passive[i] - partition.n)];
    }
    auto solution = solve(M_pp, force, A, DynamicVector<S>(bias + B * r_a_ddot), sharing.locked);
    if (!input.lambda_stat.empty())
      solution.multipliers += static_loading<S>(A, sharing.locked, input.lambda_stat, threshold);
    e.acceleration.assign(e.force.size(), S(0));
    for (std::size_t i = 0; i < passive.size(); ++i)
      e.acceleration[static_cast<std::size_t>(passive[i])] =
          solution.acceleration(static_cast<Eigen::Index>(i));
    for (std::size_t i = 0; i < active.size(); ++i)
      e.acceleration[static_cast<std::size_t>(active[i])] = r_a_ddot(static_cast<Eigen::Index>(i));
    e.lambda = from_eigen<S>(solution.multipliers);
    const DynamicMatrix<S> M_aa = to_eigen(e.M.block(active, active));
    const DynamicVector<S> tau = M_pa.transpose() * solution.acceleration + M_aa * r_a_ddot -
                                 pick(e.force, active) - B.transpose() * solution.multipliers;
    e.tau_a = from_eigen<S>(tau);
  }
  if (input.has_torque) {
    DynamicVector<S> force = to_eigen(e.force);
    for (const int i : active) force(i) += input.tau[static_cast<std::size_t>(i - partition.n)];
    const auto solution = solve(to_eigen(e.M), force, to_eigen(e.G), bias, sharing.free);
    e.free_acceleration = from_eigen<S>(solution.acceleration);
    e.free_lambda = from_eigen<S>(solution.multipliers);
  }
  return e;
}

template Evaluated<double> evaluate_recursion(const Mechanism<double>&, const Partition&,
                                              const EvaluationInput<double>&, const double&,
                                              const RowSharing&);
template Evaluated<Exact> evaluate_recursion(const Mechanism<Exact>&, const Partition&,
                                             const EvaluationInput<Exact>&, const Exact&, const RowSharing&);

template <class S>
std::vector<S> minimum_norm_solution(const Matrix<S>& A, const std::vector<S>& b) {
  S tolerance(0);  // of ranks: far above what the entries' own rounding leaves
  if constexpr (std::is_same_v<S, Exact>) {
    tolerance = Exact::from_decimal("1e-25");
  } else {
    tolerance = 1e-12L;
  }
  return from_eigen<S>(ConstraintFactors<S>(to_eigen(A), tolerance).solve(to_eigen(b)));
}

template std::vector<long double> minimum_norm_solution(const Matrix<long double>&,
                                                        const std::vector<long double>&);
template std::vector<Exact> minimum_norm_solution(const Matrix<Exact>&, const std::vector<Exact>&);

template <class S>
Matrix<S> range_projector(const Matrix<S>& H) {
  const DynamicMatrix<S> complement =
      ConstraintFactors<S>(DynamicMatrix<S>(to_eigen(H).transpose()), S(0)).kernel();
  return from_eigen<S>(
      DynamicMatrix<S>(DynamicMatrix<S>::Identity(H.rows(), H.rows()) - complement * complement.transpose()));
}

template Matrix<double> range_projector(const Matrix<double>&);
template Matrix<Exact> range_projector(const Matrix<Exact>&);

}  // namespace anholon
