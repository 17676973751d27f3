// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

#include "check/compile_cache.hpp"
#include "check/evaluate_program.hpp"

namespace anholon {

/// Compiles a program (or finds it in the cache), sets its parameters, and calls its functions by name.
inline ProgramCaller<double> compiled_caller(const Program& program, const std::vector<Exact>& parameters) {
  auto code = std::make_shared<CompiledProgram>(program);
  std::vector<double> values;
  for (const Exact& p : parameters) values.push_back(p.to_double());
  code->set_parameters(values);
  return [code](const std::string& function, const NamedValues<double>& inputs) {
    const CompiledProgram::Blocks blocks(inputs.begin(), inputs.end());
    const CompiledProgram::Blocks outputs = code->call(function, blocks);
    return NamedValues<double>(outputs.begin(), outputs.end());
  };
}

}  // namespace anholon
