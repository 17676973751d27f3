// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Operation counts, as reports and headers of generated files state them: a - b is one addition; negations,
// roots and sines are counted apart from additions, multiplications and divisions.

#include <string>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

struct OperationCount {
  int additions = 0;  // and subtractions
  int multiplications = 0;
  int divisions = 0;
  int negations = 0;
  int roots = 0;
  int sines = 0;
  int cosines = 0;
  int other = 0;  // tan, asin, acos, atan2, exp, log, tanh, abs, sign

  [[nodiscard]] int total() const { return additions + multiplications + divisions; }
  [[nodiscard]] int trigonometric() const { return sines + cosines; }
  /// Everything, as statements of the emitted function.
  [[nodiscard]] int statements() const { return total() + negations + roots + trigonometric() + other; }
  /// "12 add, 30 mul, 1 sin, 1 cos"; what is zero is left out, "none" where everything is.
  [[nodiscard]] std::string text() const;

  void add(Op op);
  OperationCount& operator+=(const OperationCount& count);
  friend bool operator==(const OperationCount&, const OperationCount&) = default;
};

/// Operations that the roots need, each shared node once.
/// @param given  nodes whose values are there already; they and what only they need cost nothing
OperationCount count_operations(const Tape& tape, const std::vector<NodeId>& roots,
                                const std::vector<NodeId>& given = {});

}  // namespace anholon
