// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What is gathered of one output over the samples, and the judgement on it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "check/error_measure.hpp"
#include "check/verify.hpp"
#include "optimise/accuracy/natural_scale.hpp"

namespace anholon {

struct OutputRecord {
  std::vector<double> error, scale;  // one a sample at which the function was evaluated
  std::vector<int> sample;           // from 1
  std::vector<double> recursion_error;
};

/// Condition of an output at a sample, given the scale and the relative error there.
struct ConditionAt {
  std::function<double(int sample, double scale)> estimated;  // to first order
  std::function<double(int sample, double scale, double error)> measured;
};

/// Relative error that an output of this condition may have: ten times what rounding its inputs costs.
inline double allowed(double kappa) { return 10 * eps * kappa; }

/// Errors are relative to the largest magnitude of the output at the sample, or to its median over the
/// samples where that is larger. Beyond the bound an error needs the condition of the output as a reason: it
/// is measured where the estimate leaves less than a factor of two, and where the error is largest.
inline OutputError judged(const OutputRecord& record, double bound, const ConditionAt& condition) {
  constexpr double certain = 0.5;
  const std::vector<double> scale = natural_scales(record.scale, record.scale.size());
  OutputError e;
  std::vector<double> relative;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < record.error.size(); ++i) {
    const double error = record.error[i] / scale[i];
    relative.push_back(std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
    if (relative[i] > e.worst) e.worst = relative[i], worst = i;
  }
  if (e.worst != 0) e.worst_at = fmt::format("sample {}", record.sample[worst]);
  double farthest = 1;  // beyond what is allowed
  for (std::size_t i = 0; i < relative.size(); ++i) {
    if (relative[i] <= bound) continue;
    if (i != worst && relative[i] <= certain * allowed(condition.estimated(record.sample[i], scale[i])))
      continue;
    const double kappa = condition.measured(record.sample[i], scale[i], relative[i]);
    if (i == worst) e.condition = kappa;
    if (relative[i] <= farthest * allowed(kappa)) continue;
    e.passed = false;
    farthest = relative[i] / allowed(kappa);
    e.failed_at =
        fmt::format("sample {}: {:.1f} ulps, kappa {:.1e}", record.sample[i], relative[i] / eps, kappa);
  }
  std::ranges::sort(relative);
  e.median = relative[relative.size() / 2];
  e.p99 = relative[std::min(relative.size() - 1, relative.size() * 99 / 100)];
  if (!record.recursion_error.empty()) e.recursion_worst = *std::ranges::max_element(record.recursion_error);
  return e;
}

}  // namespace anholon
