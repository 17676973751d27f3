// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Sets of free velocities that together serve all configurations, where none serves them all: charts of the
// admissible velocities. With N(s) an orthonormal basis of ker (A, B_p) at a configuration s, the basis H
// that names the velocities F has H = N N_F^-1, so its fitness at s is the least singular value of the rows
// N_F.

#include <Eigen/Core>
#include <vector>

namespace anholon {

/// Powers of two that bring the velocities to comparable sizes, so that metres and radians may be compared:
/// v_j = size_j times a number of ordinary size.
/// @param A  (A, B_p) at several configurations; entries that are not finite are left out
std::vector<double> velocity_sizes(const std::vector<Eigen::MatrixXd>& A);

class ChartChoice {
 public:
  /// @param A  (A, B_p) at configurations where it keeps its rank
  ChartChoice(const std::vector<Eigen::MatrixXd>& A, int rank, const std::vector<double>& sizes);

  /// Free sets, most useful first, so that each configuration has one that is about as fit as any.
  [[nodiscard]] std::vector<std::vector<int>> free_sets() const { return free_sets_; }
  /// Indices of the configurations that a chart has to serve: those where it is about as fit as any.
  [[nodiscard]] std::vector<std::size_t> domain(const std::vector<int>& free) const;

 private:
  [[nodiscard]] double fitness(const std::vector<int>& free, std::size_t configuration) const;
  [[nodiscard]] bool serves(const std::vector<int>& free, std::size_t configuration) const;

  std::vector<Eigen::MatrixXd> kernels_;  // N
  std::vector<double> best_;              // fitness that is within reach at each configuration
  std::vector<std::vector<int>> free_sets_;
};

}  // namespace anholon
