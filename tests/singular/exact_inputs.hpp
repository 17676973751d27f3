// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The same inputs for double code and for exact arithmetic, and how far their outputs are apart.

#include <cmath>
#include <string>
#include <vector>

#include "check/compiled_caller.hpp"
#include "check/evaluate_program.hpp"

namespace anholon::test {

struct BothInputs {
  NamedValues<double> rounded;
  NamedValues<Exact> exact;
  void set(const std::string& name, const std::vector<double>& values) {
    rounded[name] = values;
    exact[name].clear();
    for (const double x : values) exact[name].push_back(Exact::from_double(x));
  }
};

/// Largest difference, relative to the largest entry; infinite where an entry is not finite.
inline double distance(const std::vector<double>& a, const std::vector<Exact>& b) {
  double largest = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(a[i])) return INFINITY;
    largest = std::max(largest, std::abs((Exact::from_double(a[i]) - b[i]).to_double()));
    size = std::max(size, std::abs(b[i].to_double()));
  }
  return size > 0 ? largest / size : largest;
}

inline double distance(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<Exact> exact;
  for (const double x : b) exact.push_back(Exact::from_double(x));
  return distance(a, exact);
}

/// The parameters as double code is given them.
inline std::vector<Exact> rounded_parameters(const Model& model) {
  std::vector<Exact> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(Exact::from_double(p.value.to_double()));
  return parameters;
}

}  // namespace anholon::test
