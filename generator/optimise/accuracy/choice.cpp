// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace anholon {
namespace {

constexpr std::array names = {std::pair{OptimiseFor::accuracy, std::string_view("accuracy")},
                              std::pair{OptimiseFor::balanced, std::string_view("balanced")},
                              std::pair{OptimiseFor::speed, std::string_view("speed")},
                              std::pair{OptimiseFor::nothing, std::string_view("nothing")}};

/// Errors that the choice of the states may have turned round: within half an ulp or a quarter of the error.
bool is_as_small(double error, double least) { return error <= std::max(least + 0.5, 1.25 * least); }

}  // namespace

std::string_view name(OptimiseFor mode) {
  return std::ranges::find(names, mode, [](auto& n) { return n.first; })->second;
}

OptimiseFor optimise_for(std::string_view name) {
  for (const auto& [mode, text] : names) {
    if (text == name) return mode;
  }
  throw std::invalid_argument(fmt::format("'{}' is not accuracy, balanced, speed or nothing", name));
}

std::vector<NodeId> roots_of(const std::vector<OutputBlock>& outputs) {
  std::vector<NodeId> roots;
  for (const OutputBlock& b : outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  return roots;
}

std::vector<OutputBlock> with_roots(std::vector<OutputBlock> outputs, const std::vector<NodeId>& roots) {
  std::size_t next = 0;
  for (OutputBlock& b : outputs) {
    for (NodeId& id : b.nodes) id = roots[next++];
  }
  return outputs;
}

void measure(const Tape& tape, std::vector<Candidate>& candidates, const MeasuredStates& states) {
  std::vector<std::vector<OutputBlock>> programs;
  programs.reserve(candidates.size());
  for (const Candidate& c : candidates) programs.push_back(c.outputs);
  const std::vector<RoundingError> errors = rounding_errors(tape, programs, states());
  for (std::size_t i = 0; i < candidates.size(); ++i) candidates[i].error = errors[i];
}

std::size_t choose(const Tape& tape, std::vector<Candidate>& candidates, OptimiseFor mode,
                   const MeasuredStates& states, const std::function<void()>& more, std::size_t first_look) {
  const auto shortest = [&](const auto& acceptable) {
    std::size_t best = candidates.size();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (acceptable(candidates[i].error.worst) &&
          (best == candidates.size() || candidates[i].operations < candidates[best].operations))
        best = i;
    }
    return best;
  };
  const std::size_t fast = shortest([](double) { return true; });
  if (mode == OptimiseFor::nothing) return 0;
  if (mode == OptimiseFor::speed) return fast;
  const std::vector<std::vector<double>> all = states();
  if (mode == OptimiseFor::balanced) {
    const std::size_t few = std::min(all.size(), first_look);
    std::vector<Candidate> one = {candidates[fast]};
    measure(tape, one,
            [&] { return std::vector(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(few)); });
    candidates[fast].error = one[0].error;
    if (!one[0].error.is_measured() || one[0].error.worst <= tolerated_ulps / 2) return fast;
  }
  more();
  measure(tape, candidates, [&] { return all; });
  const auto least =
      std::ranges::min_element(candidates, {}, [](const Candidate& c) { return c.error.worst; });
  if (!least->error.is_measured()) return fast;
  const double worst = least->error.worst;
  if (mode == OptimiseFor::accuracy) return shortest([&](double e) { return is_as_small(e, worst); });
  const double bound = std::max(tolerated_ulps, tolerated_growth * worst);
  if (candidates[fast].error.worst <= bound) return fast;  // nothing that is added needs to be considered
  return shortest([&](double e) { return e <= bound; });
}

}  // namespace anholon
