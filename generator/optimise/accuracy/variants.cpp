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
namespace {

constexpr double root_of_two = 1.4142135623730951;
constexpr double improvement = 1.5;  // of the error: less is not worth its operations

bool is_enough(const Candidate& c, OptimiseFor mode) {
  return mode == OptimiseFor::accuracy ? c.error.excess <= tolerated_ulps / 4
                                       : c.worst_to_expect() <= allowed_ulps;
}

/// Compensates one formulation after another beyond falling bounds on the share of an operation.
class CompensationSearch {
 public:
  CompensationSearch(Tape& tape, const std::vector<NodeId>& parameters, OptimiseFor mode,
                     const MeasuredStates& at)
      : tape_(tape), parameters_(parameters), mode_(mode), at_(at) {
    constexpr double least_share = 0.35;
    bounds_ = {std::numeric_limits<double>::infinity()};  // nothing is compensated
    for (double bound = tolerated_ulps; bound > least_share; bound /= root_of_two) bounds_.push_back(bound);
  }

  /// Adds the candidates that it measures, up to the first that is enough or until nothing is gained.
  void add(const Candidate& from, std::vector<Candidate>& candidates) {
    constexpr std::size_t steps = 4;  // over which a bound falls to a quarter
    const std::vector<NodeId> roots = roots_of(from.outputs);
    if (!seen_.insert(roots).second) return;
    const std::vector<double> shares = rounding_shares(tape_, from.outputs, at_.states).of_node;
    const std::vector<Outlook> outlooks = outlooks_beyond_bounds(from, shares);
    std::vector<double> worst = {from.worst_to_expect()};
    for (std::size_t i = 1; i < bounds_.size(); ++i) {
      if (!is_promising(i, outlooks) && i + 1 < bounds_.size()) continue;
      const auto outputs = compensated(tape_, roots, shares, bounds_[i]);
      if (!outputs || !seen_.insert(*outputs).second) continue;
      Candidate next{fmt::format("{}{}compensated beyond {:.2g} ulps", from.name,
                                 from.name.empty() ? "" : ", ", bounds_[i]),
                     with_roots(from.outputs, *outputs),
                     operations_per_call(tape_, *outputs, parameters_).total(), from.route};
      if (next.operations >= shortest_) return;
      next.outlook = outlooks[i];
      measure(tape_, {&next, 1}, at_);
      worst.push_back(next.worst_to_expect());
      candidates.push_back(next);
      if (is_enough(next, mode_)) {
        shortest_ = next.operations;
        return;
      }
      // the inputs' own rounding is reached
      if (worst.size() > steps && !(worst.back() * improvement < worst[worst.size() - 1 - steps])) return;
    }
  }

 private:
  [[nodiscard]] std::vector<Outlook> outlooks_beyond_bounds(const Candidate& from,
                                                            const std::vector<double>& shares) const {
    const auto errors_at = [&](const States& states) {
      return first_order_errors(tape_, from.outputs, states, shares, bounds_);
    };
    return at_.estimated.empty() ? outlooks_of(errors_at(at_.states)) : at_.estimated.outlooks(errors_at);
  }

  [[nodiscard]] bool is_promising(std::size_t bound, const std::vector<Outlook>& outlooks) const {
    constexpr double most_spread = 60;
    // what one state in thousands shows may grow as much again where it was not seen yet
    const double largest_share = allowed_ulps / std::min(outlooks[0].spread, most_spread);
    return bounds_[bound] <= largest_share * root_of_two &&
           (mode_ == OptimiseFor::accuracy || outlooks[bound].worst() <= allowed_ulps);
  }

  Tape& tape_;
  const std::vector<NodeId>& parameters_;
  OptimiseFor mode_;
  const MeasuredStates& at_;
  std::vector<double> bounds_;
  std::set<std::vector<NodeId>> seen_;
  int shortest_ = std::numeric_limits<int>::max();  // of those that are enough
};

}  // namespace

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
                     OptimiseFor mode, const MeasuredStates& at, std::vector<std::size_t> formulations) {
  std::ranges::stable_sort(formulations, {}, [&](std::size_t i) { return candidates[i].operations; });
  for (const std::size_t i : formulations) {
    measure(tape, {&candidates[i], 1}, at);
    if (is_enough(candidates[i], mode)) return;
  }
  CompensationSearch search(tape, parameters, mode, at);
  for (const std::size_t i : formulations) {
    const Candidate from = candidates[i];
    if (from.route == i || from.error.excess * improvement < candidates[from.route].error.excess)
      search.add(from, candidates);
  }
}

}  // namespace anholon
