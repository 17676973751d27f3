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

/// States at which exact arithmetic judges. Those beyond are judged by long double, whose own error is 2^-11
/// of that of double; only where it finds more than the bound, exact arithmetic has the last word.
inline constexpr int exactly_judged = 1000;

inline constexpr double eps = std::numeric_limits<double>::epsilon();

/// Decimal digits of exact evaluation where it judges.
inline constexpr unsigned verification_digits = 60;

/// Largest magnitude.
template <class S>
double size_of(const std::vector<S>& v) {
  double largest = 0;
  for (const S& x : v) {
    if constexpr (std::is_same_v<S, Exact>) {
      largest = std::max(largest, std::abs(x.to_double()));
    } else {
      largest = std::max(largest, static_cast<double>(std::abs(x)));
    }
  }
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

inline double distance(const std::vector<double>& a, const std::vector<long double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i])) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, static_cast<double>(std::abs(a[i] - b[i])));
  }
  return largest;
}

}  // namespace anholon
