// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Integration to any number of digits: the modified midpoint rule with 2, 4, 6, ... substeps, extrapolated to
// substeps of no length (Gragg, Bulirsch, Stoer; Hairer, Norsett & Wanner 1993, II.9). Order 2k with k rows,
// in exact arithmetic's working digits.

#include <algorithm>
#include <functional>
#include <vector>

#include "number/exact.hpp"

namespace anholon::testing {

using ExactVector = std::vector<Exact>;
using ExactField = std::function<ExactVector(const ExactVector& y)>;

struct ExtrapolatedStep {
  ExactVector y;
  Exact error;  // what the last row has changed, largest component
};

/// One step H of y' = f(y).
inline ExtrapolatedStep extrapolated_step(const ExactField& f, const ExactVector& y, const Exact& H,
                                          int rows) {
  ExtrapolatedStep result;
  std::vector<ExactVector> table;  // the last row, T_k1 to T_kk
  const ExactVector slope = f(y);
  for (int k = 1; k <= rows; ++k) {
    const int n = 2 * k;
    const Exact h = H / Exact(n);
    ExactVector before = y, now = y;
    for (std::size_t i = 0; i < y.size(); ++i) now[i] += h * slope[i];
    for (int j = 1; j < n; ++j) {
      const ExactVector rate = f(now);
      for (std::size_t i = 0; i < y.size(); ++i) {
        const Exact next = before[i] + Exact(2) * h * rate[i];
        before[i] = now[i], now[i] = next;
      }
    }
    const ExactVector rate = f(now);  // Gragg's smoothing
    ExactVector left = now;
    for (std::size_t i = 0; i < y.size(); ++i) left[i] = (before[i] + now[i] + h * rate[i]) / Exact(2);
    for (std::size_t j = 0; j < table.size(); ++j) {  // Aitken and Neville, in h^2
      const int coarse = 2 * (k - 1 - static_cast<int>(j));
      const Exact ratio = Exact::ratio(static_cast<long>(n) * n, static_cast<long>(coarse) * coarse);
      ExactVector better = left;
      result.error = 0;
      for (std::size_t i = 0; i < y.size(); ++i) {
        const Exact change = (left[i] - table[j][i]) / (ratio - Exact(1));
        better[i] += change;
        result.error = std::max(result.error, abs(change));
      }
      table[j] = left;
      left = better;
    }
    table.push_back(left);
  }
  result.y = table.back();
  return result;
}

/// y(t + H) in steps that err by no more than `tolerance`, halved as often as that takes.
inline ExactVector extrapolated(const ExactField& f, const ExactVector& y, const Exact& H, int rows,
                                const Exact& tolerance) {
  ExtrapolatedStep whole = extrapolated_step(f, y, H, rows);
  if (whole.error < tolerance) return std::move(whole.y);
  const Exact half = H / Exact(2);
  return extrapolated(f, extrapolated(f, y, half, rows, tolerance), half, rows, tolerance);
}

}  // namespace anholon::testing
