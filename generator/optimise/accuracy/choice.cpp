// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "optimise/accuracy/rounded.hpp"
#include "optimise/accuracy/rounding_shares.hpp"

namespace anholon {
namespace {

constexpr std::array names = {std::pair{OptimiseFor::accuracy, std::string_view("accuracy")},
                              std::pair{OptimiseFor::balanced, std::string_view("balanced")},
                              std::pair{OptimiseFor::speed, std::string_view("speed")},
                              std::pair{OptimiseFor::nothing, std::string_view("nothing")}};

/// Errors that the choice of the states may have turned round: within half an ulp or a quarter of the error.
bool is_as_small(double error, double least) { return error <= std::max(least + 0.5, 1.25 * least); }

/// So many states that estimates take half a second or so.
int count_for(std::size_t steps, int most) {
  constexpr std::size_t most_steps = 100'000'000;
  return static_cast<int>(
      std::clamp<std::size_t>(most_steps / steps, measured_states, static_cast<std::size_t>(most)));
}

/// The random states again, and those of more where most is to be expected of a program.
States with_hard_states(const States& many, const std::vector<double>& errors) {
  std::vector<std::size_t> order(many.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto random = std::min<std::ptrdiff_t>(measured_states, std::ssize(order));
  std::stable_sort(order.begin() + random, order.end(),
                   [&](std::size_t a, std::size_t b) { return errors[a] > errors[b]; });
  order.resize(std::min<std::size_t>(order.size(), measured_states + hard_states));
  States result;
  for (const std::size_t s : order) result.push_back(many[s]);
  return result;
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

double Candidate::worst_to_expect() const {
  const Outlook o = outlook.value_or(Outlook{});
  return o.growth * std::max(error.excess, o.largest);
}

EstimatedStates::EstimatedStates(StateSource source, std::size_t steps)
    : source_(std::move(source)),
      steps_(std::max<std::size_t>(1, steps)),
      few_(source_(count_for(steps_, estimated_states))) {}

std::vector<Outlook> EstimatedStates::outlooks(
    const std::function<std::vector<std::vector<double>>(const States&)>& errors) const {
  constexpr double open = 2;  // a growth that was guessed from few may be off by so much
  std::vector<Outlook> result = outlooks_of(errors(few_));
  const int count = count_for(steps_, many_estimated_states);
  const bool is_open = std::ranges::any_of(result, [](const Outlook& o) {
    return o.largest <= allowed_ulps && o.worst() <= open * allowed_ulps && o.worst() * open >= allowed_ulps;
  });
  if (!is_open || count <= static_cast<int>(few_.size())) return result;
  if (many_.empty()) many_ = source_(count);
  return outlooks_of(errors(many_));
}

std::vector<Outlook> outlooks_of(std::vector<std::vector<double>> errors) {
  constexpr double most = allowed_ulps / 2;  // beyond it no program would be good enough
  constexpr std::size_t least_tail = 8;      // fewer say nothing
  std::vector<Outlook> result;
  for (std::vector<double>& of_program : errors) {
    std::ranges::sort(of_program, std::greater<>());
    Outlook& outlook = result.emplace_back();
    if (!of_program.empty()) outlook.largest = of_program[0];
    const std::size_t tail = of_program.size() / 32;
    if (tail < least_tail || !(of_program[tail] > 0)) continue;
    outlook.spread = of_program[0] / of_program[tail];
    // the tail falls like a power of the number of states (Hill 1975)
    outlook.growth = most;
    if (!std::isfinite(outlook.spread)) continue;
    const WorkingDigits precision(rounded_digits);
    double exponent = 0;
    for (std::size_t i = 0; i < tail; ++i)
      exponent += log(Rounded(of_program[i] / of_program[tail])).x / static_cast<double>(tail);
    const Rounded states(expected_states / static_cast<double>(of_program.size()));
    const Rounded log_growth(exponent * log(states).x);
    if (log_growth.x < log(Rounded(most)).x) outlook.growth = exp(log_growth).x;
  }
  return result;
}

void measure(const Tape& tape, std::span<Candidate> candidates, const MeasuredStates& at) {
  std::vector<std::vector<OutputBlock>> programs;
  std::vector<Candidate*> measured;
  for (Candidate& c : candidates) {
    if (c.error.is_measured()) continue;
    programs.push_back(c.outputs);
    measured.push_back(&c);
  }
  if (measured.empty()) return;
  const std::vector<RoundingError> errors = rounding_errors(tape, programs, at.states, at.allowance);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    measured[i]->error = errors[i];
    if (!measured[i]->outlook && !at.estimated.empty() && measured[i]->error.excess <= allowed_ulps)
      measured[i]->outlook = at.estimated
                                 .outlooks([&](const States& random) {
                                   return first_order_errors(tape, measured[i]->outputs, random);
                                 })
                                 .front();
  }
}

std::vector<std::size_t> by_operations(const std::vector<Candidate>& candidates) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return candidates[i].operations; });
  return order;
}

std::size_t choose(const Tape& tape, std::vector<Candidate>& candidates, OptimiseFor mode,
                   const StateSource& states, const std::function<void(const MeasuredStates&)>& more) {
  const std::size_t fast = by_operations(candidates).front();
  const auto is_within = [](const Candidate& c) {
    return c.error.is_measured() && c.worst_to_expect() <= allowed_ulps;
  };
  if (mode == OptimiseFor::nothing) return 0;
  if (mode == OptimiseFor::speed) return fast;
  bool is_fine = false;
  if (mode == OptimiseFor::balanced) {
    constexpr int few = 8;  // the worst of all is seldom more than twice the worst of so many
    std::vector<Candidate> one = {candidates[fast]};
    measure(tape, one, {states(few), {}, {}});
    if (!one[0].error.is_measured()) return fast;
    is_fine = one[0].error.worst <= tolerated_ulps / 2;
  }
  const std::vector<OutputBlock>& program = candidates[fast].outputs;
  EstimatedStates random(states, program.size() * tape.reachable(roots_of(program)).size());
  const std::vector<double> errors = first_order_errors(tape, program, random.few()).front();
  if (is_fine && (errors.empty() || *std::ranges::max_element(errors) <= tolerated_ulps / 2)) return fast;
  MeasuredStates at{with_hard_states(random.few(), errors), {}, std::move(random)};
  at.allowance = rounding_shares(tape, program, at.states).allowance;
  if (mode == OptimiseFor::balanced) {
    measure(tape, {&candidates[fast], 1}, at);
    if (is_within(candidates[fast])) return fast;
  }
  more(at);
  const std::vector<std::size_t> order = by_operations(candidates);
  if (mode == OptimiseFor::balanced) {
    for (const std::size_t i : order) {
      measure(tape, {&candidates[i], 1}, at);
      if (is_within(candidates[i])) return i;
    }
  }
  measure(tape, candidates, at);
  if (std::ranges::none_of(candidates, [](const Candidate& c) { return c.error.is_measured(); })) return fast;
  const auto least = [&](const auto& of) {
    double result = std::numeric_limits<double>::infinity();
    for (const Candidate& c : candidates) {
      if (c.error.is_measured()) result = std::min(result, of(c));
    }
    return result;
  };
  const auto shortest = [&](const auto& acceptable) {
    return *std::ranges::find_if(order, [&](std::size_t i) { return acceptable(candidates[i]); });
  };
  if (mode == OptimiseFor::accuracy) {
    const double worst = least([](const Candidate& c) { return c.error.worst; });
    return shortest([&](const Candidate& c) { return is_as_small(c.error.worst, worst); });
  }
  const double reached = least([](const Candidate& c) { return c.worst_to_expect(); });
  return shortest([&](const Candidate& c) { return c.worst_to_expect() <= tolerated_growth * reached; });
}

}  // namespace anholon
