// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/evaluate.hpp"

#include "cli/common.hpp"
#include "describe/function_names.hpp"

namespace anholon::cli {

int evaluate(const EvaluateOptions& options) {
  const Model model = load_model(options);
  const StatesFile states = read_states(options.states, model);
  const bool is_tree = wants_tree(options, model);
  const DeriveRequest request = is_tree ? DeriveRequest() : derive_request(options, model);
  EvaluateRequest wanted;
  wanted.method = options.method == "exact"       ? EvaluationMethod::exact
                  : options.method == "recursion" ? EvaluationMethod::recursion
                                                  : EvaluationMethod::generated;
  wanted.digits = options.digits;
  wanted.inverse = request.inverse;
  wanted.leading_rows = request.leading_rows;
  wanted.optimise = request.optimise;
  if (is_tree) wanted.tree = tree_request(options);
  refuse_unknown_functions(is_tree ? wanted.tree->functions : request.functions,
                           is_tree ? tree_function_names() : function_names());
  write_output(options.output, evaluate_states(model, states, wanted).dump(1) + "\n");
  return ok;
}

}  // namespace anholon::cli
