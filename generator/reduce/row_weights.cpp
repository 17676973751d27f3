// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/row_weights.hpp"

namespace anholon {
namespace {

Expr inner(const std::vector<Expr>& a, const std::vector<Expr>& b) {
  Expr sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

void subtract(std::vector<Expr>& a, const Expr& factor, const std::vector<Expr>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= factor * b[i];
}

std::vector<Expr> column(const Matrix<Expr>& m, int j) {
  std::vector<Expr> c;
  for (int i = 0; i < m.rows(); ++i) c.push_back(m(i, j));
  return c;
}

}  // namespace

RowWeights::RowWeights(const Matrix<Expr>& A_P) : rows_(A_P.rows()) {
  for (int j = 0; j < A_P.cols(); ++j) {
    std::vector<Expr> v = column(A_P, j);
    for (std::size_t k = 0; k < basis_.size(); ++k) subtract(v, inner(basis_[k], v) * inverse_[k], basis_[k]);
    inverse_.push_back(Expr(1) / inner(v, v));
    basis_.push_back(std::move(v));
  }
}

std::vector<Expr> RowWeights::times(std::vector<Expr> b) const {
  std::vector<Expr> result;
  for (const int i : picked_) result.push_back(b[static_cast<std::size_t>(i)]);
  for (std::size_t j = 0; j < basis_.size(); ++j) {
    result.push_back(inner(basis_[j], b) * inverse_[j]);
    if (j + 1 < basis_.size()) subtract(b, result.back(), basis_[j]);
  }
  return result;
}

Matrix<Expr> RowWeights::times(const Matrix<Expr>& b) const {
  Matrix<Expr> result(static_cast<int>(picked_.size() + basis_.size()), b.cols());
  for (int j = 0; j < b.cols(); ++j) {
    const std::vector<Expr> c = times(column(b, j));
    for (int i = 0; i < result.rows(); ++i) result(i, j) = c[static_cast<std::size_t>(i)];
  }
  return result;
}

std::vector<Expr> RowWeights::residual(std::vector<Expr> b) const {
  for (std::size_t j = 0; j < basis_.size(); ++j) subtract(b, inner(basis_[j], b) * inverse_[j], basis_[j]);
  return b;
}

std::vector<Expr> RowWeights::transposed_times(const std::vector<Expr>& mu) const {
  std::vector<Expr> lambda(static_cast<std::size_t>(rows_), Expr(0));
  for (std::size_t i = 0; i < picked_.size(); ++i) lambda[static_cast<std::size_t>(picked_[i])] = mu[i];
  for (std::size_t j = basis_.size(); j-- > 0;)
    subtract(lambda, (inner(basis_[j], lambda) - mu[j]) * inverse_[j], basis_[j]);
  return lambda;
}

}  // namespace anholon
