// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// K = L D L^T of a symmetric positive definite matrix, on the tape.

#include <vector>

#include "anholon/matrix.hpp"
#include "tape/expr.hpp"

namespace anholon {

class SymmetricFactors {
 public:
  /// Pivots in the order of the rows: what is zero in front of the first entry of a row stays zero.
  explicit SymmetricFactors(const Matrix<Expr>& K);

  /// x of L x = b, of D x = b and of L^T x = b; one after the other they solve K x = b.
  [[nodiscard]] std::vector<Expr> forward(std::vector<Expr> b) const;
  [[nodiscard]] std::vector<Expr> scaled(std::vector<Expr> b) const;
  [[nodiscard]] std::vector<Expr> backward(std::vector<Expr> b) const;
  [[nodiscard]] const std::vector<Expr>& pivots() const { return pivots_; }

 private:
  Matrix<Expr> L_;
  std::vector<Expr> pivots_, inverse_;  // the entries of D
};

}  // namespace anholon
