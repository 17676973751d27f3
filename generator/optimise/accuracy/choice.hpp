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

/// Random states at which they are estimated, and how many of these, where the most is to be expected, are
/// measured as well: what nearly vanishes does so seldom.
inline constexpr int estimated_states = 2048, hard_states = 16;

/// Balanced: ulps that the worst of the measured states may show without further question. Generated code is
/// to stay below 50 ulps at 1e5 states; the worst of so many is seldom more than three times the worst of 32.
inline constexpr double tolerated_ulps = 16;
/// What verify allows, and the least that is asked for where the worst states are far worse than others, as
/// they will be again among 1e5.
inline constexpr double allowed_ulps = 50, least_tolerated = 2;
/// Balanced, where no candidate is within that: this many times the least error that any candidate shows;
/// single digits are chance.
inline constexpr double tolerated_growth = 4;

/// Whether estimates at more states (estimated_states) add to what is measured at a few.
enum class Estimates { none, hard_states };

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

/// The first so many of a series of random states, as rounding_errors takes them; asked for where something
/// is measured.
using StateSource = std::function<std::vector<std::vector<double>>(int count)>;

/// States at which candidates are measured, and what is allowed there (rounding_errors).
struct MeasuredStates {
  std::vector<std::vector<double>> states, allowance;
  double tolerated = tolerated_ulps;  // excess
};
/// Measures the candidates that are not yet.
void measure(const Tape& tape, std::vector<Candidate>& candidates, const MeasuredStates& at);

/// @param candidates  at least one; errors are filled in where they were measured
/// @param more  adds candidates; called where accuracy is wanted, or balance and the shortest one loses
/// digits
/// @param estimates  of the shortest candidate, which is the only one that most functions look at; they take
/// longer than the measurement where there are many outputs
/// @return index of the one to be kept: of equals the first
std::size_t choose(const Tape& tape, std::vector<Candidate>& candidates, OptimiseFor mode,
                   const StateSource& states, const std::function<void(const MeasuredStates&)>& more,
                   Estimates estimates);

}  // namespace anholon
