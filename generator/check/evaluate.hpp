// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Evaluation of a model at states, by generated code, numeric recursion, or in exact arithmetic.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "check/evaluate_program.hpp"
#include "check/states_json.hpp"
#include "derive/tree_functions.hpp"

namespace anholon {

enum class EvaluationMethod { generated, recursion, exact };

struct EvaluateRequest {
  EvaluationMethod method = EvaluationMethod::generated;
  unsigned digits = 50;  // of the exact method
  Inverse inverse = Inverse::pseudo;
  std::vector<int> leading_rows;
  OptimiseFor optimise = OptimiseFor::balanced;  // of the generated code
  std::optional<TreeRequest> tree;  // functions of a driven tree in place of those of the reduction
};

/// Answer in the layout of the reference files, schema "anholon.evaluate/1".
nlohmann::ordered_json evaluate_states(const Model& model, const StatesFile& states,
                                       const EvaluateRequest& request);

}  // namespace anholon
