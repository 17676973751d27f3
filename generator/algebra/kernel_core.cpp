// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/kernel_core.hpp"

#include <cln/integer_ring.h>
#include <cln/rational_ring.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "algebra/factors.hpp"
#include "algebra/lowering.hpp"
#include "algebra/ring.hpp"

namespace anholon {
namespace {

using Row = std::vector<Polynomial>;

/// One unknown is solved from a row by the others.
struct Pivot {
  std::size_t row;
  std::size_t column;
};

/// There is no kernel with the wanted free columns, or none within the limits.
struct NoAnswer {};

/// Solves A x_P = -(A_F | B) for every right side at once, over the field of quotients.
class Solver {
 public:
  Solver(const Ring& ring, std::vector<Row> rows, std::vector<std::size_t> pivot_columns,
         std::vector<std::size_t> sides, std::size_t block_limit, std::size_t max_terms)
      : ring_(&ring),
        rows_(std::move(rows)),
        unsolved_(std::move(pivot_columns)),
        sides_(std::move(sides)),
        block_limit_(block_limit),
        max_terms_(max_terms) {
    for (std::size_t i = 0; i < rows_.size(); ++i) active_.push_back(i);
  }

  /// x[column] over the right sides, for every pivot column.
  std::map<std::size_t, std::vector<Fraction>> solve() {
    while (eliminate_constant_pivot() || defer_single_entry()) {
    }
    for (const auto& [rows, columns] : blocks()) solve_block(rows, columns);
    for (auto pivot = triangular_.rbegin(); pivot != triangular_.rend(); ++pivot) substitute(*pivot);
    return std::move(solution_);
  }

 private:
  [[nodiscard]] std::size_t entries_of_row(std::size_t row) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(unsolved_, [&](std::size_t column) { return !rows_[row][column].is_zero(); }));
  }
  [[nodiscard]] std::size_t entries_of_column(std::size_t column) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(active_, [&](std::size_t row) { return !rows_[row][column].is_zero(); }));
  }
  void retire(const Pivot& pivot) {
    triangular_.push_back(pivot);
    std::erase(active_, pivot.row);
    std::erase(unsolved_, pivot.column);
  }

  /// Exact elimination by the rational pivot of least fill-in (Markowitz 1957).
  bool eliminate_constant_pivot() {
    std::optional<Pivot> best;
    std::size_t least = 0;
    for (const std::size_t row : active_) {
      for (const std::size_t column : unsolved_) {
        if (rows_[row][column].is_zero() || !rows_[row][column].is_constant()) continue;
        const std::size_t fill = (entries_of_row(row) - 1) * (entries_of_column(column) - 1);
        if (best && fill >= least) continue;
        best = Pivot{row, column};
        least = fill;
      }
    }
    if (!best) return false;
    const cln::cl_RA pivot = rows_[best->row][best->column].constant();
    for (const std::size_t row : active_) {
      if (row == best->row || rows_[row][best->column].is_zero()) continue;
      const Polynomial factor = cln::recip(pivot) * rows_[row][best->column];
      for (std::size_t j = 0; j < rows_[row].size(); ++j) {
        rows_[row][j] = bounded(ring_->normal(rows_[row][j] - factor * rows_[best->row][j]));
      }
    }
    retire(*best);
    return true;
  }

  /// A column with one entry: its row gives it once the others are known.
  bool defer_single_entry() {
    for (const std::size_t column : unsolved_) {
      if (entries_of_column(column) != 1) continue;
      const auto row =
          std::ranges::find_if(active_, [&](std::size_t i) { return !rows_[i][column].is_zero(); });
      retire({*row, column});
      return true;
    }
    return false;
  }

  /// Rows and columns that have nothing to do with each other.
  [[nodiscard]] std::vector<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> blocks() const {
    std::vector<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> result;
    std::set<std::size_t> seen;
    for (const std::size_t start : active_) {
      if (seen.contains(start)) continue;
      std::set<std::size_t> rows{start};
      std::set<std::size_t> columns;
      for (bool grown = true; grown;) {
        grown = false;
        for (const std::size_t row : active_) {
          for (const std::size_t column : unsolved_) {
            if (rows_[row][column].is_zero() || rows.contains(row) == columns.contains(column)) continue;
            rows.insert(row);
            columns.insert(column);
            grown = true;
          }
        }
      }
      seen.insert(rows.begin(), rows.end());
      if (rows.size() != columns.size() || rows.size() > block_limit_) throw NoAnswer();
      result.emplace_back(std::vector(rows.begin(), rows.end()), std::vector(columns.begin(), columns.end()));
    }
    return result;
  }

  [[nodiscard]] Polynomial bounded(Polynomial p) const {
    if (p.size() > max_terms_) throw SizeLimitExceeded();
    return p;
  }

  /// Expansion by the first row.
  [[nodiscard]] Polynomial determinant(const std::vector<std::vector<Polynomial>>& M) const {
    if (M.empty()) return 1;
    Polynomial result;
    for (std::size_t j = 0; j < M.size(); ++j) {
      if (M[0][j].is_zero()) continue;
      std::vector<std::vector<Polynomial>> minor;
      for (std::size_t i = 1; i < M.size(); ++i) {
        minor.push_back(M[i]);
        minor.back().erase(minor.back().begin() + static_cast<std::ptrdiff_t>(j));
      }
      const Polynomial term = M[0][j] * determinant(minor);
      result = j % 2 == 0 ? result + term : result - term;
    }
    return bounded(ring_->normal(result));
  }

  /// Cramer's rule; x_j = det(A_P with column j replaced by -b) / det(A_P), which is -adj(A_P) b / det(A_P).
  void solve_block(const std::vector<std::size_t>& rows, const std::vector<std::size_t>& columns) {
    std::vector<std::vector<Polynomial>> A_P;
    for (const std::size_t i : rows) {
      auto& row = A_P.emplace_back();
      for (const std::size_t j : columns) row.push_back(rows_[i][j]);
    }
    const Polynomial det = determinant(A_P);
    if (det.is_zero()) throw NoAnswer();
    for (std::size_t j = 0; j < columns.size(); ++j) {
      auto& x = solution_[columns[j]];
      for (const std::size_t side : sides_) {
        auto replaced = A_P;
        for (std::size_t i = 0; i < rows.size(); ++i) replaced[i][j] = -rows_[rows[i]][side];
        x.push_back(ring_->cancelled({determinant(replaced), det}));
      }
    }
    for (const std::size_t j : columns) std::erase(unsolved_, j);
  }

  /// x_p = -(b + sum of a_j x_j) / a_p
  void substitute(const Pivot& pivot) {
    const Row& row = rows_[pivot.row];
    auto& x = solution_[pivot.column];
    for (std::size_t k = 0; k < sides_.size(); ++k) {
      Fraction total{row[sides_[k]], 1};
      for (const auto& [column, value] : solution_) {
        if (column == pivot.column || row[column].is_zero()) continue;
        total = ring_->sum(total, ring_->product({row[column], 1}, value[k]));
      }
      x.push_back(ring_->cancelled(ring_->quotient(total, {-row[pivot.column], 1})));
    }
  }

  const Ring* ring_;
  std::vector<Row> rows_;
  std::vector<std::size_t> active_;    // rows not solved yet
  std::vector<std::size_t> unsolved_;  // pivot columns without a row
  std::vector<std::size_t> sides_;
  std::size_t block_limit_;
  std::size_t max_terms_;
  std::vector<Pivot> triangular_;
  std::map<std::size_t, std::vector<Fraction>> solution_;
};

Polynomial content(const Row& entries) {
  Polynomial result;
  for (const Polynomial& p : entries) result = gcd(result, p);
  return result;
}

std::size_t weight(const Row& entries) {
  std::size_t result = 0;
  for (const Polynomial& p : entries) result += p.weight();
  return result;
}

/// The column divided by what its entries have in common, looked for in every direction of c^2 + s^2 = 1.
Row without_content(const Ring& ring, Row column) {
  Row best = std::move(column);
  std::size_t least = weight(best) + 1;  // a constant factor alone is worth dividing out
  for (bool improved = true; improved;) {
    improved = false;
    const Row start = best;
    for (const std::uint32_t mask : ring.directions()) {
      Row candidate;
      for (const Polynomial& p : start) candidate.push_back(ring.directed(p, mask));
      const Polynomial common = content(candidate);
      for (Polynomial& p : candidate) p = *divide(p, common);
      const std::size_t candidate_weight = weight(candidate);
      if (candidate_weight < least) {
        best = std::move(candidate);
        least = candidate_weight;
        improved = true;
      }
    }
  }
  for (Polynomial& p : best) p = ring.lightest(p);
  return best;
}

/// Scaled by a rational, so that as many coefficients as possible are 1 or -1 and the free entry starts
/// positive.
Row scaled(Row column, std::size_t free_column) {
  std::map<cln::cl_RA, std::size_t> users;  // by magnitude of coefficient
  cln::cl_I numerator = 0;
  cln::cl_I denominator = 1;
  for (const Polynomial& p : column) {
    for (const auto& [monomial, coefficient] : p.terms()) {
      ++users[cln::abs(coefficient)];
      numerator = cln::gcd(numerator, cln::numerator(coefficient));
      denominator = cln::lcm(denominator, cln::denominator(coefficient));
    }
  }
  cln::cl_RA scale = cln::cl_RA(numerator) / denominator;  // leaves coprime integers
  std::size_t most = users.contains(scale) ? users[scale] : 0;
  for (const auto& [magnitude, count] : users) {
    if (count > most) {
      scale = magnitude;
      most = count;
    }
  }
  if (cln::minusp(column[free_column].leading_coefficient())) scale = -scale;
  for (Polynomial& p : column) p = cln::recip(scale) * p;
  return column;
}

/// Row of [A | B] times its common denominator, divided by its content.
Row polynomial_row(const Ring& ring, const std::vector<Fraction>& entries) {
  Polynomial denominator = 1;
  for (const Fraction& f : entries) {
    denominator = denominator * *divide(f.denominator, gcd(denominator, f.denominator));
  }
  Row row;
  for (const Fraction& f : entries)
    row.push_back(ring.normal(f.numerator * *divide(denominator, f.denominator)));
  const Polynomial common = content(row);
  if (common.is_zero()) throw NoAnswer();
  for (Polynomial& p : row) p = *divide(p, common);
  return row;
}

KernelCore basis(Tape& tape, const Ring& ring, std::vector<Row> rows, std::size_t columns, std::size_t inputs,
                 const std::vector<int>& free_columns, const KernelCoreLimits& limits) {
  std::vector<std::size_t> pivots;
  std::vector<std::size_t> sides;
  for (std::size_t j = 0; j < columns; ++j) {
    if (std::ranges::find(free_columns, static_cast<int>(j)) == free_columns.end()) pivots.push_back(j);
  }
  for (const int j : free_columns) sides.push_back(static_cast<std::size_t>(j));
  for (std::size_t j = 0; j < inputs; ++j) sides.push_back(columns + j);
  const auto x = Solver(ring, std::move(rows), pivots, sides, limits.rows, limits.terms).solve();

  Lowering lowering(tape, ring);
  const std::size_t k = free_columns.size();
  const NodeId zero = tape.constant(0);
  KernelCore core{std::vector(columns, std::vector<NodeId>(k, zero)),
                  std::vector(columns, std::vector<NodeId>(inputs, zero))};
  // Bounded before it is multiplied out: common denominators of many quotients know no other bound.
  const auto product = [&limits](const Polynomial& p, const Polynomial& q) {
    if (p.size() * q.size() > limits.terms) throw SizeLimitExceeded();
    return p * q;
  };
  for (std::size_t f = 0; f < k; ++f) {
    Polynomial denominator = 1;
    for (const auto& [column, value] : x) {
      denominator =
          product(denominator, *divide(value[f].denominator, gcd(denominator, value[f].denominator)));
    }
    Row column(columns);
    column[sides[f]] = denominator;
    for (const auto& [j, value] : x)
      column[j] = product(value[f].numerator, *divide(denominator, value[f].denominator));
    column = scaled(without_content(ring, std::move(column)), sides[f]);
    for (std::size_t j = 0; j < columns; ++j) core.H[j][f] = lowering.polynomial(column[j]);
  }
  std::vector<Fraction> entries;
  for (const auto& [j, value] : x)
    entries.insert(entries.end(), value.begin() + static_cast<std::ptrdiff_t>(k), value.end());
  const std::vector<NodeId> lowered = lowering.fractions(entries);
  std::size_t next = 0;
  for (const auto& [j, value] : x) {
    for (std::size_t i = 0; i < inputs; ++i) core.J[j][i] = lowered[next++];
  }
  return core;
}

}  // namespace

std::optional<KernelCore> kernel_core(Tape& tape, const std::vector<std::vector<NodeId>>& A,
                                      const std::vector<std::vector<NodeId>>& B,
                                      const std::vector<int>& free_columns, const KernelCoreLimits& limits) {
  const std::size_t columns = A.empty() ? free_columns.size() : A.front().size();
  const std::size_t inputs = B.empty() ? 0 : B.front().size();
  if (B.size() != A.size()) throw std::invalid_argument("A and B have different numbers of rows");
  if (A.size() + free_columns.size() != columns)
    throw std::invalid_argument("the free columns are not columns - rows");
  try {
    std::vector<NodeId> entries;
    for (std::size_t i = 0; i < A.size(); ++i) {
      entries.insert(entries.end(), A[i].begin(), A[i].end());
      entries.insert(entries.end(), B[i].begin(), B[i].end());
    }
    Ring ring(tape, limits.entry_terms, Ring::Beyond::opaque);
    const std::vector<Fraction> values = ring.convert(entries);
    ring.set_max_terms(limits.terms);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < A.size(); ++i) {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i * (columns + inputs));
      rows.push_back(polynomial_row(ring, {begin, begin + static_cast<std::ptrdiff_t>(columns + inputs)}));
    }
    return basis(tape, ring, std::move(rows), columns, inputs, free_columns, limits);
  } catch (const SizeLimitExceeded&) {
    return std::nullopt;
  } catch (const NoAnswer&) {
    return std::nullopt;
  } catch (const std::domain_error&) {  // a denominator that is zero by c^2 + s^2 = 1
    return std::nullopt;
  }
}

}  // namespace anholon
