// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "check/evaluate_program.hpp"

namespace anholon {

/// How much an output can change, relative to its scale, when every input moves by one unit in the last
/// place, divided by that unit. Each input is moved alone and the sizes of the changes are added: to first
/// order, the worst choice of signs, which random signs miss where inputs nearly cancel.
template <class Function>
double relative_condition(const Function& output, const NamedValues<Exact>& in, double scale) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const std::vector<Exact> base = output(in);
  std::vector<double> change(base.size(), 0.0);
  NamedValues<Exact> moved = in;
  for (auto& [name, values] : moved) {
    for (Exact& x : values) {
      const Exact kept = x;
      x = x * (Exact(1) + Exact::from_double(eps));
      const std::vector<Exact> there = output(moved);
      for (std::size_t i = 0; i < base.size(); ++i) change[i] += std::abs((there[i] - base[i]).to_double());
      x = kept;
    }
  }
  return base.empty() ? 0 : *std::ranges::max_element(change) / scale / eps;
}

}  // namespace anholon
