// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// From redundant rows to independent ones: C picks leading rows, or takes all of them by least squares.

#include <vector>

#include "anholon/matrix.hpp"
#include "tape/expr.hpp"

namespace anholon {

/// The m° x rows matrix C as a procedure.
class RowWeights {
 public:
  RowWeights() = default;
  /// C b are the picked entries.
  RowWeights(int rows, std::vector<int> picked) : rows_(rows), picked_(std::move(picked)) {}
  /// C b is such that R x = C b is the least squares solution of A_P x = b, R unit upper triangular: modified
  /// Gram-Schmidt with b carried along as a further column, which is backward stable (Bjorck 1967): errors go
  /// with the condition number of A_P, not with its square as with normal equations, and nothing is divided
  /// by zero while A_P has full column rank.
  /// @param A_P  rows x m°
  explicit RowWeights(const Matrix<Expr>& A_P);

  [[nodiscard]] std::vector<Expr> times(std::vector<Expr> b) const;
  [[nodiscard]] Matrix<Expr> times(const Matrix<Expr>& b) const;
  /// C^T mu; for the least squares kind, the solution of least norm of A_P^T lambda = R^T mu.
  [[nodiscard]] std::vector<Expr> transposed_times(const std::vector<Expr>& mu) const;

  /// What is left of b when its part in the range of A_P is taken off: lies in ker A_P^T.
  [[nodiscard]] std::vector<Expr> residual(std::vector<Expr> b) const;

 private:
  int rows_ = 0;
  std::vector<int> picked_;               // empty for the least squares kind
  std::vector<std::vector<Expr>> basis_;  // v_j, orthogonal
  std::vector<Expr> inverse_;             // 1/(v_j . v_j)
};

}  // namespace anholon
