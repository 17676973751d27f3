// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/evaluate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "check/compiled_caller.hpp"
#include "check/evaluate_recursion.hpp"
#include "check/evaluate_tree.hpp"
#include "derive/tree_functions.hpp"
#include "describe/mechanise.hpp"
#include "reduce/rank.hpp"

namespace anholon {
namespace {

using Json = nlohmann::ordered_json;

constexpr int rank_samples = 24;  // random states at which ranks are decided, besides the special ones

/// As the command line spells it: "pseudo" or "leading:1,2".
std::string inverse_name(const EvaluateRequest& request) {
  if (request.inverse == Inverse::pseudo) return "pseudo";
  std::vector<int> from_one;
  for (const int row : request.leading_rows) from_one.push_back(row + 1);
  return fmt::format("leading:{}", fmt::join(from_one, ","));
}

/// Blocks of functions; coordinates in the order of the description.
template <class S, class Call>
Json function_blocks(const std::vector<std::string>& functions, const Call& call, unsigned digits) {
  Json result;
  for (const std::string& function : functions) {
    for (const auto& [block, values] : call(function)) {
      if (!values.empty()) result[function][block] = number_list<S>(values, digits);
    }
  }
  return result;
}

std::vector<std::string> functions_named_in(const TreeRequest& request) {
  return request.functions.empty() ? standard_tree_functions() : request.functions;
}

/// Of a driven tree: what answer() writes comes from its functions too, and all that are named follow.
Json generated_tree(const Model& model, const StatesFile& states, const TreeRequest& request) {
  TreeRequest wanted = request;
  wanted.functions = functions_named_in(request);
  for (const std::string& name : functions_of_evaluation()) {
    if (std::ranges::find(wanted.functions, name) == wanted.functions.end()) wanted.functions.push_back(name);
  }
  const auto derivation = derive_tree(model, wanted);
  const ProgramCaller<double> call = compiled_caller(derivation->program, states.parameters);
  std::vector<double> parameters;
  for (const Exact& p : states.parameters) parameters.push_back(p.to_double());
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), parameters);
  Json list = Json::array();
  for (const auto& entry : states.states) {
    const auto input = rounded_input<double>(entry.input);
    const TreePoint<double> point = tree_point(input, entry.eta_dot);
    Json outputs = answer(model, states, evaluate_tree(mechanism, call, input, point), input, 17);
    const NamedValues<double> in = tree_inputs(mechanism, point);
    std::vector<std::string> named = functions_named_in(request);
    std::erase_if(named,
                  [&](const std::string& f) { return find_function(derivation->program, f) == nullptr; });
    outputs["functions"] = function_blocks<double>(
        named, [&](const std::string& f) { return call(f, in); }, 17);
    list.push_back({{"label", entry.label}, {"outputs", std::move(outputs)}});
  }
  return list;
}

}  // namespace

nlohmann::ordered_json evaluate_states(const Model& model, const StatesFile& states,
                                       const EvaluateRequest& request) {
  Json result;
  result["schema"] = "anholon.evaluate/1";
  result["model"] = model.name;
  const char* names[] = {"generated", "recursion", "exact"};
  result["method"] = names[static_cast<int>(request.method)];
  if (!model.rows.empty()) result["inverse"] = inverse_name(request);
  result["coordinates"] = {{"r_p", states.r_p}, {"r_a", states.r_a}};
  Json& list = result["states"] = Json::array();
  const Partition partition = partition_of(model);
  const MechanismDescription description = describe_mechanism(model);
  RowSharing sharing;
  sharing.leading = request.inverse == Inverse::leading;
  const auto samples = sample_states(model, rank_samples);
  const auto independent_rows = [&](const Partition& p) -> std::vector<int> {
    if (model.rows.empty()) return {};
    return analyse_ranks(description, states.parameters, p, samples, request.leading_rows).leading_rows;
  };
  sharing.locked = independent_rows(partition);
  sharing.free = independent_rows(partition_of(model, {"*"}));
  const std::size_t redundant = model.rows.size() - sharing.locked.size();
  for (const auto& entry : states.states) {
    const std::size_t given = entry.input.lambda_stat.size();
    if (given != 0 && !sharing.leading)
      throw ModelError({states.file, 0, 0}, fmt::format("state '{}' has 'lambda_stat'", entry.label),
                       "choose --inverse leading:ROWS, which says what it means");
    if (given != 0 && given != redundant)
      throw ModelError(
          {states.file, 0, 0},
          fmt::format("state '{}': 'lambda_stat' has {} entries, not {}", entry.label, given, redundant),
          "give one number for each redundant row, or leave it out");
  }
  const auto add = [&](const StatesFile::Entry& entry, Json outputs) {
    list.push_back({{"label", entry.label}, {"outputs", std::move(outputs)}});
  };

  if (request.method == EvaluationMethod::generated && request.tree) {
    list = generated_tree(model, states, *request.tree);
    return result;
  }
  if (request.method == EvaluationMethod::generated) {
    DeriveRequest wanted;
    wanted.inverse = request.inverse;
    wanted.leading_rows = request.leading_rows;
    wanted.optimise = request.optimise;
    const auto derivation = derive(model, wanted);
    const ProgramCaller<double> call = compiled_caller(derivation->program, states.parameters);
    for (const auto& entry : states.states) {
      const auto input = rounded_input<double>(entry.input);
      add(entry, answer(model, states, evaluate_program(model, *derivation, call, input), input, 17));
    }
    return result;
  }
  // the functions of a tree by the recursion, which an answer has behind everything else
  const auto add_functions = [&]<class S>(Json& outputs, const Mechanism<S>& mechanism,
                                          const TreePoint<S>& point, unsigned digits) {
    if (!request.tree) return;
    std::vector<std::string> named = functions_named_in(*request.tree);
    if (partition.n == 0) std::erase(named, "imposed_motion");
    outputs["functions"] = function_blocks<S>(
        named, [&](const std::string& f) { return tree_reference(mechanism, f, point); }, digits);
  };
  if (request.method == EvaluationMethod::recursion) {
    std::vector<double> parameters;
    for (const Exact& p : states.parameters) parameters.push_back(p.to_double());
    const Mechanism<double> mechanism = mechanise<double>(description, parameters);
    for (const auto& entry : states.states) {
      const auto input = rounded_input<double>(entry.input);
      Json outputs =
          answer(model, states, evaluate_recursion(mechanism, partition, input, 1e-9, sharing), input, 17);
      add_functions(outputs, mechanism, tree_point(input, entry.eta_dot), 17);
      add(entry, std::move(outputs));
    }
    return result;
  }
  const WorkingDigits precision(request.digits + 10);  // ten guard digits
  const Mechanism<Exact> mechanism = mechanise<Exact>(description, states.parameters);
  const Exact threshold = Exact(1) / Exact::from_decimal("1e" + std::to_string(request.digits / 2));
  for (const auto& entry : states.states) {
    Json outputs =
        answer(model, states, evaluate_recursion(mechanism, partition, entry.input, threshold, sharing),
               entry.input, request.digits);
    add_functions(outputs, mechanism, tree_point(entry.input, entry.eta_dot), request.digits);
    add(entry, std::move(outputs));
  }
  return result;
}

}  // namespace anholon
