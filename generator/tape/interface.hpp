// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A program: one tape and the ordered functions over it. The C++ header, the flat C interface, the JSON and
// the documentation are all written from this table.

#include <optional>
#include <string>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// A parameter of the generated code: a member of `struct Parameters`.
struct ParameterInfo {
  std::string name;
  std::string unit;
  std::string meaning;
  Exact value;  // default
  NodeId node = 0;
};

/// A group of inputs that functions take as one array argument: "r_p", "nu", "R", ...
struct InputBlock {
  std::string name;
  std::string unit;
  std::string meaning;  // names of the entries, frame
  int rows = 0;
  int cols = 1;
  std::vector<NodeId> nodes;  // row-major
};

struct OutputBlock {
  std::string name;
  std::string unit;
  std::string meaning;
  int rows = 0;
  int cols = 1;
  std::vector<NodeId> nodes;  // row-major
};

/// How a function whose straight line would be too long is written: the outputs of another function, and
/// loops of templates/tree_loops.inl over them.
struct TreeLoops {
  enum class Kind { mass_factor, inverse_mass_matrix, regressor };
  Kind kind = Kind::mass_factor;
  std::string from;            // function that is called first
  std::vector<int> parent;     // of coordinates of M, or of bodies; -1 at the base
  std::vector<int> end;        // inverse_mass_matrix: one behind the subtree of each coordinate
  std::vector<int> row;        // regressor: of Y, by body
  std::vector<int> component;  // regressor: of the base wrench, by row
  int rows = 0;                // regressor: of Y
};

struct Function {
  std::string name;
  std::string meaning;               // one sentence and the equation, becomes the docstring
  std::vector<OutputBlock> outputs;  // blocks of size 0 are left out before emission
  std::string remark;                // e.g. which candidate won, singular configurations
  std::optional<TreeLoops> loops{};  // what is emitted instead of the nodes of outputs
};

struct Program {
  std::string name_space;     // <model>::<scene>[::<mode>][::chart<i>]
  std::string model;          // name of the model
  std::string scene;          // name of the scene, "standard" where none is given
  std::string source_file;    // base name of the description
  std::string source_sha256;  // of its bytes
  std::vector<std::string>
      notes;  // lines of the header comment: class in Table I, kernel, state layout, candidates
  Tape tape;
  std::vector<ParameterInfo> parameters;
  std::vector<InputBlock> inputs;  // in the order of arguments; functions take those that they use
  std::vector<Function> functions;
};

}  // namespace anholon
