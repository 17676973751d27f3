// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Gaussian elimination on a tape: factors a full-row-rank matrix of expressions once and writes solutions for
// further right-hand sides, so that the drift of a kernel is one augmented column instead of a differentiated
// matrix.

#include <functional>
#include <stdexcept>
#include <vector>

#include "anholon/matrix.hpp"
#include "tape/expr.hpp"

namespace anholon {

/// Values of nodes at every sampled configuration: result[sample][node].
using Sampler = std::function<std::vector<std::vector<double>>(const std::vector<NodeId>&)>;

struct RankDeficient : std::runtime_error {
  RankDeficient() : std::runtime_error("elimination of a matrix without full row rank") {}
};

class Elimination {
 public:
  /// Pivots: constants of unit size first, then constants, then what stays away from zero at the samples,
  /// with the least fill-in.
  /// @param A  rows x cols of full row rank
  /// @param columns  columns that may hold pivots
  /// @throws RankDeficient where they are dependent
  Elimination(Tape& tape, Matrix<Expr> A, const std::vector<int>& columns, const Sampler& sampler);

  /// Columns that hold the pivots, in ascending order.
  [[nodiscard]] std::vector<int> pivot_columns() const;
  /// Smallest pivot relative to the largest entry of its row, over the samples; zero where the rows lose rank
  /// at one of them.
  [[nodiscard]] double smallest_pivot() const { return smallest_pivot_; }
  /// x (cols) with A x = b and zeros outside the pivot columns.
  [[nodiscard]] std::vector<Expr> solve(std::vector<Expr> b) const;
  /// mu (rows) with A_P^T mu = c_P on the pivot columns P.
  [[nodiscard]] std::vector<Expr> solve_transposed(const std::vector<Expr>& c) const;
  /// Whether every pivot is a number: then nothing can vanish that is divided by.
  [[nodiscard]] bool has_constant_pivots() const;
  /// Factors by which rows are added to others; large where a pivot is small.
  [[nodiscard]] std::vector<Expr> factors() const;
  /// Column j of A as a right-hand side.
  [[nodiscard]] std::vector<Expr> column(int j) const;

 private:
  struct Pivot {
    int row, col;
    Expr inverse;
  };
  struct Factor {
    int target, row;
    Expr value;
  };
  Matrix<Expr> A_;  // as given
  Matrix<Expr> U_;  // after elimination, rows in place
  std::vector<Pivot> pivots_;
  std::vector<Factor> factors_;
  double smallest_pivot_ = 1e300;
};

/// Solves the symmetric positive definite system K x = b by LDL^T on the tape.
std::vector<std::vector<Expr>> solve_symmetric(const Matrix<Expr>& K,
                                               const std::vector<std::vector<Expr>>& right_hand_sides);

/// H = Q R with orthogonal columns of Q, not normalised, and ones on the diagonal of the upper triangle R:
/// modified Gram-Schmidt. Where a kernel basis is almost singular its columns are large and almost parallel;
/// a mass matrix on Q loses none of the digits that one on H loses there.
struct OrthogonalBasis {
  Matrix<Expr> Q, R;
  /// x with R x = b
  [[nodiscard]] std::vector<Expr> solve(std::vector<Expr> b) const;
};
OrthogonalBasis orthogonal_basis(const Matrix<Expr>& H);

}  // namespace anholon
