// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/bound_call.hpp"

namespace anholon {

Call bound(const std::shared_ptr<CompiledProgram>& code, const std::string& name, Buffers<double>& buffers) {
  if (!code->has(name)) return {};
  const anholon_function& function = code->function(name);
  const auto pointer = [&](const anholon_block& b) {
    std::vector<double>& values = buffers[b.name];
    values.resize(static_cast<std::size_t>(b.rows) * static_cast<std::size_t>(b.cols), 0.0);
    return values.data();
  };
  std::vector<const double*> inputs;
  std::vector<double*> outputs;
  for (int i = 0; i < function.input_count; ++i) inputs.push_back(pointer(function.inputs[i]));
  for (int i = 0; i < function.output_count; ++i) outputs.push_back(pointer(function.outputs[i]));
  return [code, &function, inputs, outputs] { code->call(function, inputs.data(), outputs.data()); };
}

}  // namespace anholon
