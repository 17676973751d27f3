// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

namespace anholon {

/// What the error of a block is measured by at each state: its largest entry there or, where that is larger,
/// at the median state. Not zero.
/// @param largest  magnitude of the largest entry at each state
/// @param random  so many states at the front are random ones; the median is theirs
inline std::vector<double> natural_scales(const std::vector<double>& largest, std::size_t random) {
  if (largest.empty()) return {};
  std::vector<double> sorted(largest.begin(),
                             largest.begin() + static_cast<std::ptrdiff_t>(std::min(random, largest.size())));
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  std::vector<double> scales;
  for (const double x : largest) scales.push_back(std::max({x, *middle, std::numeric_limits<double>::min()}));
  return scales;
}

}  // namespace anholon
