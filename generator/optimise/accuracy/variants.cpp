// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "optimise/accuracy/compensation.hpp"
#include "optimise/accuracy/rounding_shares.hpp"
#include "optimise/tape/hoist.hpp"
#include "optimise/tape/passes.hpp"
#include "optimise/tape/stable_forms.hpp"

namespace anholon {

std::vector<Candidate> after_passes(Tape& tape, const Candidate& candidate,
                                    const std::vector<NodeId>& parameters) {
  std::vector<Candidate> result;
  for (const AfterPass& step : run_passes(tape, roots_of(candidate.outputs), parameters)) {
    Candidate next{candidate.name, with_roots(candidate.outputs, step.roots), step.operations,
                   candidate.route};
    next.name += (next.name.empty() ? "after " : ", after ") + step.pass;
    result.push_back(std::move(next));
  }
  return result;
}

std::optional<Candidate> in_stable_form(Tape& tape, const Candidate& candidate,
                                        const std::vector<NodeId>& parameters) {
  const std::vector<NodeId> roots = roots_of(candidate.outputs);
  const std::vector<NodeId> stable = stable_forms(tape, roots);
  if (stable == roots) return std::nullopt;
  Candidate next{candidate.name, with_roots(candidate.outputs, stable),
                 operations_per_call(tape, stable, parameters).total(), candidate.route};
  next.name += next.name.empty() ? "stable forms" : ", stable forms";
  return next;
}

void add_compensated(Tape& tape, std::vector<Candidate>& candidates, const std::vector<NodeId>& parameters,
                     OptimiseFor mode, const MeasuredStates& at, std::size_t derived) {
  constexpr double root_of_two = 1.4142135623730951, least_share = 0.35, most_spread = 60;
  constexpr std::size_t steps = 4;     // over which a bound falls to a quarter,
  constexpr double improvement = 1.5;  // and the error by this much, or the inputs' own rounding is reached
  const auto is_enough = [&](const Candidate& c) {
    return mode == OptimiseFor::accuracy ? c.error.excess <= tolerated_ulps / 4
                                         : c.worst_to_expect() <= allowed_ulps;
  };
  if (first_acceptable(tape, candidates, at, is_enough) < candidates.size()) return;
  std::vector<double> bounds = {std::numeric_limits<double>::infinity()};
  for (double bound = tolerated_ulps; bound > least_share; bound /= root_of_two) bounds.push_back(bound);
  std::vector<Candidate> plain;
  for (std::size_t i = 0; i < derived; ++i) {
    const Candidate& c = candidates[i];
    if (c.route == i || c.error.excess * improvement < candidates[c.route].error.excess) plain.push_back(c);
  }
  std::ranges::stable_sort(plain, {}, &Candidate::operations);
  std::set<std::vector<NodeId>> seen;
  int shortest = std::numeric_limits<int>::max();  // of those that are enough
  for (const Candidate& from : plain) {
    const std::vector<NodeId> roots = roots_of(from.outputs);
    if (!seen.insert(roots).second) continue;
    const std::vector<double> shares = rounding_shares(tape, from.outputs, at.states).of_node;
    const auto errors_at = [&](const States& states) {
      return first_order_errors(tape, from.outputs, states, shares, bounds);
    };
    const std::vector<Outlook> outlooks =
        at.estimated.empty() ? outlooks_of(errors_at(at.states)) : at.estimated.outlooks(errors_at);
    // what one state in thousands shows may grow as much again where it was not seen yet
    const double largest_share = allowed_ulps / std::min(outlooks[0].spread, most_spread);
    std::vector<double> worst = {from.worst_to_expect()};
    for (std::size_t i = 1; i < bounds.size(); ++i) {
      const bool is_promising = bounds[i] <= largest_share * root_of_two &&
                                (mode == OptimiseFor::accuracy || outlooks[i].worst() <= allowed_ulps);
      if (!is_promising && i + 1 < bounds.size()) continue;
      const auto rest_kept = compensated(tape, roots, shares, bounds[i]);
      if (!rest_kept || !seen.insert(*rest_kept).second) continue;
      std::vector<Candidate> next = {{fmt::format("{}{}compensated beyond {:.2g} ulps", from.name,
                                                  from.name.empty() ? "" : ", ", bounds[i]),
                                      with_roots(from.outputs, *rest_kept),
                                      operations_per_call(tape, *rest_kept, parameters).total(), from.route}};
      if (next[0].operations >= shortest) break;
      next[0].outlook = outlooks[i];
      measure(tape, next, at);
      worst.push_back(next[0].worst_to_expect());
      candidates.push_back(next[0]);
      if (is_enough(next[0])) {
        shortest = next[0].operations;
        break;
      }
      if (worst.size() > steps && !(worst.back() * improvement < worst[worst.size() - 1 - steps])) break;
    }
  }
}

}  // namespace anholon
