// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Where in the working range does a quality fall to zero? Samples cannot tell on surfaces that they happen to
// miss, so this searches: from the worst of many random configurations downhill, in double.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "describe/model.hpp"
#include "reduce/samples.hpp"

namespace anholon {

class ConfigurationSearch {
 public:
  /// Numbers at a configuration, at zero velocities.
  using Values = std::function<std::vector<double>(const State<double>&)>;
  /// At most 1, and 0 where something is singular.
  using Quality = std::function<double(const State<double>&)>;

  /// @param values  all that the qualities depend on: which coordinates matter is learnt from it
  ConfigurationSearch(const Model& model, const Values& values);

  /// Random configurations of the working range.
  [[nodiscard]] const std::vector<State<double>>& states() const { return states_; }
  /// Whether the values are the same everywhere.
  [[nodiscard]] bool is_constant() const { return coordinates_.empty() && !orientation_; }
  /// A configuration where the quality is at most `enough`, if a descent finds one.
  std::optional<State<double>> lowest(const Quality& quality, double enough);
  /// "r1 = 0.7, R = [[...], [...], [...]]": what matters alone, three digits.
  [[nodiscard]] std::string text_of(const State<double>& s) const;

  /// Middle value of those that are finite, never zero; 1 where there is none.
  static double median(std::vector<double> values);

 private:
  State<double> neighbour(const State<double>& s, double step);

  const Model& model_;
  SampleSource source_{4};  // another seed than that of the samples
  std::vector<State<double>> states_;
  std::vector<std::size_t> coordinates_;  // on which the values depend
  bool orientation_ = false;
};

/// The configuration rounded to doubles, velocities zero.
State<double> rounded_configuration(const State<Exact>& from);

}  // namespace anholon
