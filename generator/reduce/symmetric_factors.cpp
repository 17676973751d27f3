// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/symmetric_factors.hpp"

namespace anholon {

SymmetricFactors::SymmetricFactors(const Matrix<Expr>& K)
    : L_(K.rows(), K.rows()), inverse_(static_cast<std::size_t>(K.rows())) {
  const int n = K.rows();
  Matrix<Expr> W(n, n);  // L D
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      Expr sum = K(i, j);
      for (int k = 0; k < j; ++k) sum -= W(i, k) * L_(j, k);
      W(i, j) = sum;
    }
    pivots_.push_back(W(j, j));
    inverse_[static_cast<std::size_t>(j)] = Expr(1) / W(j, j);
    for (int i = j + 1; i < n; ++i) L_(i, j) = W(i, j) * inverse_[static_cast<std::size_t>(j)];
  }
}

std::vector<Expr> SymmetricFactors::forward(std::vector<Expr> b) const {
  for (int i = 0; i < L_.rows(); ++i) {
    for (int k = 0; k < i; ++k) b[static_cast<std::size_t>(i)] -= L_(i, k) * b[static_cast<std::size_t>(k)];
  }
  return b;
}

std::vector<Expr> SymmetricFactors::scaled(std::vector<Expr> b) const {
  for (std::size_t i = 0; i < b.size(); ++i) b[i] = b[i] * inverse_[i];
  return b;
}

std::vector<Expr> SymmetricFactors::backward(std::vector<Expr> b) const {
  for (int i = L_.rows(); i-- > 0;) {
    for (int k = i + 1; k < L_.rows(); ++k)
      b[static_cast<std::size_t>(i)] -= L_(k, i) * b[static_cast<std::size_t>(k)];
  }
  return b;
}

}  // namespace anholon
