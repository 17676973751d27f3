// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A model whose program's inputs and outputs are GiNaC expressions over the same symbols.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "algebra/ginac_view.hpp"
#include "check/evaluate_program.hpp"
#include "derive/derive.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"

namespace anholon::test {

using GiNaC::ex;
using Expressions = std::vector<ex>;

class SymbolicModel {
 public:
  explicit SymbolicModel(Model model, const DeriveRequest& request = {})
      : model_(std::move(model)),
        derivation_(derive(model_, request)),
        partition_(partition_of(model_)),
        view_(derivation_->program.tape) {
    Expressions parameters;
    for (const ParameterInfo& p : derivation_->program.parameters)
      parameters.push_back(view_.to_ginac(p.node));
    mechanism_ = mechanise<ex>(describe_mechanism(model_), parameters);
  }

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Derivation& derivation() const { return *derivation_; }
  [[nodiscard]] const Partition& partition() const { return partition_; }
  [[nodiscard]] const Mechanism<ex>& mechanism() const { return mechanism_; }

  /// The symbols of an input block; none where the program has no such block.
  Expressions input(const std::string& name) {
    Expressions symbols;
    for (const InputBlock& block : derivation_->program.inputs) {
      if (block.name != name) continue;
      for (const NodeId id : block.nodes) symbols.push_back(view_.to_ginac(id));
    }
    return symbols;
  }
  ex parameter(const std::string& name) {
    for (const ParameterInfo& p : derivation_->program.parameters) {
      if (p.name == name) return view_.to_ginac(p.node);
    }
    throw std::invalid_argument("no parameter " + name);
  }
  ex node(NodeId id) { return view_.to_ginac(id); }
  /// An output block of a function.
  Matrix<ex> output(const std::string& function, const std::string& name) {
    const Function* found = find_function(derivation_->program, function);
    if (found == nullptr) throw std::invalid_argument("no function " + function);
    for (const OutputBlock& block : found->outputs) {
      if (block.name != name) continue;
      Matrix<ex> m(block.rows, block.cols);
      for (int i = 0; i < block.rows; ++i) {
        for (int j = 0; j < block.cols; ++j)
          m(i, j) = node(block.nodes[static_cast<std::size_t>(i * block.cols + j)]);
      }
      return m;
    }
    return {};
  }
  /// normal(e) == 0 with c^2 + s^2 = 1.
  bool vanishes(const ex& e) { return view_.vanishes(e); }

  /// A state of the program's symbols with passive velocities `passive` and the input r_a_dot.
  State<ex> state(const Expressions& passive) {
    State<ex> s;
    s.t = 0;
    if (model_.group == GroupKind::SE2) {
      const Expressions g = input("g");
      s.p = {g[0], g[1], 0};
      s.R = AxisRotation<ex>{2, GiNaC::cos(g[2]), GiNaC::sin(g[2])}.matrix();
    }
    if (model_.group == GroupKind::R1) s.p.x = input("p").at(0);
    s.r.assign(model_.coordinates.size(), ex(0));
    s.r_dot = s.r;
    const Expressions r_p = input("r_p"), r_a = input("r_a"), r_a_dot = input("r_a_dot");
    const auto components = free_components(model_.group);
    for (std::size_t i = 0; i < passive.size(); ++i) {
      const int at = partition_.passive[i] - partition_.n;
      if (at < 0) {
        s.eta[components[i]] = passive[i];
      } else {
        s.r[static_cast<std::size_t>(at)] = r_p[i - static_cast<std::size_t>(partition_.n)];
        s.r_dot[static_cast<std::size_t>(at)] = passive[i];
      }
    }
    for (std::size_t i = 0; i < r_a.size(); ++i) {
      const auto at = static_cast<std::size_t>(partition_.active[i] - partition_.n);
      s.r[at] = r_a[i], s.r_dot[at] = r_a_dot[i];
    }
    return s;
  }

 private:
  Model model_;
  std::unique_ptr<Derivation> derivation_;
  Partition partition_;
  GinacView view_;
  Mechanism<ex> mechanism_;
};

inline Model shipped_model(const std::string& name) {
  return read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + name + "/" + name + ".toml");
}

}  // namespace anholon::test
