// SPDX-License-Identifier: GPL-2.0-or-later
#include "emit/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <unordered_map>

#include "emit/names.hpp"
#include "optimise/tape/dead_code.hpp"
#include "optimise/tree_loops.hpp"

namespace anholon {
namespace {

template <class Block>
void check_size(const Block& block) {
  if (block.rows < 0 || block.cols < 0 ||
      block.nodes.size() != static_cast<std::size_t>(block.rows) * static_cast<std::size_t>(block.cols)) {
    throw std::logic_error(fmt::format("block '{}' is said to be {}x{} and has {} entries", block.name,
                                       block.rows, block.cols, block.nodes.size()));
  }
}

template <class Items>
void check_distinct(const Items& items, const char* kind) {
  std::set<std::string> names;
  for (const auto& item : items) {
    if (!names.insert(item.name).second)
      throw std::logic_error(fmt::format("two {}s are named '{}'", kind, item.name));
  }
}

std::vector<NodeId> roots_of(const Function& function) {
  std::vector<NodeId> roots;
  for (const OutputBlock& output : function.outputs)
    roots.insert(roots.end(), output.nodes.begin(), output.nodes.end());
  return roots;
}

std::vector<std::string> split_name_space(const Program& program) {
  std::vector<std::string> parts;
  const std::string text = program.name_space.empty() ? program.model : program.name_space;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find("::", at), text.size());
    const std::string part = text.substr(at, end - at);
    parts.push_back(parts.empty() ? namespace_identifier(part) : identifier(part));
    at = end + 2;
  }
  return parts;
}

}  // namespace

EmissionPlan plan_emission(const Program& program) {
  for (const InputBlock& input : program.inputs) check_size(input);
  check_distinct(program.inputs, "input block");
  check_distinct(program.parameters, "parameter");
  check_distinct(program.functions, "function");

  EmissionPlan plan;
  plan.name_space = split_name_space(program);
  NameScope members;
  for (const ParameterInfo& parameter : program.parameters)
    plan.parameter_names.push_back(members.claim(parameter.name));
  NameScope arguments;
  for (const InputBlock& input : program.inputs) plan.input_names.push_back(arguments.claim(input.name));

  std::vector<NodeId> all_roots;
  for (const Function& function : program.functions) {
    for (const OutputBlock& output : function.outputs) check_size(output);
    const std::vector<NodeId> roots = roots_of(straight_line(program, function));
    all_roots.insert(all_roots.end(), roots.begin(), roots.end());
  }
  std::vector<NodeId> parameter_nodes;
  for (const ParameterInfo& parameter : program.parameters) parameter_nodes.push_back(parameter.node);
  Hoisted hoisted = hoist(program.tape, all_roots, parameter_nodes);
  for (const NodeId id : hoisted.parameters) {
    const auto found = std::find(parameter_nodes.begin(), parameter_nodes.end(), id);
    plan.prepared_parameters.push_back(static_cast<std::size_t>(found - parameter_nodes.begin()));
  }
  plan.prepared_values = std::move(hoisted.values);
  for (std::size_t i = 0, number = 0; i < plan.prepared_values.size(); ++i) {
    std::string name;
    do name = fmt::format("k{}", ++number);
    while (members.is_taken(name));
    plan.prepared_names.push_back(members.claim(name));
  }
  plan.prepare_operations = count_operations(program.tape, plan.prepared_values);

  NameScope functions;
  for (const Function& function : program.functions) {
    PlannedFunction planned;
    planned.function = &function;
    const std::vector<NodeId> roots = roots_of(straight_line(program, function));
    if (roots.empty()) continue;
    planned.name = planned.unqualified = functions.claim(function.name);
    if (const std::size_t at = function.name.find("::"); at != std::string::npos) {
      planned.scope = identifier(function.name.substr(0, at));
      planned.unqualified = identifier(function.name.substr(at + 2));
    }
    planned.operations = count_operations(program.tape, roots, plan.prepared_values);
    planned.unprepared = count_operations(program.tape, roots);
    if (function.loops) {
      const OperationCount loops = count_operations(*function.loops);
      planned.operations += loops;
      planned.unprepared += loops;
    }
    const std::vector<NodeId> needed = needed_nodes(program.tape, roots, plan.prepared_values);
    const std::set<NodeId> is_needed(needed.begin(), needed.end());
    for (std::size_t i = 0; i < program.inputs.size(); ++i) {
      const auto& nodes = program.inputs[i].nodes;
      const bool used = std::any_of(nodes.begin(), nodes.end(), [&](NodeId id) {
        return program.tape.node(id).op == Op::input && is_needed.contains(id);
      });
      if (used) planned.inputs.push_back(i);
    }
    NameScope locals(arguments);
    for (const OutputBlock& output : function.outputs) {
      if (output.nodes.empty()) continue;
      const bool clash = std::find(plan.input_names.begin(), plan.input_names.end(),
                                   identifier(output.name)) != plan.input_names.end();
      planned.outputs.push_back({&output, locals.claim(clash ? output.name + "_out" : output.name)});
    }
    plan.functions.push_back(std::move(planned));
  }
  return plan;
}

}  // namespace anholon
