// SPDX-License-Identifier: GPL-2.0-or-later
#include "measure.hpp"

#include <algorithm>
#include <ctime>

namespace anholon::bench {
namespace {

double quantile(std::vector<double> v, double q) {
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(v.size() - 1) + 0.5);
  std::nth_element(v.begin(), v.begin() + at, v.end());
  return v[static_cast<std::size_t>(at)];
}

/// Processor time of this thread, ns: a turn that others interrupt is not charged for it.
double clock_ns() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

}  // namespace

std::vector<Timing> measure(const std::vector<Contender>& contenders, std::size_t calls, int rounds) {
  std::vector<std::vector<double>> times(contenders.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      const std::size_t turn = (i + static_cast<std::size_t>(round)) % contenders.size();
      contenders[turn].run_all();  // its code and data are in the caches, whoever ran before
      const double start = clock_ns();
      contenders[turn].run_all();
      times[turn].push_back((clock_ns() - start) / static_cast<double>(calls));
    }
  }
  std::vector<Timing> result;
  for (const std::vector<double>& t : times) {
    std::vector<double> ratios;
    for (std::size_t round = 0; round < t.size(); ++round) ratios.push_back(t[round] / times[0][round]);
    result.push_back(
        {quantile(t, 0.5), quantile(t, 0.25), quantile(t, 0.75), quantile(t, 0), quantile(ratios, 0.5)});
  }
  return result;
}

}  // namespace anholon::bench
