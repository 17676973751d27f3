// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A model's program in exact arithmetic: values of outputs, and their derivatives along directions of the
// inputs.

#include <map>
#include <memory>
#include <stdexcept>

#include "derive/derive.hpp"
#include "describe/read_model.hpp"
#include "tape/derivative.hpp"
#include "tape/interpret.hpp"

namespace anholon::test {

using Values = std::vector<Exact>;
/// Values of input blocks by name; blocks that are left out are zero, R is the identity.
using Inputs = std::map<std::string, Values>;

class ProgramValues {
 public:
  explicit ProgramValues(const std::string& name, const ParameterValues& parameters = {},
                         std::vector<std::string> functions = {})
      : model_(read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + name + "/" + name + ".toml",
                          parameters)) {
    DeriveRequest request;
    request.functions = std::move(functions);
    request.closed_forms = false;
    derivation_ = derive(model_, request);
  }
  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Derivation& derivation() const { return *derivation_; }

  [[nodiscard]] Values operator()(const std::string& function, const std::string& output,
                                  const Inputs& in) const {
    return values(block(function, output), in);
  }
  /// Derivative along a direction of the inputs.
  [[nodiscard]] Values derivative(const std::string& function, const std::string& output, const Inputs& in,
                                  const Inputs& direction) const {
    Tape& tape = derivation_->program.tape;
    std::vector<std::pair<NodeId, NodeId>> tangent;
    for (const InputBlock& b : derivation_->program.inputs) {
      const auto given = direction.find(b.name);
      if (given == direction.end()) continue;
      for (std::size_t i = 0; i < b.nodes.size(); ++i)
        tangent.emplace_back(b.nodes[i], tape.constant(given->second.at(i)));
    }
    return values(directional_derivative(tape, block(function, output), tangent), in);
  }

 private:
  [[nodiscard]] const std::vector<NodeId>& block(const std::string& function,
                                                 const std::string& output) const {
    for (const Function& f : derivation_->program.functions) {
      if (f.name != function) continue;
      for (const OutputBlock& b : f.outputs) {
        if (b.name == output) return b.nodes;
      }
    }
    throw std::out_of_range(function + "." + output);
  }
  [[nodiscard]] Values values(const std::vector<NodeId>& roots, const Inputs& in) const {
    const Program& program = derivation_->program;
    Values inputs(program.tape.inputs().size(), Exact(0));
    for (const ParameterInfo& p : program.parameters) inputs[program.tape.node(p.node).a] = p.value;
    for (const InputBlock& b : program.inputs) {
      const auto given = in.find(b.name);
      for (std::size_t i = 0; i < b.nodes.size(); ++i) {
        Exact& x = inputs[program.tape.node(b.nodes[i]).a];
        if (given != in.end()) x = given->second.at(i);
        if (given == in.end() && b.name == "R") x = Exact(i % 4 == 0 ? 1 : 0);
      }
    }
    return interpret<Exact>(program.tape, roots, inputs);
  }

  Model model_;
  std::unique_ptr<Derivation> derivation_;
};

}  // namespace anholon::test
