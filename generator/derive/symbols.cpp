// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/symbols.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "optimise/accuracy/rounded.hpp"

namespace anholon {

ProgramSymbols::ProgramSymbols(const Model& model, const Partition& partition, Program& program)
    : model_(model), program_(program) {
  Tape& tape = program.tape;
  for (const Parameter& p : model.parameters) {
    const NodeId node = tape.input(p.name);
    program.parameters.push_back({p.name, p.unit, p.meaning, p.value, node});
    parameters_.emplace_back(tape, node);
  }
  position_.t = block("t", 1, "s", "time").front();
  switch (model.group) {
    case GroupKind::SE3:
    case GroupKind::SO3: {
      const auto R = block("R", 9, "1", "orientation of the reference body in the world, row-major");
      std::ranges::copy(R, position_.R.m.begin());
      if (model.group == GroupKind::SO3) break;
      [[fallthrough]];
    }
    case GroupKind::R1:
    case GroupKind::R2:
    case GroupKind::R3: {
      const int size =
          static_cast<int>(std::ranges::count_if(free_components(model.group), [](int c) { return c < 3; }));
      const auto p = block("p", size, "m", "position of the reference body in the world");
      for (int i = 0; i < size; ++i) position_.p[i] = p[static_cast<std::size_t>(i)];
      break;
    }
    case GroupKind::SE2: {
      planar_ = block("g", 3, "m, m, rad", "x, y, theta of the reference body in the world");
      position_.p = {planar_[0], planar_[1], 0};
      position_.R = AxisRotation<Expr>{2, cos(planar_[2]), sin(planar_[2])}.matrix();
      break;
    }
    case GroupKind::fixed:
      break;
  }
  const auto names = [&](const std::vector<int>& indices) {
    std::vector<std::string> list;
    for (const int i : indices) {
      if (i >= partition.n) list.push_back(model.coordinates[static_cast<std::size_t>(i - partition.n)].name);
    }
    return fmt::format("{}", fmt::join(list, ", "));
  };
  position_.r.assign(model.coordinates.size(), Expr(0));
  const auto r_p = block("r_p", partition.s_p(), "rad or m", names(partition.passive));
  const auto r_a = block("r_a", partition.s_a(), "rad or m", names(partition.active));
  for (int i = 0; i < partition.s_p(); ++i)
    position_.r[static_cast<std::size_t>(partition.passive[static_cast<std::size_t>(partition.n + i)] -
                                         partition.n)] = r_p[static_cast<std::size_t>(i)];
  for (int i = 0; i < partition.s_a(); ++i)
    position_.r[static_cast<std::size_t>(partition.active[static_cast<std::size_t>(i)] - partition.n)] =
        r_a[static_cast<std::size_t>(i)];
  position_.r_dot.assign(model.coordinates.size(), Expr(0));
}

std::vector<Expr> ProgramSymbols::block(const std::string& name, int size, const std::string& unit,
                                        const std::string& meaning) {
  auto found = std::ranges::find(program_.inputs, name, &InputBlock::name);
  if (found == program_.inputs.end()) {
    InputBlock block{name, unit, meaning, size, 1, {}};
    for (int i = 0; i < size; ++i) block.nodes.push_back(program_.tape.input(fmt::format("{}[{}]", name, i)));
    program_.inputs.push_back(std::move(block));
    found = program_.inputs.end() - 1;
  }
  std::vector<Expr> entries;
  for (const NodeId id : found->nodes) entries.emplace_back(program_.tape, id);
  return entries;
}

State<Expr> ProgramSymbols::moving(const std::vector<Expr>& v) const {
  State<Expr> state = position_;
  const auto components = free_components(model_.group);
  for (std::size_t i = 0; i < components.size(); ++i) state.eta[components[i]] = v[i];
  state.r_dot.assign(v.begin() + static_cast<std::ptrdiff_t>(components.size()), v.end());
  return state;
}

std::vector<std::pair<NodeId, NodeId>> ProgramSymbols::motion(const std::vector<Expr>& v) const {
  Tape& tape = program_.tape;
  const State<Expr> state = moving(v);
  std::vector<std::pair<NodeId, NodeId>> rates;
  const auto add = [&](const Expr& input, const Expr& rate) {
    rates.emplace_back(input.id(tape), rate.id(tape));
  };
  add(position_.t, 1);
  const Vec3<Expr> p_dot = state.R * state.eta.linear;
  if (model_.group == GroupKind::SE2) {
    add(planar_[0], p_dot.x), add(planar_[1], p_dot.y), add(planar_[2], state.eta.angular.z);
  } else {
    if (model_.group == GroupKind::SE3 || model_.group == GroupKind::SO3) {
      const Mat3<Expr> R_dot = state.R * skew(state.eta.angular);
      for (std::size_t i = 0; i < 9; ++i) add(state.R.m[i], R_dot.m[i]);
    }
    for (const int c : free_components(model_.group)) {
      if (c < 3) add(state.p[c], p_dot[c]);
    }
  }
  for (std::size_t i = 0; i < state.r.size(); ++i) add(state.r[i], state.r_dot[i]);
  return rates;
}

Sampler ProgramSymbols::sampler(const std::vector<State<double>>& states) const {
  auto inputs = std::make_shared<std::vector<std::vector<double>>>();
  const std::vector<double> parameters = default_parameters();
  for (const State<double>& state : states) {
    std::vector<double> values(program_.tape.inputs().size(), 0.0);
    fill_position(state, parameters, values);
    inputs->push_back(std::move(values));
  }
  return [inputs, &tape = program_.tape](const std::vector<NodeId>& nodes) {
    std::vector<std::vector<double>> result;
    ReproducibleInterpreter run(tape, nodes);
    for (std::vector<double>& values : *inputs) {
      values.resize(tape.inputs().size(), 0.0);
      result.push_back(run(values));
    }
    return result;
  };
}

ConfigurationSearch::Values ProgramSymbols::evaluator(const std::vector<NodeId>& nodes) const {
  const auto run = std::make_shared<ReproducibleInterpreter>(program_.tape, nodes);
  return [this, run, parameters = default_parameters()](const State<double>& state) {
    std::vector<double> inputs(program_.tape.inputs().size(), 0.0);
    fill_position(state, parameters, inputs);
    return (*run)(inputs);
  };
}

std::vector<double> ProgramSymbols::default_parameters() const {
  std::vector<double> parameters;
  for (const Parameter& p : model_.parameters) parameters.push_back(p.value.to_double());
  return parameters;
}

}  // namespace anholon
