// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Random states of a tree, as inputs of its program and as a State of its mechanism.

#include <random>
#include <string>
#include <vector>

#include "anholon/mechanism.hpp"
#include "tape/interface.hpp"
#include "tape/interpret.hpp"

namespace anholon::testing {

template <class S>
struct RandomState {
  State<S> state;
  std::vector<S> acceleration;  // eta_dot, r_ddot
  std::vector<S> tau;
  std::vector<S> inputs;  // of the program's tape
};

/// @param convert  makes S of a double
template <class S, class Convert>
RandomState<S> random_state(const Program& program, std::mt19937& random, const Convert& convert) {
  std::uniform_real_distribution<double> uniform(-2, 2);
  RandomState<S> x;
  x.inputs.assign(program.tape.inputs().size(), S(0));
  for (const ParameterInfo& p : program.parameters)
    x.inputs[program.tape.node(p.node).a] = FromExact<S>{}(p.value);
  const auto fill = [&](const std::string& name, const auto& take) {
    for (const InputBlock& b : program.inputs) {
      if (b.name != name) continue;
      for (std::size_t i = 0; i < b.nodes.size(); ++i) x.inputs[program.tape.node(b.nodes[i]).a] = take(i);
    }
  };
  // a rotation from a quaternion of integers is a rotation in exact numbers too
  std::uniform_int_distribution<int> digit(-9, 9);
  const S a = S(digit(random)), b = S(digit(random)), c = S(digit(random)), d = S(11);
  const S n = a * a + b * b + c * c + d * d;
  const Mat3<S> R = {
      {(d * d + a * a - b * b - c * c) / n, S(2) * (a * b - c * d) / n, S(2) * (a * c + b * d) / n,
       S(2) * (a * b + c * d) / n, (d * d - a * a + b * b - c * c) / n, S(2) * (b * c - a * d) / n,
       S(2) * (a * c - b * d) / n, S(2) * (b * c + a * d) / n, (d * d - a * a - b * b + c * c) / n}};
  const auto remember = [&](std::vector<S>& to) {
    return [&](std::size_t) {
      to.push_back(convert(uniform(random)));
      return to.back();
    };
  };
  std::vector<S> eta, eta_dot, r_ddot, p;
  fill("R", [&](std::size_t i) {
    x.state.R = R;
    return R.m[i];
  });
  fill("p", remember(p));
  fill("r", remember(x.state.r));
  fill("eta", remember(eta));
  fill("r_dot", remember(x.state.r_dot));
  fill("eta_dot", remember(eta_dot));
  fill("r_ddot", remember(r_ddot));
  fill("tau", remember(x.tau));
  for (std::size_t i = 0; i < p.size(); ++i) x.state.p[static_cast<int>(i)] = p[i];
  for (std::size_t i = 0; i < eta.size(); ++i) x.state.eta[static_cast<int>(i)] = eta[i];
  x.acceleration = eta_dot;
  x.acceleration.insert(x.acceleration.end(), r_ddot.begin(), r_ddot.end());
  return x;
}

/// Outputs of a function, one behind the other.
template <class S>
std::vector<S> run(const Program& program, const std::string& function, const std::vector<S>& inputs) {
  std::vector<NodeId> roots;
  for (const Function& f : program.functions) {
    if (f.name != function) continue;
    for (const OutputBlock& b : f.outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  }
  return interpret<S>(program.tape, roots, inputs);
}

}  // namespace anholon::testing
