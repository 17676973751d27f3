// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Generic ranks and the class of Table I, decided by evaluation at sampled configurations in high precision.

#include <string>
#include <vector>

#include "describe/mechanise.hpp"
#include "reduce/partition.hpp"
#include "reduce/samples.hpp"

namespace anholon {

struct RankAnalysis {
  int rows = 0;
  int m_locked = 0;               // m°: rank of (A, B_p)
  int m = 0;                      // rank of (A, B_p, B_a)
  std::vector<int> leading_rows;  // first m° rows of (A, B_p) that are independent
  std::vector<bool> kinematic;    // for each passive coordinate: fixed by the constraints alone
  struct Drop {
    std::string where;  // "r1 = pi/2"; only coordinates on which (A, B_p) depends are named
    int rank;
    std::vector<int> rows;  // that depend on each other there, and only there
  };
  std::vector<int> redundant;   // rows that others imply whatever moves: rows - m of them
  std::vector<int> conditions;  // rows that (A, B_p) implies: they bind the imposed motion, m - m° of them
  std::vector<Drop> drops;      // special configurations at which (A, B_p) loses rank
  double worst_condition = 1;   // of (A, B_p) over the samples that keep the rank
  std::string worst_at;         // empty where (A, B_p) is the same everywhere

  /// e.g. "H nonzero, lambda_stat = 0 (dynamic)"
  [[nodiscard]] std::string table_I_class(const Partition& partition) const;
};

/// Rows that take part in a dependency that exists at A alone: the combinations u with u A = 0 beyond those
/// of rows that are redundant everywhere.
/// @param leading  rows that are independent almost everywhere
std::vector<int> dependent_rows(const std::vector<std::vector<double>>& A, const std::vector<int>& leading);

/// @param preferred_rows  rows to take as the leading ones, may be empty
RankAnalysis analyse_ranks(const MechanismDescription& description, const std::vector<Exact>& parameters,
                           const Partition& partition, const std::vector<SampleState>& samples,
                           const std::vector<int>& preferred_rows = {});

}  // namespace anholon
