// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/elimination.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "reduce/symmetric_factors.hpp"

namespace anholon {

Elimination::Elimination(Tape& tape, Matrix<Expr> A, const std::vector<int>& columns, const Sampler& sampler)
    : A_(std::move(A)), U_(A_) {
  std::vector<char> row_done(static_cast<std::size_t>(U_.rows()), 0);
  std::vector<char> col_done(static_cast<std::size_t>(U_.cols()), 1);
  for (const int c : columns) col_done[static_cast<std::size_t>(c)] = 0;
  for (int step = 0; step < U_.rows(); ++step) {
    std::vector<NodeId> nodes;
    for (int i = 0; i < U_.rows(); ++i) {
      for (int j = 0; j < U_.cols(); ++j) nodes.push_back(U_(i, j).id(tape));
    }
    const auto values = sampler(nodes);
    const auto at = [&](std::size_t sample, int i, int j) {
      return std::abs(values[sample][static_cast<std::size_t>(i * U_.cols() + j)]);
    };
    // smallest size of an entry over the samples, relative to its row's largest candidate there
    const auto strength = [&](int i, int j) {
      double smallest = std::numeric_limits<double>::infinity();
      for (std::size_t s = 0; s < values.size(); ++s) {
        double largest = 0;
        for (int c = 0; c < U_.cols(); ++c) {
          if (col_done[static_cast<std::size_t>(c)] == 0) largest = std::max(largest, at(s, i, c));
        }
        // a row without any entry there loses rank whatever the pivot: no reason against this one
        if (!std::isfinite(largest) || largest < 1e-12) continue;
        smallest = std::min(smallest, at(s, i, j) / largest);
      }
      return smallest;
    };
    const auto fill = [&](int i, int j) {
      int in_row = -1, in_col = -1;
      for (int c = 0; c < U_.cols(); ++c) in_row += U_(i, c).is_zero() ? 0 : 1;
      for (int r = 0; r < U_.rows(); ++r)
        in_col += row_done[static_cast<std::size_t>(r)] != 0 || U_(r, j).is_zero() ? 0 : 1;
      return in_row * in_col;
    };
    struct Choice {
      int tier, fill;  // tier 0: constant of unit size, 1: constant, 2: well away from zero, 3: anything else
      double strength;
      int row, col;
    };
    std::vector<Choice> choices;
    for (int i = 0; i < U_.rows(); ++i) {
      if (row_done[static_cast<std::size_t>(i)] != 0) continue;
      for (int j = 0; j < U_.cols(); ++j) {
        if (col_done[static_cast<std::size_t>(j)] != 0 || U_(i, j).is_zero()) continue;
        const NodeId id = U_(i, j).id(tape);
        const double s = strength(i, j);
        int tier = s > 0.05 ? 2 : 3;
        if (tape.is_constant(id)) tier = abs(tape.value(id)) == Exact(1) ? 0 : 1;
        choices.push_back({tier, fill(i, j), s, i, j});
      }
    }
    if (choices.empty()) throw RankDeficient();
    const Choice best = *std::ranges::min_element(choices, [](const Choice& a, const Choice& b) {
      if (a.tier != b.tier) return a.tier < b.tier;
      if (a.tier == 3 && a.strength != b.strength) return a.strength > b.strength;
      if (a.fill != b.fill) return a.fill < b.fill;
      return std::pair(a.row, a.col) < std::pair(b.row, b.col);
    });
    smallest_pivot_ = std::min(smallest_pivot_, best.tier <= 1 ? 1.0 : best.strength);
    for (std::size_t s = 0; s < values.size() && best.tier > 1; ++s) {  // the rows lose rank there
      if (at(s, best.row, best.col) < 1e-12) smallest_pivot_ = 0;
    }
    row_done[static_cast<std::size_t>(best.row)] = 1;
    col_done[static_cast<std::size_t>(best.col)] = 1;
    const Expr inverse = Expr(1) / U_(best.row, best.col);
    pivots_.push_back({best.row, best.col, inverse});
    for (int i = 0; i < U_.rows(); ++i) {
      if (row_done[static_cast<std::size_t>(i)] != 0 || U_(i, best.col).is_zero()) continue;
      const Expr factor = U_(i, best.col) * inverse;
      factors_.push_back({i, best.row, factor});
      for (int j = 0; j < U_.cols(); ++j)
        U_(i, j) = j == best.col ? Expr(0) : U_(i, j) - factor * U_(best.row, j);
    }
  }
}

std::vector<int> Elimination::pivot_columns() const {
  std::vector<int> columns;
  for (const Pivot& p : pivots_) columns.push_back(p.col);
  std::ranges::sort(columns);
  return columns;
}

bool Elimination::has_constant_pivots() const {
  return std::ranges::all_of(pivots_, [](const Pivot& p) { return p.inverse.constant_value().has_value(); });
}

std::vector<Expr> Elimination::factors() const {
  std::vector<Expr> values;
  for (const Factor& f : factors_) values.push_back(f.value);
  return values;
}

std::vector<Expr> Elimination::column(int j) const {
  std::vector<Expr> c;
  for (int i = 0; i < A_.rows(); ++i) c.push_back(A_(i, j));
  return c;
}

std::vector<Expr> Elimination::solve(std::vector<Expr> b) const {
  for (const Factor& f : factors_)
    b[static_cast<std::size_t>(f.target)] -= f.value * b[static_cast<std::size_t>(f.row)];
  std::vector<Expr> x(static_cast<std::size_t>(U_.cols()), Expr(0));
  for (std::size_t k = pivots_.size(); k-- > 0;) {
    Expr sum = b[static_cast<std::size_t>(pivots_[k].row)];
    for (std::size_t l = k + 1; l < pivots_.size(); ++l)
      sum -= U_(pivots_[k].row, pivots_[l].col) * x[static_cast<std::size_t>(pivots_[l].col)];
    x[static_cast<std::size_t>(pivots_[k].col)] = sum * pivots_[k].inverse;
  }
  return x;
}

std::vector<Expr> Elimination::solve_transposed(const std::vector<Expr>& c) const {
  std::vector<Expr> y(static_cast<std::size_t>(U_.rows()), Expr(0));
  for (std::size_t k = 0; k < pivots_.size(); ++k) {
    Expr sum = c[static_cast<std::size_t>(pivots_[k].col)];
    for (std::size_t l = 0; l < k; ++l)
      sum -= U_(pivots_[l].row, pivots_[k].col) * y[static_cast<std::size_t>(pivots_[l].row)];
    y[static_cast<std::size_t>(pivots_[k].row)] = sum * pivots_[k].inverse;
  }
  for (std::size_t k = factors_.size(); k-- > 0;)
    y[static_cast<std::size_t>(factors_[k].row)] -=
        factors_[k].value * y[static_cast<std::size_t>(factors_[k].target)];
  return y;
}

std::vector<std::vector<Expr>> solve_symmetric(const Matrix<Expr>& K,
                                               const std::vector<std::vector<Expr>>& right_hand_sides) {
  const SymmetricFactors factors(K);
  std::vector<std::vector<Expr>> solutions;
  for (const std::vector<Expr>& b : right_hand_sides)
    solutions.push_back(factors.backward(factors.scaled(factors.forward(b))));
  return solutions;
}

OrthogonalBasis orthogonal_basis(const Matrix<Expr>& H) {
  OrthogonalBasis basis{H, Matrix<Expr>(H.cols(), H.cols())};
  Matrix<Expr>& Q = basis.Q;
  for (int j = 0; j < H.cols(); ++j) {
    basis.R(j, j) = Expr(1);
    Expr square(0);
    for (int i = 0; i < H.rows(); ++i) square += Q(i, j) * Q(i, j);
    const Expr inverse = Expr(1) / square;
    for (int k = j + 1; k < H.cols(); ++k) {
      Expr product(0);
      for (int i = 0; i < H.rows(); ++i) product += Q(i, j) * Q(i, k);
      basis.R(j, k) = product * inverse;
      for (int i = 0; i < H.rows(); ++i) Q(i, k) -= Q(i, j) * basis.R(j, k);
    }
  }
  return basis;
}

std::vector<Expr> OrthogonalBasis::solve(std::vector<Expr> b) const {
  for (int i = R.rows(); i-- > 0;) {
    for (int k = i + 1; k < R.cols(); ++k)
      b[static_cast<std::size_t>(i)] -= R(i, k) * b[static_cast<std::size_t>(k)];
  }
  return b;
}

}  // namespace anholon
