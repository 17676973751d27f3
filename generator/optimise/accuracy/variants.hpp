// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Further programs for the outputs of a candidate.

#include <optional>
#include <vector>

#include "optimise/accuracy/choice.hpp"

namespace anholon {

/// The candidate after each pass over the program that shortens it.
std::vector<Candidate> after_passes(Tape& tape, const Candidate& candidate,
                                    const std::vector<NodeId>& parameters);

/// The candidate with its differences in stable form (optimise/tape/stable_forms.hpp); nothing where there
/// are none.
std::optional<Candidate> in_stable_form(Tape& tape, const Candidate& candidate,
                                        const std::vector<NodeId>& parameters);

/// Adds the candidates with compensated operations (optimise/accuracy/compensation.hpp), each with the fewest
/// of them that keep it within tolerated_ulps; for OptimiseFor::accuracy, with as many as help. Nothing is
/// added where a candidate is within them as it is and accuracy is not asked for. Measures those that it
/// looks at.
/// @param many  states at which it is seen which operations the errors come from
void add_compensated(Tape& tape, std::vector<Candidate>& candidates, const std::vector<NodeId>& parameters,
                     OptimiseFor mode, const MeasuredStates& at);

}  // namespace anholon
