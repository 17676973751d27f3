// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Which of several programs for the same outputs is kept: the one with the fewest operations, the one that
// loses the fewest digits, or the shortest of those that lose none to speak of.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "optimise/accuracy/rounding_error.hpp"
#include "tape/interface.hpp"

namespace anholon {

/// `nothing` takes the first formulation as it is derived: what reports compare the others with.
enum class OptimiseFor { accuracy, balanced, speed, nothing };
std::string_view name(OptimiseFor mode);
/// @throws std::invalid_argument for any other name
OptimiseFor optimise_for(std::string_view name);

/// Random states at which errors are measured.
inline constexpr int measured_states = 32;

/// Balanced: ulps that the worst of the measured states may show without further question. Generated code is
/// to stay below 50 ulps at 1e5 states; the worst of so many is seldom more than three times the worst of 32.
inline constexpr double tolerated_ulps = 16;
/// Balanced: beyond that, this many times the least error that any candidate shows. Inputs rounded to double
/// lose as much at an ill-conditioned state whatever the program; single digits are chance.
inline constexpr double tolerated_growth = 4;

struct Candidate {
  std::string name;
  std::vector<OutputBlock> outputs;
  int operations = 0;
  std::size_t route = 0;  // the candidate, as derived, that it was made from
  RoundingError error{};
};

/// All entries of all blocks, and the blocks with other entries.
std::vector<NodeId> roots_of(const std::vector<OutputBlock>& outputs);
std::vector<OutputBlock> with_roots(std::vector<OutputBlock> outputs, const std::vector<NodeId>& roots);

/// States at which the candidates are measured, asked for only where something is measured.
using MeasuredStates = std::function<std::vector<std::vector<double>>()>;
void measure(const Tape& tape, std::vector<Candidate>& candidates, const MeasuredStates& states);

/// @param candidates  at least one; errors are filled in where they were measured
/// @param more  adds candidates; called where accuracy is wanted, or balance and the shortest one shows more
/// than tolerated_ulps
/// @param first_look  states of the first look at the shortest candidate, which is all that most functions
/// get: the worst of all of them is seldom more than twice the worst of eight, unless something nearly
/// vanishes now and then
/// @return index of the one to be kept: of equals the first
std::size_t choose(const Tape& tape, std::vector<Candidate>& candidates, OptimiseFor mode,
                   const MeasuredStates& states, const std::function<void()>& more,
                   std::size_t first_look = 8);

}  // namespace anholon
