// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What is gathered of one output over the samples, and the judgement on it.

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "check/error_measure.hpp"
#include "check/verify.hpp"

namespace anholon {

struct OutputRecord {
  std::vector<double> error, scale;  // one a sample at which the function was evaluated
  std::vector<int> sample;           // from 1
  std::vector<double> recursion_error;
};

/// Condition of the output at a sample, given the scale and the relative error there.
using ConditionAt = std::function<double(int sample, double scale, double error)>;

/// Relative error that an output of this condition may have: ten times what rounding its inputs costs.
inline double allowed(double kappa) { return 10 * eps * kappa; }

/// Errors are relative to the largest magnitude of the output at the sample, or to its median over the
/// samples where that is larger. Beyond the bound an error needs the condition of the output as a reason.
inline OutputError judged(const OutputRecord& record, double bound, const ConditionAt& condition) {
  std::vector<double> sizes = record.scale;
  std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2));
  const double typical = sizes[sizes.size() / 2];
  OutputError e;
  double farthest = 1;  // beyond what is allowed
  std::vector<double> relative;
  for (std::size_t i = 0; i < record.error.size(); ++i) {
    const double scale = std::max({record.scale[i], typical, std::numeric_limits<double>::min()});
    const double error = record.error[i] / scale;
    relative.push_back(error);
    if (!(error <= e.worst)) e.worst = error, e.worst_at = fmt::format("sample {}", record.sample[i]);
    if (error <= bound) continue;
    const double kappa = condition(record.sample[i], scale, error);
    e.condition = std::max(e.condition, kappa);
    if (error <= farthest * allowed(kappa)) continue;
    e.passed = false;
    farthest = error / allowed(kappa);
    e.failed_at = fmt::format("sample {}: {:.1f} ulps, kappa {:.1e}", record.sample[i], error / eps, kappa);
  }
  std::ranges::sort(relative);
  e.median = relative[relative.size() / 2];
  e.p99 = relative[std::min(relative.size() - 1, relative.size() * 99 / 100)];
  if (!record.recursion_error.empty()) e.recursion_worst = *std::ranges::max_element(record.recursion_error);
  return e;
}

}  // namespace anholon
