// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The functions of a program at one state, through whatever runs them: compiled code, or an interpreter of
// the tape.

#include <functional>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "anholon/charts.hpp"
#include "check/evaluated.hpp"
#include "derive/derive.hpp"
#include "tape/interpret.hpp"

namespace anholon {

template <class S>
using NamedValues = std::map<std::string, std::vector<S>>;
/// Runs a function by name; answers its output blocks.
template <class S>
using ProgramCaller =
    std::function<NamedValues<S>(const std::string& function, const NamedValues<S>& inputs)>;

/// To the last digit that long double has.
inline NamedValues<long double> in_long_double(const NamedValues<Exact>& exact) {
  NamedValues<long double> values;
  for (const auto& [name, block] : exact) {
    for (const Exact& x : block) {
      const double head = x.to_double();
      values[name].push_back(static_cast<long double>(head) + (x - Exact::from_double(head)).to_double());
    }
  }
  return values;
}

inline const Function* find_function(const Program& program, const std::string& name) {
  for (const Function& f : program.functions) {
    if (f.name == name) return &f;
  }
  return nullptr;
}

/// One value for each input of the tape, in order of their making; of blocks without a value zero.
template <class S>
std::vector<S> flat_inputs(const Program& program, const std::vector<S>& parameters,
                           const NamedValues<S>& named) {
  std::vector<S> inputs(program.tape.inputs().size(), S(0));
  for (std::size_t i = 0; i < program.parameters.size(); ++i)
    inputs[program.tape.node(program.parameters[i].node).a] = parameters[i];
  for (const InputBlock& block : program.inputs) {
    const auto value = named.find(block.name);
    if (value == named.end()) continue;
    if (value->second.size() != block.nodes.size())
      throw std::invalid_argument("input block '" + block.name + "' has the wrong size");
    for (std::size_t i = 0; i < block.nodes.size(); ++i)
      inputs[program.tape.node(block.nodes[i]).a] = value->second[i];
  }
  return inputs;
}

/// Runs the tape itself; parameters at the given values.
template <class S>
ProgramCaller<S> interpreting_caller(const Program& program, std::vector<S> parameters) {
  auto interpreters = std::make_shared<std::map<std::string, Interpreter<S>>>();
  return [&program, parameters, interpreters](const std::string& name, const NamedValues<S>& named) {
    const Function* function = find_function(program, name);
    if (function == nullptr) throw std::invalid_argument("the program has no function '" + name + "'");
    auto found = interpreters->find(name);
    if (found == interpreters->end()) {
      std::vector<NodeId> roots;
      for (const OutputBlock& b : function->outputs)
        roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
      found = interpreters->emplace(name, Interpreter<S>(program.tape, roots)).first;
    }
    const std::vector<S> inputs = flat_inputs(program, parameters, named);
    std::vector<S> flat(found->second.output_count(), S(0));
    found->second(inputs, flat);
    NamedValues<S> outputs;
    std::size_t next = 0;
    for (const OutputBlock& b : function->outputs) {
      outputs[b.name].assign(flat.begin() + static_cast<std::ptrdiff_t>(next),
                             flat.begin() + static_cast<std::ptrdiff_t>(next + b.nodes.size()));
      next += b.nodes.size();
    }
    return outputs;
  };
}

/// Pose and shape as the program's input blocks.
template <class S>
NamedValues<S> position_inputs(const Model& model, const Partition& partition, const State<S>& state) {
  using std::atan2;
  NamedValues<S> in;
  in["t"] = {state.t};
  in["g"] = {state.p.x, state.p.y, atan2(state.R(1, 0), state.R(0, 0))};
  in["R"] = {state.R.m.begin(), state.R.m.end()};
  for (const int c : free_components(model.group)) {
    if (c < 3) in["p"].push_back(state.p[c]);
  }
  for (auto i = static_cast<std::size_t>(partition.n); i < partition.passive.size(); ++i)
    in["r_p"].push_back(state.r[static_cast<std::size_t>(partition.passive[i] - partition.n)]);
  for (const int i : partition.active)
    in["r_a"].push_back(state.r[static_cast<std::size_t>(i - partition.n)]);
  return in;
}

/// Which chart of the kernel is best at a position; 0 where there is one. By double arithmetic, in which a
/// chart that divides by zero is no fault, and at the default parameters. `family` stands before the name of
/// the function that tells: "torque_driven_" for the functions of that name.
template <class S>
using ChartFinder = std::function<std::size_t(const NamedValues<S>& position)>;
template <class S>
ChartFinder<S> chart_finder(const Derivation& derivation, const std::string& family = "") {
  const std::string name = family + "chart_quality";
  if (find_function(derivation.program, name) == nullptr)
    return [](const NamedValues<S>&) { return std::size_t{0}; };
  std::vector<double> parameters;
  for (const ParameterInfo& p : derivation.program.parameters) parameters.push_back(p.value.to_double());
  return [name, call = interpreting_caller<double>(derivation.program, parameters)](
             const NamedValues<S>& position) {
    NamedValues<double> rounded;
    for (const char* name : {"t", "g", "R", "p", "r_p", "r_a"}) {
      const auto block = position.find(name);
      if (block == position.end()) continue;
      for (const S& x : block->second) {
        if constexpr (std::is_same_v<S, double>) {
          rounded[name].push_back(x);
        } else {
          rounded[name].push_back(x.to_double());
        }
      }
    }
    const std::vector<double> quality = call(name, rounded).at("quality");
    return best_chart(std::span<const double>(quality));
  };
}

/// Every function that the program has, those of the best chart where there are several.
template <class S>
Evaluated<S> evaluate_program(const Model& model, const Derivation& derivation, const ProgramCaller<S>& call,
                              const EvaluationInput<S>& input);

extern template Evaluated<double> evaluate_program(const Model&, const Derivation&,
                                                   const ProgramCaller<double>&,
                                                   const EvaluationInput<double>&);
extern template Evaluated<Exact> evaluate_program(const Model&, const Derivation&,
                                                  const ProgramCaller<Exact>&, const EvaluationInput<Exact>&);

}  // namespace anholon
