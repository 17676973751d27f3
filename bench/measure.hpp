// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Times of several contenders, taken in turn: whatever else the machine does meets all of them alike, and a
// ratio is formed within one round before its median is taken.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace anholon::bench {

/// A way to compute one function at every sample of a list.
struct Contender {
  std::string name;
  std::function<void()> run_all;                                  // once at every sample
  std::function<std::vector<double>(std::size_t sample)> values;  // (n + s), or empty: not comparable
};

struct Timing {
  double median = 0, lower = 0, upper = 0, least = 0;  // ns per call: median, quartiles, minimum
  double ratio = 0;  // median over the rounds of (this time / time of the first contender)
};

/// @param calls  samples that one run_all() goes through
/// @param rounds  each runs every contender once, the order turning from round to round
std::vector<Timing> measure(const std::vector<Contender>& contenders, std::size_t calls, int rounds);

}  // namespace anholon::bench
