// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What depends on parameters alone is computed once per parameter set, not once per call.

#include <vector>

#include "optimise/tape/count.hpp"
#include "tape/tape.hpp"

namespace anholon {

struct Hoisted {
  std::vector<NodeId> parameters;  // bare parameters that the functions use, in the given order
  std::vector<NodeId>
      values;  // maximal operations on parameters that the functions use, in order of emission
};

/// @param roots  outputs of all functions together
/// @param parameters  input nodes that are constant between calls
Hoisted hoist(const Tape& tape, const std::vector<NodeId>& roots, const std::vector<NodeId>& parameters);

/// Operations of one call: what depends on parameters alone is computed by `prepare` and costs nothing here.
OperationCount operations_per_call(const Tape& tape, const std::vector<NodeId>& roots,
                                   const std::vector<NodeId>& parameters);

}  // namespace anholon
