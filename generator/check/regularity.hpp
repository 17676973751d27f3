// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Does the kernel basis serve the whole working range? Samples cannot tell where it is singular on a surface
// that they happen to miss, so this searches: from the worst of many random configurations downhill, in
// double.

#include <optional>
#include <string>
#include <vector>

#include "derive/derive.hpp"

namespace anholon {

struct Regularity {
  /// A configuration where H or J is singular although (A, B_p) keeps its rank: another basis is needed
  /// there.
  std::optional<std::string> singular_basis;
  /// A configuration where (A, B_p) itself loses rank.
  std::optional<std::string> rank_drop;
  std::vector<int> dropped_rows;  // that depend on each other there
};

/// @param derivation  of this model, with the functions kinematics and constraints
Regularity search_singularities(const Model& model, const Derivation& derivation);

}  // namespace anholon
