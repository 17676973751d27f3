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
  constexpr double root_of_two = 1.4142135623730951, least_share = 0.5;
  constexpr std::size_t steps = 4;     // over which a bound falls to a quarter,
  constexpr double improvement = 1.5;  // and the error by this much, or the inputs' own rounding is reached
  measure(tape, candidates, at);
  const double bound = mode == OptimiseFor::accuracy ? tolerated_ulps / 4 : at.tolerated;
  const auto is_enough = [&](const RoundingError& e) { return e.excess <= bound; };
  if (std::ranges::any_of(candidates, is_enough, &Candidate::error)) return;
  std::vector<Candidate> plain(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(derived));
  std::ranges::stable_sort(plain, {}, &Candidate::operations);
  std::set<std::vector<NodeId>> seen;
  int shortest = std::numeric_limits<int>::max();  // of those that are within the bound
  for (const Candidate& from : plain) {
    const std::vector<NodeId> roots = roots_of(from.outputs);
    if (!seen.insert(roots).second) continue;
    const std::vector<double> shares = rounding_shares(tape, from.outputs, at.states).of_node;
    std::vector<double> errors = {from.error.excess};
    for (double tolerated = bound; tolerated > least_share / root_of_two; tolerated /= root_of_two) {
      const auto rest_kept = compensated(tape, roots, shares, tolerated);
      if (!rest_kept || seen.contains(*rest_kept)) continue;
      seen.insert(*rest_kept);
      std::vector<Candidate> next = {{fmt::format("{}{}compensated beyond {:.2g} ulps", from.name,
                                                  from.name.empty() ? "" : ", ", tolerated),
                                      with_roots(from.outputs, *rest_kept),
                                      operations_per_call(tape, *rest_kept, parameters).total(), from.route}};
      if (next[0].operations >= shortest) break;
      measure(tape, next, at);
      errors.push_back(next[0].error.excess);
      candidates.push_back(next[0]);
      if (is_enough(next[0].error)) {
        shortest = next[0].operations;
        break;
      }
      if (errors.size() > steps && !(errors.back() * improvement < errors[errors.size() - 1 - steps])) break;
    }
  }
}

}  // namespace anholon
