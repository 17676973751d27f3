// SPDX-License-Identifier: MIT
#pragma once

// Which chart of a kernel atlas to go on in. A chart is a basis H of the admissible velocities that divides
// by pivots, good where these stay away from zero; generated code answers by `chart_quality` how good each is
// at a configuration: 1 / sqrt(1 + sum of the squares of what it amplifies), 0 where it is singular. On a
// switch the physical velocities stay: nu of the new chart is what its `reduced_velocities` makes of those
// that the old chart's `kinematics` gives.

#include <cstddef>
#include <span>

namespace anholon {

/// A chart is left when its quality falls below this part of the best: another must be four times better, so
/// that a motion along the border of two charts does not switch at every step.
template <class Real>
inline constexpr Real chart_hysteresis = Real(0.25L);

/// Index of the best chart; a quality that is not a number counts as zero.
template <class Real>
std::size_t best_chart(std::span<const Real> quality) {
  std::size_t best = 0;
  Real largest = Real(0);
  for (std::size_t i = 0; i < quality.size(); ++i) {
    if (quality[i] > largest) best = i, largest = quality[i];
  }
  return best;
}

/// Index of the chart to go on in: the current one while it is good enough.
template <class Real>
std::size_t next_chart(std::span<const Real> quality, std::size_t current) {
  const std::size_t best = best_chart(quality);
  return quality[current] >= chart_hysteresis<Real> * quality[best] ? current : best;
}

}  // namespace anholon
