// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/variants.hpp"

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

}  // namespace anholon
