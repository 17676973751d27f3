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

/// Adds candidates with compensated operations (optimise/accuracy/compensation.hpp), of each formulation the
/// one with the fewest of them that is expected to stay within allowed_ulps at 1e5 states, or for
/// OptimiseFor::accuracy within a quarter of tolerated_ulps where it is measured. Nothing is added where one
/// of them is within that as it is. Measures those that it looks at.
/// @param formulations  the candidates that are compensated
void add_compensated(Tape& tape, std::vector<Candidate>& candidates, const std::vector<NodeId>& parameters,
                     OptimiseFor mode, const MeasuredStates& at, std::vector<std::size_t> formulations);

}  // namespace anholon
