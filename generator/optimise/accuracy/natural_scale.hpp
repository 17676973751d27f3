// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

namespace anholon {

/// Of an even number the larger of the two in the middle; at least one.
inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// What the error of a block is measured by at each state: its largest entry there or, where that is larger,
/// at the median state. Not zero.
/// @param largest  magnitude of the largest entry at each state
/// @param random  so many states at the front are random ones; the median is theirs
inline std::vector<double> natural_scales(const std::vector<double>& largest, std::size_t random) {
  if (largest.empty()) return {};
  const auto random_end = largest.begin() + static_cast<std::ptrdiff_t>(std::min(random, largest.size()));
  const double typical = median_of({largest.begin(), random_end});
  std::vector<double> scales;
  for (const double x : largest) scales.push_back(std::max({x, typical, std::numeric_limits<double>::min()}));
  return scales;
}

}  // namespace anholon
