// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A function of a program, bound to buffers: calling it allocates nothing. Run by compiled code in double, or
// by the tape itself over any scalar.

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "check/compile_cache.hpp"
#include "simulate/buffers.hpp"
#include "tape/interface.hpp"
#include "tape/interpret.hpp"

namespace anholon {

/// Empty where the program has no such function.
using Call = std::function<void()>;

Call bound(const std::shared_ptr<CompiledProgram>& code, const std::string& name, Buffers<double>& buffers);

/// By interpretation of the tape, parameters at their defaults.
template <class S>
Call bound(const Program* program, const std::string& name, Buffers<S>& buffers) {
  const auto function = std::ranges::find(program->functions, name, &Function::name);
  if (function == program->functions.end()) return {};
  struct Work {
    Interpreter<S> interpreter;
    std::vector<S> values, flat;
    std::vector<std::pair<std::vector<S>*, const InputBlock*>> inputs;
    std::vector<std::pair<std::vector<S>*, std::size_t>> outputs;
  };
  auto work = std::make_shared<Work>();
  std::vector<NodeId> roots;
  for (const OutputBlock& b : function->outputs) {
    buffers[b.name].resize(b.nodes.size(), 0);
    work->outputs.emplace_back(&buffers[b.name], b.nodes.size());
    roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  }
  for (const InputBlock& b : program->inputs) {
    buffers[b.name].resize(b.nodes.size(), 0);
    work->inputs.emplace_back(&buffers[b.name], &b);
  }
  work->interpreter = Interpreter<S>(program->tape, roots);
  work->values.assign(program->tape.inputs().size(), 0);
  for (const ParameterInfo& p : program->parameters)
    work->values[program->tape.node(p.node).a] = FromExact<S>{}(p.value);
  work->flat.resize(roots.size());
  return [work, program] {
    for (const auto& [from, block] : work->inputs) {
      for (std::size_t i = 0; i < block->nodes.size(); ++i)
        work->values[program->tape.node(block->nodes[i]).a] = (*from)[i];
    }
    work->interpreter(work->values, work->flat);
    std::size_t next = 0;
    for (const auto& [to, size] : work->outputs) {
      for (std::size_t i = 0; i < size; ++i) (*to)[i] = work->flat[next++];
    }
  };
}

}  // namespace anholon
