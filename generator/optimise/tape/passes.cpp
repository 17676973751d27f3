// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/passes.hpp"

#include <array>
#include <utility>

#include "optimise/tape/common_factors.hpp"
#include "optimise/tape/common_sums.hpp"
#include "optimise/tape/gather_parameters.hpp"
#include "optimise/tape/hoist.hpp"
#include "optimise/tape/opposite_differences.hpp"

namespace anholon {
namespace {

using Roots = std::vector<NodeId>;

constexpr std::size_t largest_tape = 400000;
constexpr int rounds = 3;

struct TapePass {
  const char* name;
  Roots (*run)(Tape&, const Roots&, const Roots& parameters);
};
constexpr std::array tape_passes = {
    TapePass{"opposite differences",
             [](Tape& t, const Roots& r, const Roots&) { return merge_opposite_differences(t, r); }},
    TapePass{"common factors",
             [](Tape& t, const Roots& r, const Roots&) { return extract_common_factors(t, r); }},
    TapePass{"common sums", [](Tape& t, const Roots& r, const Roots&) { return share_common_sums(t, r); }},
    TapePass{"gathered parameters",
             [](Tape& t, const Roots& r, const Roots& p) { return gather_parameters(t, r, p); }}};

}  // namespace

std::vector<AfterPass> run_passes(Tape& tape, Roots roots, const Roots& parameters) {
  std::vector<AfterPass> steps;
  if (tape.size() > largest_tape) return steps;
  const auto cost_of = [&](const Roots& r) { return operations_per_call(tape, r, parameters).total(); };
  int cost = cost_of(roots);
  for (int round = 0; round < rounds; ++round) {
    const int before = cost;
    for (const TapePass& pass : tape_passes) {
      Roots next = pass.run(tape, roots, parameters);
      const int after = cost_of(next);
      if (next == roots || after > cost) continue;  // a pass counts what prepare() computes, too
      cost = after;
      roots = std::move(next);
      steps.push_back({pass.name, roots, cost});
    }
    if (cost == before) break;
  }
  return steps;
}

}  // namespace anholon
