// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "optimise/accuracy/rounding_shares.hpp"

namespace anholon {
namespace {

constexpr std::array names = {std::pair{OptimiseFor::accuracy, std::string_view("accuracy")},
                              std::pair{OptimiseFor::balanced, std::string_view("balanced")},
                              std::pair{OptimiseFor::speed, std::string_view("speed")},
                              std::pair{OptimiseFor::nothing, std::string_view("nothing")}};

/// Errors that the choice of the states may have turned round: within half an ulp or a quarter of the error.
bool is_as_small(double error, double least) { return error <= std::max(least + 0.5, 1.25 * least); }

/// How much more the worst of all states shows than the worst of so few as are measured, typically: an
/// estimate of how much more again the worst of 1e5 will.
double growth(const std::vector<double>& errors) {
  std::vector<double> worst;  // of each group
  for (std::size_t i = 0; i < errors.size(); i += measured_states) {
    const auto end =
        errors.begin() + static_cast<std::ptrdiff_t>(std::min(errors.size(), i + measured_states));
    worst.push_back(*std::max_element(errors.begin() + static_cast<std::ptrdiff_t>(i), end));
  }
  std::ranges::sort(worst);
  return worst.back() / worst[worst.size() / 2];
}

/// The random states again, those of more where most is to be expected of a program, and what is allowed at
/// each.
/// @return nothing where not even there much is to be expected
std::optional<MeasuredStates> with_hard_states(const Tape& tape, const std::vector<OutputBlock>& program,
                                               const StateSource& states) {
  constexpr std::size_t most_steps = 100'000'000;  // half a second or so
  const std::size_t steps =
      std::max<std::size_t>(1, program.size() * tape.reachable(roots_of(program)).size());
  const std::size_t count = std::clamp<std::size_t>(most_steps / steps, measured_states, estimated_states);
  const std::vector<std::vector<double>> many = states(static_cast<int>(count));
  const std::vector<double> errors = expected_errors(tape, program, many);
  if (errors.empty() || *std::ranges::max_element(errors) <= tolerated_ulps / 2) return std::nullopt;
  std::vector<std::size_t> order(many.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto random = std::min<std::ptrdiff_t>(measured_states, std::ssize(order));
  std::stable_sort(order.begin() + random, order.end(),
                   [&](std::size_t a, std::size_t b) { return errors[a] > errors[b]; });
  order.resize(std::min<std::size_t>(order.size(), measured_states + hard_states));
  MeasuredStates at{{}, {}, std::clamp(allowed_ulps / growth(errors), least_tolerated, tolerated_ulps)};
  for (const std::size_t s : order) at.states.push_back(many[s]);
  at.allowance = rounding_shares(tape, program, at.states).allowance;
  return at;
}

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

void measure(const Tape& tape, std::vector<Candidate>& candidates, const MeasuredStates& at) {
  std::vector<std::vector<OutputBlock>> programs;
  std::vector<Candidate*> measured;
  for (Candidate& c : candidates) {
    if (c.error.is_measured()) continue;
    programs.push_back(c.outputs);
    measured.push_back(&c);
  }
  if (measured.empty()) return;
  const std::vector<RoundingError> errors = rounding_errors(tape, programs, at.states, at.allowance);
  for (std::size_t i = 0; i < measured.size(); ++i) measured[i]->error = errors[i];
}

std::size_t choose(const Tape& tape, std::vector<Candidate>& candidates, OptimiseFor mode,
                   const StateSource& states, const std::function<void(const MeasuredStates&)>& more,
                   Estimates estimates) {
  const auto shortest = [&](const auto& acceptable) {
    std::size_t best = candidates.size();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (acceptable(candidates[i].error) &&
          (best == candidates.size() || candidates[i].operations < candidates[best].operations))
        best = i;
    }
    return best;
  };
  const std::size_t fast = shortest([](const RoundingError&) { return true; });
  if (mode == OptimiseFor::nothing) return 0;
  if (mode == OptimiseFor::speed) return fast;
  MeasuredStates at{states(measured_states), {}, tolerated_ulps};
  bool is_fine = false;
  if (mode == OptimiseFor::balanced) {
    // the worst of all is seldom more than twice the worst of so many
    const auto few = static_cast<std::ptrdiff_t>(std::min<std::size_t>(at.states.size(), 8));
    std::vector<Candidate> one = {candidates[fast]};
    measure(tape, one, {{at.states.begin(), at.states.begin() + few}, {}, tolerated_ulps});
    if (!one[0].error.is_measured()) return fast;
    is_fine = one[0].error.worst <= tolerated_ulps / 2;
    if (is_fine && estimates == Estimates::none) return fast;
  }
  if (estimates == Estimates::hard_states) {
    if (auto with_hard = with_hard_states(tape, candidates[fast].outputs, states)) {
      at = std::move(*with_hard);
      std::vector<Candidate> one = {candidates[fast]};
      if (is_fine) measure(tape, one, at);
      is_fine = is_fine && one[0].error.excess <= at.tolerated;
    }
    if (is_fine) return fast;
  }
  more(at);
  measure(tape, candidates, at);
  std::vector<double> worst, excess;
  for (const Candidate& c : candidates) {
    if (!c.error.is_measured()) continue;
    worst.push_back(c.error.worst);
    excess.push_back(c.error.excess);
  }
  if (worst.empty()) return fast;
  if (mode == OptimiseFor::accuracy) {
    const double least = *std::ranges::min_element(worst);
    return shortest([&](const RoundingError& e) { return is_as_small(e.worst, least); });
  }
  const double least = *std::ranges::min_element(excess);
  const double bound = least <= at.tolerated ? at.tolerated : tolerated_growth * least;
  return shortest([&](const RoundingError& e) { return e.excess <= bound; });
}

}  // namespace anholon
