// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/rank.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "anholon/free_dynamics.hpp"
#include "reduce/decompositions.hpp"

namespace anholon {
namespace {

constexpr unsigned rank_digits = 50;

/// Rank by elimination with complete pivoting; what is below 1e-25 of the largest entry is zero. The samples
/// are exact doubles, so an entry that vanishes at a special angle is about 1e-17 there and still counts.
int rank_of(Matrix<Exact> a, const Exact& tolerance) {
  Exact largest = 0;
  for (const Exact& e : a.entries()) largest = std::max(largest, abs(e));
  int rank = 0;
  std::vector<char> used(static_cast<std::size_t>(a.cols()), 0);
  for (int step = 0; step < a.rows(); ++step) {
    int pivot_row = -1, pivot_col = -1;
    Exact best = largest * tolerance;
    for (int i = rank; i < a.rows(); ++i) {
      for (int j = 0; j < a.cols(); ++j) {
        if (used[static_cast<std::size_t>(j)] == 0 && abs(a(i, j)) > best)
          best = abs(a(i, j)), pivot_row = i, pivot_col = j;
      }
    }
    if (pivot_row < 0) break;
    for (int j = 0; j < a.cols(); ++j) std::swap(a(rank, j), a(pivot_row, j));
    for (int i = rank + 1; i < a.rows(); ++i) {
      const Exact factor = a(i, pivot_col) / a(rank, pivot_col);
      for (int j = 0; j < a.cols(); ++j) a(i, j) = a(i, j) - factor * a(rank, j);
    }
    used[static_cast<std::size_t>(pivot_col)] = 1;
    ++rank;
  }
  return rank;
}

Eigen::MatrixXd to_double(const Matrix<Exact>& a) {
  Eigen::MatrixXd r(a.rows(), a.cols());
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < a.cols(); ++j) r(i, j) = a(i, j).to_double();
  }
  return r;
}

/// Coordinates on which a matrix of the state depends, and whether it depends on the orientation: by changing
/// one after the other at a random state.
struct Dependence {
  std::vector<std::size_t> coordinates;
  bool orientation = false;
};

template <class MatrixAt>
Dependence dependence(const MatrixAt& matrix_at, const SampleState& a, const SampleState& b) {
  const auto differs = [&, base = matrix_at(a.state)](const State<Exact>& state) {
    return matrix_at(state).entries() != base.entries();
  };
  Dependence found;
  for (std::size_t i = 0; i < a.state.r.size(); ++i) {
    State<Exact> moved = a.state;
    moved.r[i] = b.state.r[i];
    if (differs(moved)) found.coordinates.push_back(i);
  }
  State<Exact> turned = a.state;
  turned.R = b.state.R;
  found.orientation = differs(turned);
  return found;
}

/// "r1 = r2 = pi/2" or "r1 = pi/2, r2 = 0.42".
std::string text_of(const std::vector<SamplePlace>& places) {
  constexpr std::size_t most = 6;
  const bool equal = std::ranges::all_of(places, [&](const auto& p) { return p.value == places[0].value; });
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places.size() > most && i == most - 1) text += (equal ? " = ..." : ", ...");
    if (places.size() > most && i >= most - 1 && i + 1 < places.size()) continue;
    if (i > 0) text += equal ? " = " : ", ";
    text += equal ? places[i].coordinate : places[i].coordinate + " = " + places[i].value;
  }
  return equal && !places.empty() ? text + " = " + places[0].value : text;
}

/// The places of a sample that matter; of these the special ones alone where there are any.
std::vector<SamplePlace> places_that_matter(const SampleState& sample, const Dependence& on,
                                            bool special_alone) {
  std::vector<SamplePlace> places;
  for (const std::size_t i : on.coordinates) places.push_back(sample.places[i]);
  const auto is_special = [](const SamplePlace& p) { return p.special; };
  if (special_alone && std::ranges::any_of(places, is_special))
    std::erase_if(places, [&](const auto& p) { return !is_special(p); });
  return places;
}

/// A configuration that loses rank, as long as reports need it.
struct FoundDrop {
  std::vector<SamplePlace> places;
  int rank;
  std::vector<int> rows;
  /// Whether this one says no more than `other`: every place of it is here as well.
  [[nodiscard]] bool follows_from(const FoundDrop& other) const {
    return rank == other.rank && std::ranges::all_of(other.places, [this](const SamplePlace& p) {
             return std::ranges::any_of(places, [&p](const SamplePlace& q) {
               return q.coordinate == p.coordinate && q.value == p.value;
             });
           });
  }
};

std::vector<std::vector<double>> nested(const Eigen::MatrixXd& a) {
  std::vector<std::vector<double>> rows(static_cast<std::size_t>(a.rows()));
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    rows[static_cast<std::size_t>(i)].assign(a.row(i).begin(), a.row(i).end());
  return rows;
}

}  // namespace

std::vector<int> dependent_rows(const std::vector<std::vector<double>>& A, const std::vector<int>& leading) {
  constexpr double zero = 1e-7;        // of the largest singular value: configurations are found to 1e-8
  constexpr double takes_part = 0.02;  // of the largest entry of a combination
  if (leading.empty()) return {};
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(leading.size()),
                       static_cast<Eigen::Index>(A.front().size()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    for (Eigen::Index j = 0; j < rows.cols(); ++j)
      rows(i, j) =
          A[static_cast<std::size_t>(leading[static_cast<std::size_t>(i)])][static_cast<std::size_t>(j)];
  }
  const SingularValues svd = singular_values(rows.transpose());  // V: combinations of rows
  std::vector<int> found;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    bool takes = false;
    for (Eigen::Index c = 0; c < rows.rows(); ++c) {
      const bool lost = c >= svd.sigma.size() || !(svd.sigma(c) > zero * std::max(svd.sigma(0), 1e-300));
      const Eigen::VectorXd u = svd.V.col(c);
      takes = takes || (lost && std::abs(u(i)) > takes_part * u.cwiseAbs().maxCoeff());
    }
    if (takes) found.push_back(leading[static_cast<std::size_t>(i)]);
  }
  return found;
}

std::string RankAnalysis::table_I_class(const Partition& partition) const {
  const bool has_kernel = static_cast<int>(partition.passive.size()) > m_locked;
  const bool hyperstatic = m > m_locked;
  return std::string(has_kernel ? "H nonzero" : "H empty") +
         (hyperstatic ? ", lambda_stat undetermined" : ", lambda_stat = 0") +
         (has_kernel ? " (dynamic)" : " (kinematic)");
}

RankAnalysis analyse_ranks(const MechanismDescription& description, const std::vector<Exact>& parameters,
                           const Partition& partition, const std::vector<SampleState>& samples,
                           const std::vector<int>& preferred_rows) {
  const WorkingDigits precision(rank_digits);
  const Mechanism<Exact> mechanism = mechanise<Exact>(description, parameters);
  FreeDynamics<Exact> dynamics(mechanism);
  const Exact zero_tolerance = Exact::from_decimal("1e-25");
  const Exact drop_tolerance = Exact::from_decimal("1e-12");

  RankAnalysis analysis;
  analysis.rows = static_cast<int>(mechanism.rows.size());
  std::vector<int> all_rows(static_cast<std::size_t>(analysis.rows));
  std::iota(all_rows.begin(), all_rows.end(), 0);
  std::vector<int> all_columns = partition.passive;
  all_columns.insert(all_columns.end(), partition.active.begin(), partition.active.end());
  analysis.kinematic.assign(static_cast<std::size_t>(partition.s_p()), analysis.rows > 0);
  if (analysis.rows == 0) return analysis;

  std::vector<Matrix<Exact>> matrices;  // (A, B_p, B_a) at every sample
  for (const SampleState& sample : samples) matrices.push_back(dynamics.constraints(sample.state).first);
  Matrix<Exact> generic, generic_all;  // at samples of full rank
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const int locked = rank_of(matrices[s].block(all_rows, partition.passive), zero_tolerance);
    if (locked > analysis.m_locked || generic.rows() == 0)
      generic = matrices[s].block(all_rows, partition.passive);
    analysis.m_locked = std::max(analysis.m_locked, locked);
    const int whole = rank_of(matrices[s].block(all_rows, all_columns), zero_tolerance);
    if (whole > analysis.m || generic_all.rows() == 0) generic_all = matrices[s].block(all_rows, all_columns);
    analysis.m = std::max(analysis.m, whole);
  }

  std::vector<int> order = preferred_rows;
  for (const int row : all_rows) {
    if (std::ranges::find(order, row) == order.end()) order.push_back(row);
  }
  const auto is_independent = [&](const Matrix<Exact>& of, const std::vector<int>& rows) {
    std::vector<int> every(static_cast<std::size_t>(of.cols()));
    std::iota(every.begin(), every.end(), 0);
    return rank_of(of.block(rows, every), zero_tolerance) == static_cast<int>(rows.size());
  };
  std::vector<int> independent;  // of all columns; those of the passive ones come first
  const auto with = [](std::vector<int> rows, int row) {
    rows.push_back(row);
    return rows;
  };
  for (const int row : order) {
    if (is_independent(generic, with(analysis.leading_rows, row))) analysis.leading_rows.push_back(row);
  }
  independent = analysis.leading_rows;
  for (const int row : order) {
    if (std::ranges::find(independent, row) != independent.end()) continue;
    const bool binds = is_independent(generic_all, with(independent, row));
    if (binds) independent.push_back(row);
    (binds ? analysis.conditions : analysis.redundant).push_back(row);
  }

  const Dependence on = dependence(
      [&](const State<Exact>& state) {
        return dynamics.constraints(state).first.block(all_rows, partition.passive);
      },
      samples[0], samples[1]);
  std::vector<FoundDrop> drops;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const Matrix<Exact> locked = matrices[s].block(all_rows, partition.passive);
    if (const int rank = rank_of(locked, drop_tolerance); rank < analysis.m_locked) {
      drops.push_back({places_that_matter(samples[s], on, true), rank,
                       dependent_rows(nested(to_double(locked)), analysis.leading_rows)});
      continue;
    }
    const SingularValues svd = singular_values(to_double(locked));
    if (analysis.m_locked == 0) continue;
    const double condition = svd.sigma(0) / svd.sigma(analysis.m_locked - 1);
    if (condition > analysis.worst_condition)
      analysis.worst_condition = condition,
      analysis.worst_at =
          text_of(places_that_matter(samples[s], on, false)) +
          (on.orientation ? (on.coordinates.empty() ? "a random orientation" : ", a random orientation")
                          : "");
    const auto kernel = svd.V.rightCols(locked.cols() - analysis.m_locked);
    for (int i = 0; i < partition.s_p(); ++i) {
      if (kernel.cols() > 0 && kernel.row(partition.n + i).norm() > 1e-9)
        analysis.kinematic[static_cast<std::size_t>(i)] = false;
    }
  }
  for (std::size_t i = 0; i < drops.size(); ++i) {
    const bool is_implied = std::ranges::any_of(drops, [&](const FoundDrop& other) {
      const bool is_shorter = other.places.size() < drops[i].places.size();
      const bool is_earlier = &other < &drops[i] && other.places.size() == drops[i].places.size();
      return (is_shorter || is_earlier) && drops[i].follows_from(other);
    });
    if (!is_implied) analysis.drops.push_back({text_of(drops[i].places), drops[i].rank, drops[i].rows});
  }
  return analysis;
}

}  // namespace anholon
