// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/evaluate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "check/compiled_caller.hpp"
#include "check/evaluate_recursion.hpp"
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
  const auto independent_rows = [&](const Partition& p) {
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

  if (request.method == EvaluationMethod::generated) {
    DeriveRequest wanted;
    wanted.inverse = request.inverse;
    wanted.leading_rows = request.leading_rows;
    const auto derivation = derive(model, wanted);
    const ProgramCaller<double> call = compiled_caller(derivation->program, states.parameters);
    for (const auto& entry : states.states) {
      const auto input = rounded_input<double>(entry.input);
      add(entry, answer(model, states, evaluate_program(model, *derivation, call, input), input, 17));
    }
    return result;
  }
  if (request.method == EvaluationMethod::recursion) {
    std::vector<double> parameters;
    for (const Exact& p : states.parameters) parameters.push_back(p.to_double());
    const Mechanism<double> mechanism = mechanise<double>(description, parameters);
    for (const auto& entry : states.states) {
      const auto input = rounded_input<double>(entry.input);
      add(entry,
          answer(model, states, evaluate_recursion(mechanism, partition, input, 1e-9, sharing), input, 17));
    }
    return result;
  }
  const WorkingDigits precision(request.digits + 10);  // ten guard digits
  const Mechanism<Exact> mechanism = mechanise<Exact>(description, states.parameters);
  const Exact threshold = Exact(1) / Exact::from_decimal("1e" + std::to_string(request.digits / 2));
  for (const auto& entry : states.states) {
    add(entry,
        answer(model, states, evaluate_recursion(mechanism, partition, entry.input, threshold, sharing),
               entry.input, request.digits));
  }
  return result;
}

}  // namespace anholon
