// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Random inputs of a whole program, at which the optimiser measures rounding.

#include <map>
#include <string>
#include <vector>

#include "describe/model.hpp"
#include "reduce/samples.hpp"
#include "tape/interface.hpp"

namespace anholon {

class SampledInputs {
 public:
  explicit SampledInputs(const Model& model) : model_(model) {}

  /// Pose and shape in the working range, everything else in +-1, parameters at their defaults. The value of
  /// an input depends on its name and the number of the state alone, not on which other inputs there are.
  /// @return for each state one value for each input of the tape, in order of their making
  std::vector<std::vector<double>> operator()(const Program& program, int states);

 private:
  using PositionBlocks = std::map<std::string, std::vector<double>>;
  PositionBlocks next_position();

  const Model& model_;
  SampleSource source_;
  std::vector<PositionBlocks> positions_;  // of the states so far: they cost more than all else
};

}  // namespace anholon
