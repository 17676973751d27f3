// SPDX-License-Identifier: GPL-2.0-or-later
// Motions and torques of a scene, copied from the tape of its model to that of its program.
#include <algorithm>
#include <string>

#include "describe/specialise.hpp"
#include "simulate/scene_program.hpp"
#include "tape/interpret.hpp"

namespace anholon {

std::vector<NodeId> scene_expressions(const Scene& scene, const SceneProgram& p,
                                      const std::vector<Expr>& expressions, std::size_t chart) {
  Program& program = p.derivation->program;
  Tape& from = *scene.model.tape;
  std::vector<Expr> inputs(from.inputs().size(), Expr(0));
  const StateSymbols& s = scene.model.symbols;
  const auto set = [&](NodeId symbol, NodeId value) {
    inputs[from.node(symbol).a] = Expr(program.tape, value);
  };
  const auto block = [&](const std::string& name) {
    const auto found = std::ranges::find(program.inputs, name, &InputBlock::name);
    return found == program.inputs.end() ? std::vector<NodeId>{} : found->nodes;
  };
  const auto velocity = [&](const std::string& name) {  // an output of the kinematics, or imposed
    for (const Function& f : program.functions) {
      for (const OutputBlock& b : f.outputs) {
        if (f.name == chart_prefix(chart) + "kinematics" && b.name == name) return b.nodes;
      }
    }
    return block(name);
  };
  for (std::size_t i = 0; i < scene.model.parameters.size(); ++i) {
    const Parameter& parameter = scene.model.parameters[i];
    const auto kept = std::ranges::find(program.parameters, parameter.name, &ParameterInfo::name);
    set(s.parameters[i],
        kept != program.parameters.end() ? kept->node : program.tape.constant(parameter.value));
  }
  set(s.t, block("t")[0]);
  const GroupKind group = p.model.group;
  if (group == GroupKind::SE2) {
    const std::vector<NodeId> g = block("g");
    const Mat3<Expr> R =
        AxisRotation<Expr>{2, cos(Expr(program.tape, g[2])), sin(Expr(program.tape, g[2]))}.matrix();
    for (std::size_t i = 0; i < 9; ++i) set(s.R[i], R.m[i].id(program.tape));
    set(s.p[0], g[0]), set(s.p[1], g[1]);
  } else {
    for (const std::size_t i : {0U, 4U, 8U}) set(s.R[i], program.tape.constant(1));
    const std::vector<NodeId> R = block("R"), position = block("p");
    for (std::size_t i = 0; i < R.size(); ++i) set(s.R[i], R[i]);
    for (std::size_t i = 0; i < position.size(); ++i) set(s.p[i], position[i]);
  }
  const auto components = free_components(group);
  const std::vector<NodeId> eta = velocity("eta"), r_p = block("r_p"), r_a = block("r_a");
  for (std::size_t i = 0; i < eta.size(); ++i) set(s.eta[static_cast<std::size_t>(components[i])], eta[i]);
  const std::vector<int> kept = kept_coordinates(scene.model, scene);
  const auto each = [&](const std::vector<NodeId>& nodes, const std::vector<int>& velocities,
                        const std::vector<NodeId>& symbols) {
    for (std::size_t c = 0; c < kept.size(); ++c) {
      const auto at = std::ranges::find(velocities, kept[c] + p.original.n);
      if (kept[c] >= 0 && at != velocities.end() && !nodes.empty())
        set(symbols[c], nodes[static_cast<std::size_t>(at - velocities.begin())]);
    }
  };
  const std::vector<int> passive(p.original.passive.begin() + p.original.n, p.original.passive.end());
  each(r_p, passive, s.r), each(r_a, p.original.active, s.r);
  each(velocity("r_p_dot"), passive, s.r_dot), each(velocity("r_d_dot"), p.driven, s.r_dot),
      each(block("r_a_dot"), p.reduced.active, s.r_dot);
  for (const LockedCoordinate& locked : scene.locked) {
    const NodeId value = locked.value.id(from);
    inputs[from.node(s.r[static_cast<std::size_t>(locked.coordinate)]).a] =
        interpret<Expr>(from, {value}, inputs, FromExact<Expr>{&program.tape}).front();
  }
  std::vector<NodeId> roots;
  for (const Expr& e : expressions) roots.push_back(e.id(from));
  std::vector<NodeId> result;
  for (const Expr& e : interpret<Expr>(from, roots, inputs, FromExact<Expr>{&program.tape}))
    result.push_back(e.id(program.tape));
  return result;
}

}  // namespace anholon
