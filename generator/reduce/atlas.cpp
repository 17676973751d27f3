// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/atlas.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

#include "reduce/decompositions.hpp"

namespace anholon {
namespace {

constexpr double fit = 0.35;  // of the best fitness within reach: such a chart serves a configuration

/// k rows of N that are about as independent as any k: QR of N^T with column pivoting.
std::vector<int> independent_rows(const Eigen::MatrixXd& N) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(N.transpose());
  std::vector<int> rows;
  for (Eigen::Index i = 0; i < N.cols(); ++i) rows.push_back(qr.colsPermutation().indices()(i));
  std::ranges::sort(rows);
  return rows;
}

}  // namespace

std::vector<double> velocity_sizes(const std::vector<Eigen::MatrixXd>& A) {
  constexpr int rounds = 10;
  const Eigen::Index rows = A.empty() ? 0 : A.front().rows(), cols = A.empty() ? 0 : A.front().cols();
  Eigen::MatrixXd typical = Eigen::MatrixXd::Zero(rows, cols);
  double count = 0;
  for (const Eigen::MatrixXd& a : A) {
    if (!a.allFinite()) continue;
    typical += a.cwiseAbs();
    ++count;
  }
  if (count > 0) typical /= count;
  Eigen::VectorXd size = Eigen::VectorXd::Ones(cols);
  Eigen::MatrixXd scaled = typical;
  for (int round = 0; round < rounds; ++round) {  // Ruiz 2001: rows and columns towards a largest entry of 1
    for (Eigen::Index i = 0; i < rows; ++i) {
      if (const double largest = scaled.row(i).maxCoeff(); largest > 0) scaled.row(i) /= std::sqrt(largest);
    }
    for (Eigen::Index j = 0; j < cols; ++j) {
      const double largest = rows > 0 ? scaled.col(j).maxCoeff() : 0;
      if (largest > 0) scaled.col(j) /= std::sqrt(largest), size(j) /= std::sqrt(largest);
    }
  }
  std::vector<double> sizes;
  for (const double s : size) {  // the nearest power of two
    int exponent = 0;
    const double fraction = std::frexp(s, &exponent);
    sizes.push_back(std::ldexp(1.0, fraction < std::sqrt(0.5) ? exponent - 1 : exponent));
  }
  return sizes;
}

ChartChoice::ChartChoice(const std::vector<Eigen::MatrixXd>& A, int rank, const std::vector<double>& sizes) {
  const Eigen::VectorXd scale =
      Eigen::Map<const Eigen::VectorXd>(sizes.data(), static_cast<Eigen::Index>(sizes.size()));
  std::set<std::vector<int>> candidates;
  for (const Eigen::MatrixXd& a : A) {
    kernels_.emplace_back(singular_values(a * scale.asDiagonal()).V.rightCols(a.cols() - rank));
    candidates.insert(independent_rows(kernels_.back()));
  }
  for (std::size_t s = 0; s < kernels_.size(); ++s) {
    double best = 0;
    for (const auto& free : candidates) best = std::max(best, fitness(free, s));
    best_.push_back(best);
  }
  std::vector<char> served(kernels_.size(), 0);
  while (std::ranges::count(served, 0) > 0) {  // greedy cover; candidates in lexicographic order decide ties
    const std::vector<int>* most = nullptr;
    long gained = 0;
    for (const auto& free : candidates) {
      long gain = 0;
      for (std::size_t s = 0; s < kernels_.size(); ++s) gain += served[s] == 0 && serves(free, s) ? 1 : 0;
      if (gain > gained) most = &free, gained = gain;
    }
    if (most == nullptr) break;  // kernels that are not finite: no chart serves there
    for (std::size_t s = 0; s < kernels_.size(); ++s) {
      if (serves(*most, s)) served[s] = 1;
    }
    free_sets_.push_back(*most);
  }
}

double ChartChoice::fitness(const std::vector<int>& free, std::size_t configuration) const {
  const Eigen::MatrixXd& N = kernels_[configuration];
  Eigen::MatrixXd rows(N.cols(), N.cols());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) rows.row(i) = N.row(free[static_cast<std::size_t>(i)]);
  if (!rows.allFinite()) return 0;
  const Eigen::VectorXd sigma = singular_values(rows).sigma;
  return sigma(sigma.size() - 1);
}

bool ChartChoice::serves(const std::vector<int>& free, std::size_t configuration) const {
  return best_[configuration] > 0 && fitness(free, configuration) >= fit * best_[configuration];
}

std::vector<std::size_t> ChartChoice::domain(const std::vector<int>& free) const {
  std::vector<std::size_t> served;
  for (std::size_t s = 0; s < kernels_.size(); ++s) {
    if (serves(free, s)) served.push_back(s);
  }
  return served;
}

}  // namespace anholon
