// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Processor times of several contenders, taken in turn: whatever else the machine does meets all of them
// alike, and a ratio is formed within one round before its median is taken.

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace anholon::bench {

/// A way to compute one function at every sample of a list.
struct Contender {
  std::string name;
  std::function<void()> run_all;                                  // once at every sample
  std::function<std::vector<double>(std::size_t sample)> values;  // empty: not comparable
  double tolerance =
      1e-12;  // of values, relative to the largest component: rounding of up to 10^4 operations
};

/// run(i) computes the function at sample i, values(i) then hands out what it has left.
/// @param count  number of samples
template <class Run, class Values>
Contender contender(std::string name, std::size_t count, const Run& run, const Values& values,
                    double tolerance = 1e-12) {
  return {std::move(name),
          [run, count] {
            for (std::size_t i = 0; i < count; ++i) run(i);
          },
          [run, values](std::size_t i) {
            run(i);
            return values(i);
          },
          tolerance};
}

struct Timing {
  double median = 0, lower = 0, upper = 0, least = 0;  // ns per call: median, quartiles, minimum
  double ratio = 0;  // median over the rounds of (this time / time of the first contender)
};

/// @param calls  samples that one run_all() goes through
/// @param rounds  each runs every contender twice, of which the second time counts; the order turns from
/// round to round
std::vector<Timing> measure(const std::vector<Contender>& contenders, std::size_t calls, int rounds);

}  // namespace anholon::bench
