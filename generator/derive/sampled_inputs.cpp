// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/sampled_inputs.hpp"

#include <string_view>

#include "reduce/partition.hpp"

namespace anholon {
namespace {

/// FNV-1a, Fowler, Noll and Vo.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ULL;
  return hash;
}

}  // namespace

/// Blocks of inputs that say where the robot is, those of the reduction and those of a tree.
SampledInputs::PositionBlocks SampledInputs::next_position() {
  const State<Exact> s = random_state(model_, source_);
  const Partition partition = partition_of(model_);
  PositionBlocks blocks;
  blocks["t"] = {source_.uniform()};
  const double theta = 6 * source_.uniform() - 3;
  blocks["g"] = {s.p.x.to_double(), s.p.y.to_double(), theta};
  for (const Exact& x : s.R.m) blocks["R"].push_back(x.to_double());
  for (const Exact& x : s.r) blocks["r"].push_back(x.to_double());
  const auto joints = [&](const std::string& name, const std::vector<int>& indices) {
    for (const int i : indices) {
      if (i >= partition.n) blocks[name].push_back(blocks["r"][static_cast<std::size_t>(i - partition.n)]);
    }
  };
  joints("r_p", partition.passive);
  joints("r_a", partition.active);
  return blocks;
}

std::vector<std::vector<double>> SampledInputs::operator()(const Program& program, int states) {
  std::vector<std::vector<double>> result;
  std::vector<double> at_defaults(program.tape.inputs().size(), 0.0);
  for (const ParameterInfo& p : program.parameters)
    at_defaults[program.tape.node(p.node).a] = p.value.to_double();
  for (int s = 0; s < states; ++s) {
    if (positions_.size() <= static_cast<std::size_t>(s)) positions_.push_back(next_position());
    const PositionBlocks& known = positions_[static_cast<std::size_t>(s)];
    std::vector<double> inputs = at_defaults;
    for (const InputBlock& block : program.inputs) {
      SampleSource source(hash_of(block.name) + static_cast<std::uint64_t>(s));
      const auto found = known.find(block.name);
      for (std::size_t i = 0; i < block.nodes.size(); ++i) {
        const double random = 2 * source.uniform() - 1;
        const bool is_known = found != known.end() && i < found->second.size();
        inputs[program.tape.node(block.nodes[i]).a] = is_known ? found->second[i] : random;
      }
    }
    result.push_back(std::move(inputs));
  }
  return result;
}

}  // namespace anholon
