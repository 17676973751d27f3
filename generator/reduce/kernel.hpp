// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The kinematic model eta‡ = J r_a_dot + H nu, eq. (11), with a basis H that stays regular in the working
// range, its drift, and the multipliers of eq. (26). One generalised inverse serves both, as (27) needs.

#include <optional>
#include <string>
#include <vector>

#include "reduce/elimination.hpp"
#include "reduce/partition.hpp"
#include "reduce/rank.hpp"
#include "reduce/row_weights.hpp"

namespace anholon {

/// How redundant rows share: least norm of lambda, or the leading rows alone.
enum class Inverse { pseudo, leading };

/// The rows of eq. (2) on a program's tape, columns split by a partition.
struct ConstraintRows {
  Matrix<Expr> A;  // (A, B_p): rows x passive
  Matrix<Expr> B;  // B_a: rows x active
};

struct Kernel {
  Matrix<Expr> H;         // passive x k
  Matrix<Expr> J;         // passive x active
  std::vector<int> free;  // passive columns that nu names, or that the content-divided basis was built on
  bool content_divided = false;       // else nu are the free velocities themselves
  double worst_condition = 1;         // of H over the samples
  std::string description;            // one sentence for reports
  int irregular = 0;                  // samples at which H or J is not finite, vanishes or loses rank
  bool divides_by_constants = false;  // alone: H and J are then regular wherever the rows are finite
};

/// A basis for a part of the working range.
struct ChartRequest {
  std::vector<int> free;      // passive columns that nu names
  Sampler domain;             // values at the configurations that it has to serve
  bool static_by_projection;  // how the basis of the static loadings is made, the same for all charts
};

class KinematicReduction {
 public:
  /// @param preferred_free  passive columns that the description wants as nu
  KinematicReduction(Tape& tape, ConstraintRows rows, const RankAnalysis& ranks, Inverse inverse,
                     const std::vector<int>& preferred_free, const std::vector<std::string>& names,
                     const Sampler& sampler);
  /// A chart: pivoted, on the given free velocities.
  KinematicReduction(Tape& tape, ConstraintRows rows, const RankAnalysis& ranks, Inverse inverse,
                     const ChartRequest& chart, const std::vector<std::string>& names);

  /// How good a chart is at a configuration, from 1 down to 0 where it is singular:
  ///
  ///   1 / sqrt(1 + sum (H_ij size_j / size_i)^2 + sum of the squares of the factors of its elimination),
  ///
  /// the sum over velocities that are not free. Not a number where the elimination divides zero by zero.
  /// @param sizes  (passive) what is an ordinary size of each passive velocity
  [[nodiscard]] Expr quality(const std::vector<double>& sizes) const;
  [[nodiscard]] bool static_by_projection() const { return static_by_projection_; }

  [[nodiscard]] const Kernel& kernel() const { return kernel_; }
  [[nodiscard]] int k() const { return kernel_.H.cols(); }
  [[nodiscard]] const ConstraintRows& rows() const { return rows_; }

  /// eta‡ = J r_a_dot + H nu
  [[nodiscard]] std::vector<Expr> velocities(const std::vector<Expr>& r_a_dot,
                                             const std::vector<Expr>& nu) const;
  /// J_dot r_a_dot + H_dot nu as one vector. A pivoted basis solves for it as an augmented column; a
  /// content-divided one is differentiated along the motion, which keeps it regular where A loses rank.
  /// @param bias  (rows) A‡_dot eta‡ + B_a_dot r_a_dot
  /// @param motion  (input, rate) of every position input of the tape
  [[nodiscard]] std::vector<Expr> drift(const std::vector<Expr>& r_a_dot, const std::vector<Expr>& nu,
                                        const std::vector<Expr>& bias,
                                        const std::vector<std::pair<NodeId, NodeId>>& motion) const;
  /// lambda of eq. (26) from the residual M‡ eta‡_dot + M_a‡^T r_a_ddot - f‡, plus N s.
  [[nodiscard]] std::vector<Expr> multipliers(const std::vector<Expr>& residual,
                                              const std::vector<Expr>& lambda_stat) const;
  /// N: basis of ker A‡^T, rows x (rows - m°).
  [[nodiscard]] const Matrix<Expr>& static_basis() const { return N_; }
  /// b without its part in the range of A‡, which N^T takes to zero.
  [[nodiscard]] std::vector<Expr> out_of_range(const std::vector<Expr>& b) const {
    return weights_.residual(b);
  }
  /// nu from passive velocities that satisfy the constraints.
  [[nodiscard]] std::vector<Expr> reduced_velocities(const std::vector<Expr>& passive,
                                                     const std::vector<Expr>& r_a_dot) const;

 private:
  /// @param pivots  columns that may hold pivots
  void split_redundant_rows(Inverse inverse, const std::vector<int>& pivots);
  void choose_kernel(const std::vector<int>& preferred_free);
  std::optional<Kernel> candidate(const std::vector<int>& free, bool content_divided) const;
  void judge(Kernel& kernel) const;
  void describe_kernel(const std::vector<std::string>& names);

  Tape& tape_;
  Sampler sampler_;
  ConstraintRows rows_;
  std::vector<int> leading_;
  RowWeights weights_;  // C: picks the leading rows, or weighs all of them, m° x rows
  Matrix<Expr> A_1_;    // C A‡: m° independent rows, m° x passive
  Matrix<Expr> B_1_;    // C B_a
  Matrix<Expr> N_;
  std::optional<bool> wanted_projection_;  // of a chart
  bool static_by_projection_ = false;
  std::optional<Elimination> elimination_;         // for the multipliers
  std::optional<Elimination> kernel_elimination_;  // on the kernel's own pivots, for its drift
  Kernel kernel_;
};

}  // namespace anholon
