// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/evaluate.hpp"

#include "check/compiled_caller.hpp"
#include "check/evaluate_recursion.hpp"

namespace anholon {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

nlohmann::ordered_json evaluate_states(const Model& model, const StatesFile& states,
                                       const EvaluateRequest& request) {
  Json result;
  result["schema"] = "anholon.evaluate/1";
  result["model"] = model.name;
  const char* names[] = {"generated", "recursion", "exact"};
  result["method"] = names[static_cast<int>(request.method)];
  result["coordinates"] = {{"r_p", states.r_p}, {"r_a", states.r_a}};
  Json& list = result["states"] = Json::array();
  const Partition partition = partition_of(model);
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
  const MechanismDescription description = describe_mechanism(model);
  if (request.method == EvaluationMethod::recursion) {
    std::vector<double> parameters;
    for (const Exact& p : states.parameters) parameters.push_back(p.to_double());
    const Mechanism<double> mechanism = mechanise<double>(description, parameters);
    for (const auto& entry : states.states) {
      const auto input = rounded_input<double>(entry.input);
      add(entry, answer(model, states, evaluate_recursion(mechanism, partition, input, 1e-9), input, 17));
    }
    return result;
  }
  const WorkingDigits precision(request.digits + 10);  // ten guard digits
  const Mechanism<Exact> mechanism = mechanise<Exact>(description, states.parameters);
  const Exact threshold = Exact(1) / Exact::from_decimal("1e" + std::to_string(request.digits / 2));
  for (const auto& entry : states.states) {
    add(entry, answer(model, states, evaluate_recursion(mechanism, partition, entry.input, threshold),
                      entry.input, request.digits));
  }
  return result;
}

}  // namespace anholon
