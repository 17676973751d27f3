// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the header, the flat C interface and the JSON of one program have in common: its names, the arguments
// that each function takes, what is computed once per parameter set, and the counts.

#include <string>
#include <vector>

#include "optimise/tape/count.hpp"
#include "optimise/tape/hoist.hpp"
#include "tape/interface.hpp"

namespace anholon {

struct PlannedOutput {
  const OutputBlock* block = nullptr;
  std::string name;
};

struct PlannedFunction {
  const Function* function = nullptr;
  std::string name;                    // flat: chart2_kinematics
  std::string scope;                   // namespace within the program's: chart2; mostly empty
  std::string unqualified;             // name in that namespace: kinematics
  std::vector<std::size_t> inputs;     // indices into Program::inputs: those that the function reads
  std::vector<PlannedOutput> outputs;  // none of size 0
  OperationCount operations;           // per call, after prepare()
  OperationCount unprepared;           // without prepare(): parameters as any other input
};

struct EmissionPlan {
  std::vector<std::string> name_space;
  std::vector<std::string> parameter_names;      // of Program::parameters
  std::vector<std::string> input_names;          // of Program::inputs
  std::vector<std::size_t> prepared_parameters;  // indices: bare parameters that the functions read
  std::vector<NodeId> prepared_values;           // hoisted nodes
  std::vector<std::string> prepared_names;       // of the hoisted nodes
  OperationCount prepare_operations;
  std::vector<PlannedFunction> functions;  // those that have an output
};

/// @throws std::logic_error if sizes and node counts of a block differ, or two functions or parameters share
/// a name
EmissionPlan plan_emission(const Program& program);

}  // namespace anholon
