// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The numeric recursion and numeric reduction at one state, over double or Exact: no code is generated and no
// kernel basis is differentiated. Instantiated once, since factorisations over Exact are slow to compile.

#include "anholon/mechanism.hpp"
#include "check/evaluated.hpp"
#include "number/exact.hpp"
#include "reduce/partition.hpp"

namespace anholon {

/// How redundant rows share, as in the programs.
struct RowSharing {
  bool leading = false;           // the rows below carry everything; else all rows, with lambda of least norm
  std::vector<int> locked, free;  // leading independent rows of (A, B_p), and of (A, B_p, B_a)
};

/// @param threshold  relative size below which a pivot of the constraint matrix counts as zero
/// @throws std::invalid_argument where the input's lambda_stat has not one entry for each row beyond `locked`
template <class S>
Evaluated<S> evaluate_recursion(const Mechanism<S>& mechanism, const Partition& partition,
                                const EvaluationInput<S>& input, const S& threshold,
                                const RowSharing& sharing = {});

extern template Evaluated<double> evaluate_recursion(const Mechanism<double>&, const Partition&,
                                                     const EvaluationInput<double>&, const double&,
                                                     const RowSharing&);
extern template Evaluated<Exact> evaluate_recursion(const Mechanism<Exact>&, const Partition&,
                                                    const EvaluationInput<Exact>&, const Exact&,
                                                    const RowSharing&);

/// Minimum-norm least-squares solution of A x = b, for long double and Exact.
template <class S>
std::vector<S> minimum_norm_solution(const Matrix<S>& A, const std::vector<S>& b);

/// Orthogonal projector onto the range of H, of full column rank.
template <class S>
Matrix<S> range_projector(const Matrix<S>& H);

extern template Matrix<double> range_projector(const Matrix<double>&);
extern template Matrix<Exact> range_projector(const Matrix<Exact>&);

}  // namespace anholon
