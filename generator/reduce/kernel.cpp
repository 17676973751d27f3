// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/kernel.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "algebra/kernel_core.hpp"
#include "optimise/tape/count.hpp"
#include "reduce/decompositions.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

constexpr int combination_limit = 400;        // free sets that are tried one by one
constexpr std::size_t derivation_limit = 12;  // of these, how many are derived and counted
constexpr double condition_limit = 1e7;       // beyond it a basis counts as irregular at a sample
constexpr double dependable_pivot =
    1e-3;                           // least pivot of the leading rows, for a static basis that divides by it
constexpr double vanishing = 1e-7;  // a column this much smaller than its median has vanished

std::vector<int> range(int n) {
  std::vector<int> r(static_cast<std::size_t>(n));
  std::iota(r.begin(), r.end(), 0);
  return r;
}

std::vector<int> complement(const std::vector<int>& of, int n) {
  std::vector<int> r;
  for (int i = 0; i < n; ++i) {
    if (std::ranges::find(of, i) == of.end()) r.push_back(i);
  }
  return r;
}

/// All k-subsets of 0..n-1 in lexicographic order, or none if there are too many.
std::vector<std::vector<int>> combinations(int n, int k) {
  double count = 1;
  for (int i = 0; i < k; ++i) count = count * (n - i) / (i + 1);
  std::vector<std::vector<int>> all;
  if (count > combination_limit) return all;
  std::vector<int> pick = range(k);
  while (true) {
    all.push_back(pick);
    int i = k - 1;
    while (i >= 0 && pick[static_cast<std::size_t>(i)] == n - k + i) --i;
    if (i < 0) return all;
    ++pick[static_cast<std::size_t>(i)];
    for (int j = i + 1; j < k; ++j)
      pick[static_cast<std::size_t>(j)] = pick[static_cast<std::size_t>(j - 1)] + 1;
  }
}

/// In falling order of their worth; of those that differ by a hundredth at most the order stays as it was.
std::vector<std::vector<int>> best_first(const std::vector<std::vector<int>>& sets,
                                         const std::vector<double>& worth) {
  std::vector<int> order = range(static_cast<int>(sets.size()));
  const auto of = [&](int i) { return worth[static_cast<std::size_t>(i)]; };
  std::ranges::stable_sort(order, std::greater<>(), of);
  for (auto first = order.begin(); first != order.end();) {
    const double equal = 0.99 * of(*first);
    const auto last = std::find_if(first, order.end(), [&](int i) { return of(i) < equal; });
    std::sort(first, last);
    first = last;
  }
  std::vector<std::vector<int>> result;
  for (const int i : order) result.push_back(sets[static_cast<std::size_t>(i)]);
  return result;
}

std::vector<NodeId> nodes_of(Tape& tape, const Matrix<Expr>& m) {
  std::vector<NodeId> nodes;
  for (const Expr& e : m.entries()) nodes.push_back(e.id(tape));
  return nodes;
}

std::vector<std::vector<NodeId>> rows_of(Tape& tape, const Matrix<Expr>& m) {
  std::vector<std::vector<NodeId>> rows(static_cast<std::size_t>(m.rows()));
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) rows[static_cast<std::size_t>(i)].push_back(m(i, j).id(tape));
  }
  return rows;
}

Matrix<Expr> matrix_of(Tape& tape, const std::vector<std::vector<NodeId>>& rows, int cols) {
  Matrix<Expr> m(static_cast<int>(rows.size()), cols);
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < cols; ++j)
      m(i, j) = Expr(tape, rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
  }
  return m;
}

std::vector<Eigen::MatrixXd> sampled(Tape& tape, const Matrix<Expr>& m, const Sampler& sampler) {
  std::vector<Eigen::MatrixXd> result;
  for (const auto& values : sampler(nodes_of(tape, m))) {
    Eigen::MatrixXd x(m.rows(), m.cols());
    for (int i = 0; i < m.rows(); ++i) {
      for (int j = 0; j < m.cols(); ++j) x(i, j) = values[static_cast<std::size_t>(i * m.cols() + j)];
    }
    result.push_back(std::move(x));
  }
  return result;
}

}  // namespace

KinematicReduction::KinematicReduction(Tape& tape, ConstraintRows rows, const RankAnalysis& ranks,
                                       Inverse inverse, const std::vector<int>& preferred_free,
                                       const std::vector<std::string>& names, const Sampler& sampler)
    : tape_(tape), sampler_(sampler), rows_(std::move(rows)), leading_(ranks.leading_rows) {
  A_1_ = rows_.A.block(leading_, range(rows_.A.cols()));
  split_redundant_rows(inverse, range(rows_.A.cols()));
  B_1_ = weights_.times(rows_.B);
  choose_kernel(preferred_free);
  describe_kernel(names);
}

KinematicReduction::KinematicReduction(Tape& tape, ConstraintRows rows, const RankAnalysis& ranks,
                                       Inverse inverse, const ChartRequest& chart,
                                       const std::vector<std::string>& names)
    : tape_(tape),
      sampler_(chart.domain),
      rows_(std::move(rows)),
      leading_(ranks.leading_rows),
      wanted_projection_(chart.static_by_projection) {
  A_1_ = rows_.A.block(leading_, range(rows_.A.cols()));
  const std::vector<int> pivots = complement(chart.free, rows_.A.cols());
  split_redundant_rows(inverse, pivots);
  B_1_ = weights_.times(rows_.B);
  std::optional<Kernel> kernel = candidate(chart.free, false);
  if (!kernel) throw UnsupportedError("a chart's free velocities leave dependent ones");
  kernel_ = std::move(*kernel);
  kernel_elimination_.emplace(tape_, A_1_, pivots, sampler_);
  describe_kernel(names);
}

Expr KinematicReduction::quality(const std::vector<double>& sizes) const {
  Expr sum = 1;
  const auto size = [&](int i) {
    return Expr(tape_, tape_.constant(Exact::from_double(sizes[static_cast<std::size_t>(i)])));
  };
  for (int j = 0; j < kernel_.H.cols(); ++j) {
    for (int i = 0; i < kernel_.H.rows(); ++i) {
      if (std::ranges::find(kernel_.free, i) != kernel_.free.end()) continue;
      const Expr h = kernel_.H(i, j) * (size(kernel_.free[static_cast<std::size_t>(j)]) / size(i));
      sum += h * h;
    }
  }
  if (kernel_elimination_) {
    for (const Expr& f : kernel_elimination_->factors()) {
      if (!f.constant_value()) sum += f * f;
    }
  }
  return Expr(1) / sqrt(sum);
}

void KinematicReduction::split_redundant_rows(Inverse inverse, const std::vector<int>& pivots) {
  const int count = rows_.A.rows();
  const int independent = static_cast<int>(leading_.size());
  N_ = Matrix<Expr>(count, count - independent);
  if (independent > 0) elimination_.emplace(tape_, A_1_, pivots, sampler_);
  const std::vector<int> dependent = complement(leading_, count);
  for (std::size_t d = 0; d < dependent.size(); ++d) {  // row = w A_1
    std::vector<Expr> row;
    for (int j = 0; j < rows_.A.cols(); ++j) row.push_back(rows_.A(dependent[d], j));
    const std::vector<Expr> w = independent > 0 ? elimination_->solve_transposed(row) : std::vector<Expr>{};
    N_(dependent[d], static_cast<int>(d)) = 1;
    for (int i = 0; i < independent; ++i) {
      N_(leading_[static_cast<std::size_t>(i)], static_cast<int>(d)) = -w[static_cast<std::size_t>(i)];
    }
  }
  if (inverse == Inverse::leading || dependent.empty() || independent == 0) {
    weights_ = RowWeights(count, leading_);
    return;
  }
  // All rows by least squares on independent columns P: no choice of rows can go singular, and the transpose
  // gives the multipliers of least norm.
  const std::vector<int> P = elimination_->pivot_columns();
  weights_ = RowWeights(rows_.A.block(range(count), P));
  A_1_ = weights_.times(rows_.A);
  static_by_projection_ =  // where the leading rows are dependent somewhere
      wanted_projection_.value_or(elimination_->smallest_pivot() < dependable_pivot);
  if (static_by_projection_) {
    for (std::size_t d = 0; d < dependent.size(); ++d) {
      std::vector<Expr> e(static_cast<std::size_t>(count), Expr(0));
      e[static_cast<std::size_t>(dependent[d])] = 1;
      const std::vector<Expr> n = weights_.residual(e);
      for (int i = 0; i < count; ++i) N_(i, static_cast<int>(d)) = n[static_cast<std::size_t>(i)];
    }
  }
  for (int j = 0; j < independent; ++j) {  // what Gram-Schmidt makes zero and one is so exactly
    for (int i = j; i < independent; ++i) A_1_(i, P[static_cast<std::size_t>(j)]) = i == j ? 1 : 0;
  }
  elimination_.emplace(tape_, A_1_, pivots, sampler_);
}

std::optional<Kernel> KinematicReduction::candidate(const std::vector<int>& free,
                                                    bool content_divided) const {
  const int passive = A_1_.cols();
  Kernel kernel;
  kernel.free = free;
  kernel.content_divided = content_divided;
  if (content_divided) {
    const auto core = kernel_core(tape_, rows_of(tape_, A_1_), rows_of(tape_, B_1_), free);
    if (!core) return std::nullopt;
    kernel.H = matrix_of(tape_, core->H, static_cast<int>(free.size()));
    kernel.J = matrix_of(tape_, core->J, B_1_.cols());
  } else {
    kernel.H = Matrix<Expr>(passive, static_cast<int>(free.size()));
    kernel.J = Matrix<Expr>(passive, B_1_.cols());
    std::optional<Elimination> elimination;
    try {
      if (A_1_.rows() > 0) elimination.emplace(tape_, A_1_, complement(free, passive), sampler_);
    } catch (const RankDeficient&) {
      return std::nullopt;
    }
    kernel.divides_by_constants =
        (!elimination || elimination->has_constant_pivots()) && rows_.A.rows() == A_1_.rows();
    for (std::size_t c = 0; c < free.size(); ++c) {
      if (elimination) {
        const std::vector<Expr> x = elimination->solve(elimination->column(free[c]));
        for (int i = 0; i < passive; ++i) kernel.H(i, static_cast<int>(c)) = -x[static_cast<std::size_t>(i)];
      }
      kernel.H(free[c], static_cast<int>(c)) = 1;
    }
    for (int j = 0; j < B_1_.cols() && elimination; ++j) {
      std::vector<Expr> b;
      for (int i = 0; i < B_1_.rows(); ++i) b.push_back(B_1_(i, j));
      const std::vector<Expr> x = elimination->solve(b);
      for (int i = 0; i < passive; ++i) kernel.J(i, j) = -x[static_cast<std::size_t>(i)];
    }
  }
  judge(kernel);
  return kernel;
}

/// Counts the samples at which the basis vanishes, loses rank or is not finite.
void KinematicReduction::judge(Kernel& kernel) const {
  const auto H = sampled(tape_, kernel.H, sampler_);
  const auto J = sampled(tape_, kernel.J, sampler_);
  std::vector<double> medians;
  for (int c = 0; c < kernel.H.cols(); ++c) {
    std::vector<double> norms;
    for (const auto& h : H)
      norms.push_back(h.allFinite() ? h.col(c).norm() : std::numeric_limits<double>::infinity());
    std::ranges::nth_element(norms, norms.begin() + static_cast<std::ptrdiff_t>(norms.size() / 2));
    medians.push_back(norms[norms.size() / 2]);
  }
  for (std::size_t s = 0; s < H.size(); ++s) {
    bool regular =
        H[s].allFinite() && J[s].allFinite() && (J[s].size() == 0 || J[s].cwiseAbs().maxCoeff() < 1e9);
    if (regular && kernel.H.cols() > 0) {
      Eigen::MatrixXd h = H[s];
      for (int c = 0; c < h.cols() && regular; ++c) {
        const double size = h.col(c).norm();
        const double ordinary = medians[static_cast<std::size_t>(c)];
        regular = size > vanishing * ordinary && size * vanishing < ordinary;
        h.col(c) /= size;
      }
      if (regular) {
        const Eigen::VectorXd sigma = singular_values(h).sigma;
        const double condition = sigma(0) / sigma(sigma.size() - 1);
        regular = condition < condition_limit;
        if (regular) kernel.worst_condition = std::max(kernel.worst_condition, condition);
      }
    }
    if (!regular) ++kernel.irregular;
  }
}

void KinematicReduction::choose_kernel(const std::vector<int>& preferred_free) {
  const int passive = A_1_.cols();
  const int k = passive - A_1_.rows();
  // numeric worth of a free set: how far the other columns stay from singular, relative to all columns
  const auto A = sampled(tape_, A_1_, sampler_);
  const auto smallest = [](const Eigen::MatrixXd& m) {
    if (m.rows() == 0) return 1.0;
    return singular_values(m).sigma(m.rows() - 1);
  };
  std::vector<double> best_possible;
  for (const auto& a : A) best_possible.push_back(a.allFinite() ? smallest(a) : 0);
  const auto worth = [&](const std::vector<int>& free) {
    const std::vector<int> pivots = complement(free, passive);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < A.size(); ++s) {
      if (best_possible[s] < 1e-9) continue;
      Eigen::MatrixXd p(A[s].rows(), A[s].rows());
      for (int j = 0; j < p.cols(); ++j) p.col(j) = A[s].col(pivots[static_cast<std::size_t>(j)]);
      least = std::min(least, smallest(p) / best_possible[s]);
    }
    return std::isfinite(least) ? least : 0.0;
  };

  // What the description names, and beside it what the elimination of the others leaves.
  const auto as_asked_for = [&]() -> std::vector<std::vector<int>> {
    const int asked = static_cast<int>(preferred_free.size());
    if (asked == 0 || asked > k) return {};
    const std::vector<int> others = complement(preferred_free, passive);
    const bool others_can_hold_the_pivots = std::ranges::any_of(A, [&](const Eigen::MatrixXd& a) {
      Eigen::MatrixXd p(a.rows(), std::ssize(others));
      for (Eigen::Index j = 0; j < p.cols(); ++j) p.col(j) = a.col(others[static_cast<std::size_t>(j)]);
      return p.allFinite() && smallest(p) > 1e-9;
    });
    if (!others_can_hold_the_pivots)
      throw UnsupportedError(
          "no kernel basis is regular anywhere: the constraints tie the free velocities together");
    if (asked == k) return {preferred_free};
    return {complement(Elimination(tape_, A_1_, others, sampler_).pivot_columns(), passive)};
  };

  std::vector<std::vector<int>> free_sets = as_asked_for();
  const bool asked_for = !free_sets.empty();
  if (free_sets.empty() && A_1_.rows() == 0) {
    free_sets = {range(passive)};
  } else if (free_sets.empty()) {
    free_sets = combinations(passive, k);
    std::vector<double> worths;
    for (const auto& set : free_sets) worths.push_back(worth(set));
    free_sets = best_first(free_sets, worths);
    if (free_sets.size() > derivation_limit) free_sets.resize(derivation_limit);
    if (free_sets.empty()) {
      const Elimination elimination(tape_, A_1_, range(passive), sampler_);
      free_sets = {complement(elimination.pivot_columns(), passive)};
    }
  }

  // Fewest irregular samples, then fewest operations among the bases that are about as well conditioned as
  // the best.
  constexpr double worse = 30;
  std::vector<std::pair<Kernel, int>> candidates;
  for (const auto& free : free_sets) {
    for (const bool content_divided : {false, true}) {
      if (content_divided && A_1_.rows() == 0) continue;
      const std::optional<Kernel> kernel = candidate(free, content_divided);
      if (!kernel) continue;
      std::vector<NodeId> roots = nodes_of(tape_, kernel->H);
      const std::vector<NodeId> j = nodes_of(tape_, kernel->J);
      roots.insert(roots.end(), j.begin(), j.end());
      const OperationCount count = count_operations(tape_, roots);
      const int operations =
          count.total() + 10 * count.divisions;  // a division takes about as long as ten products
      candidates.emplace_back(*kernel, operations);
    }
  }
  if (candidates.empty()) throw UnsupportedError("no kernel basis could be derived");
  const auto regularity = [](const auto& c) { return std::pair(c.first.irregular, c.first.worst_condition); };
  const auto least = regularity(*std::ranges::min_element(candidates, {}, regularity));
  const auto cost = [&](const auto& c) {
    const bool poor = c.first.irregular > least.first || c.first.worst_condition > worse * least.second;
    return std::pair(poor, c.second);
  };
  kernel_ = std::ranges::min_element(candidates, {}, cost)->first;
  if (k > 0 && kernel_.irregular == static_cast<int>(A.size()))
    throw UnsupportedError(
        "no kernel basis is regular anywhere: the constraints tie the free velocities together");
  if (!kernel_.content_divided && A_1_.rows() > 0)
    kernel_elimination_.emplace(tape_, A_1_, complement(kernel_.free, passive), sampler_);
  // Multipliers by the pivots of the basis, which is regular where it is of use, if the description wants it
  // or their own vanish somewhere.
  if (kernel_elimination_ && (asked_for || elimination_->smallest_pivot() < dependable_pivot))
    elimination_ = kernel_elimination_;
}

void KinematicReduction::describe_kernel(const std::vector<std::string>& names) {
  const int passive = A_1_.cols();
  const int k = kernel_.H.cols();
  std::vector<std::string> free_names;
  for (const int c : kernel_.free) free_names.push_back(names[static_cast<std::size_t>(c)]);
  if (passive == 0) {
    kernel_.description = "none, there are no passive velocities";
  } else if (k == 0) {
    kernel_.description = "none, the constraints determine every passive velocity";
  } else if (A_1_.rows() == 0) {
    kernel_.description = rows_.A.rows() == 0
                              ? "no constraints: nu are the passive velocities themselves"
                              : "the rows leave the passive velocities free: nu are these themselves";
  } else {
    kernel_.description =
        kernel_.content_divided
            ? fmt::format("denominator-free basis, content divided out, built on free velocities ({})",
                          fmt::join(free_names, ", "))
            : fmt::format("pivoted basis, nu = ({})", fmt::join(free_names, ", "));
  }
}

std::vector<Expr> KinematicReduction::velocities(const std::vector<Expr>& r_a_dot,
                                                 const std::vector<Expr>& nu) const {
  std::vector<Expr> v = kernel_.J * r_a_dot;
  const std::vector<Expr> h = kernel_.H * nu;
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += h[i];
  return v;
}

std::vector<Expr> KinematicReduction::drift(const std::vector<Expr>& r_a_dot, const std::vector<Expr>& nu,
                                            const std::vector<Expr>& bias,
                                            const std::vector<std::pair<NodeId, NodeId>>& motion) const {
  if (kernel_.content_divided) {
    std::vector<NodeId> roots;
    for (const Expr& e : velocities(r_a_dot, nu)) roots.push_back(e.id(tape_));
    std::vector<Expr> result;
    for (const NodeId id : directional_derivative(tape_, roots, motion)) result.emplace_back(tape_, id);
    return result;
  }
  if (!kernel_elimination_) return std::vector<Expr>(static_cast<std::size_t>(A_1_.cols()), Expr(0));
  std::vector<Expr> b = weights_.times(bias);
  for (Expr& e : b) e = -e;
  return kernel_elimination_->solve(b);
}

std::vector<Expr> KinematicReduction::multipliers(const std::vector<Expr>& residual,
                                                  const std::vector<Expr>& lambda_stat) const {
  std::vector<Expr> lambda(static_cast<std::size_t>(rows_.A.rows()), Expr(0));
  if (elimination_) lambda = weights_.transposed_times(elimination_->solve_transposed(residual));
  const std::vector<Expr> extra = N_ * lambda_stat;
  for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] += extra[i];
  return lambda;
}

std::vector<Expr> KinematicReduction::reduced_velocities(const std::vector<Expr>& passive,
                                                         const std::vector<Expr>& r_a_dot) const {
  std::vector<Expr> difference = kernel_.J * r_a_dot;
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = passive[i] - difference[i];
  if (k() == 0) return {};
  if (!kernel_.content_divided) {
    std::vector<Expr> nu;
    for (const int c : kernel_.free) nu.push_back(difference[static_cast<std::size_t>(c)]);
    return nu;
  }
  const Matrix<Expr> Ht = kernel_.H.transposed();
  return solve_symmetric(Ht * kernel_.H, {Ht * difference}).front();
}

}  // namespace anholon
