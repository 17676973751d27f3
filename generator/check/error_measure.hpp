// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// How far computed values are from exact ones.

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "number/exact.hpp"

namespace anholon {

/// Largest magnitude.
inline double size_of(const std::vector<Exact>& v) {
  double largest = 0;
  for (const Exact& x : v) largest = std::max(largest, std::abs(x.to_double()));
  return largest;
}

/// Largest difference; infinite where a value is not finite.
template <class S>
double distance(const std::vector<S>& a, const std::vector<Exact>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if constexpr (std::is_same_v<S, double>) {
      if (!std::isfinite(a[i])) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, std::abs((Exact::from_double(a[i]) - b[i]).to_double()));
    } else {
      largest = std::max(largest, std::abs((a[i] - b[i]).to_double()));
    }
  }
  return largest;
}

}  // namespace anholon
