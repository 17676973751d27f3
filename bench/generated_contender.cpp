// SPDX-License-Identifier: GPL-2.0-or-later
#include <map>
#include <memory>
#include <stdexcept>

#include "check/compile_cache.hpp"
#include "contenders.hpp"

namespace anholon::bench {
namespace {

struct Code {
  CompiledProgram program;
  const anholon_function* function = nullptr;
  std::vector<std::vector<double>> storage;        // of all inputs of a sample
  std::vector<std::vector<const double*>> inputs;  // of a sample, one for each block
  std::vector<double> output_storage;
  std::vector<double*> outputs;

  Code(const Program& p, const CompileOptions& options) : program(p, options) {}
  void call(std::size_t i) { program.call(*function, inputs[i].data(), outputs.data()); }
};

std::vector<double> block_of(const Sample& s, const std::string& name) {
  const auto twist = [](const Spatial<double>& x) {
    return std::vector<double>{x[0], x[1], x[2], x[3], x[4], x[5]};
  };
  if (name == "R") return {s.state.R.m.begin(), s.state.R.m.end()};
  if (name == "eta") return twist(s.state.eta);
  if (name == "eta_dot") return twist(s.eta_dot);
  if (name == "r") return s.state.r;
  if (name == "r_dot") return s.state.r_dot;
  if (name == "r_ddot") return s.r_ddot;
  if (name == "tau") return s.tau;
  throw std::logic_error("no sample has '" + name + "'");
}

CompileOptions compile_options(const StatementStyle& style) {
  CompileOptions options;
  options.flags = generated_flags();
  options.style = style;
  return options;
}

}  // namespace

const std::vector<std::string>& generated_flags() {
  // No flag changes what a correct program may see: errno and traps are not read. Compensated operations need
  // each operation rounded by itself: no contraction to fused multiply-add, the compiler's default for a
  // processor that has it. Renamed registers let the last scheduling move operations further: 7 % of the time
  // of 3000 operations.
  static const std::vector<std::string> flags = {"-O3",
                                                 "-march=native",
                                                 "-std=c++17",
                                                 "-fno-math-errno",
                                                 "-fno-trapping-math",
                                                 "-ffp-contract=off",
                                                 "-frename-registers",
                                                 "-fPIC",
                                                 "-shared",
                                                 "-fvisibility=hidden"};
  return flags;
}

std::vector<Contender> generated_contenders(const Robot& robot, const Program& program,
                                            const std::string& function, const std::string& name,
                                            const StatementStyle& style) {
  auto code = std::make_shared<Code>(program, compile_options(style));
  code->function = &code->program.function(function);
  const std::size_t count = robot.samples.size();
  code->storage.resize(count);
  code->inputs.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::size_t> begin;
    for (int b = 0; b < code->function->input_count; ++b) {
      begin.push_back(code->storage[i].size());
      const std::vector<double> block = block_of(robot.samples[i], code->function->inputs[b].name);
      code->storage[i].insert(code->storage[i].end(), block.begin(), block.end());
    }
    for (const std::size_t at : begin) code->inputs[i].push_back(code->storage[i].data() + at);
  }
  std::size_t size = 0;
  for (int b = 0; b < code->function->output_count; ++b)
    size += static_cast<std::size_t>(code->function->outputs[b].rows * code->function->outputs[b].cols);
  code->output_storage.resize(size);
  double* next = code->output_storage.data();
  for (int b = 0; b < code->function->output_count; ++b) {
    code->outputs.push_back(next);
    next += code->function->outputs[b].rows * code->function->outputs[b].cols;
  }
  return {contender(
      name, count, [code](std::size_t i) { code->call(i); },
      [code](std::size_t) { return code->output_storage; })};
}

std::vector<Contender> preparation_contenders(const Robot& robot, const Program& program,
                                              const std::string& name, const StatementStyle& style) {
  const auto code = std::make_shared<CompiledProgram>(program, compile_options(style));
  const std::vector<double> values = code->parameter_defaults();
  Contender all = contender(
      name, robot.samples.size(), [code, values](std::size_t) { code->set_parameters(values); },
      [](std::size_t) { return std::vector<double>(); });
  all.values = nullptr;
  return {all};
}

}  // namespace anholon::bench
