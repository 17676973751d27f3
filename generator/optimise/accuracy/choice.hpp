// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Which of several programs for the same outputs is kept: the one with the fewest operations, the one that
// loses the fewest digits, or the shortest of those that lose none to speak of.

#include <functional>
#include <optional>
#include <span>
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

/// Random states at which errors are estimated to first order, and how many of these, those with the largest,
/// are measured as well: what nearly vanishes does so seldom.
inline constexpr int estimated_states = 2048, hard_states = 32;
/// So many where those leave open whether a program is good enough.
inline constexpr int many_estimated_states = 16384;
/// The tail is followed to what one state in so many shows: then seven of ten series of 1e5 stay within.
inline constexpr double expected_states = 3e5;

/// Balanced: ulps that the worst of the measured states may show where nothing is estimated. The worst of 1e5
/// states is seldom more than three times the worst of 32.
inline constexpr double tolerated_ulps = 16;
/// What is to be expected at most at the worst of 1e5 states, as verify has it.
inline constexpr double allowed_ulps = 50;
/// Balanced, where no candidate is within that: this many times the least error that any candidate shows;
/// single digits are chance.
inline constexpr double tolerated_growth = 4;

using States = std::vector<std::vector<double>>;
/// The first so many of a series of random states, as rounding_errors takes them; asked for where something
/// is measured.
using StateSource = std::function<States(int count)>;

/// What estimates say of states that are not measured.
struct Outlook {
  double largest = 0;  // at any of them
  // how much more the worst of 1e5 states may show: where there are none, as much as the worst of 32 leaves
  // open
  double growth = allowed_ulps / tolerated_ulps;
  double spread = 1;  // the largest to what one state in 32 shows
  [[nodiscard]] double worst() const { return growth * largest; }
};

struct Candidate {
  std::string name;
  std::vector<OutputBlock> outputs;
  int operations = 0;
  std::size_t route = 0;  // the candidate, as derived, that it was made from
  RoundingError error{};
  std::optional<Outlook> outlook{};

  /// About how many ulps, in units of what is allowed there, it loses at the worst of 1e5 states.
  [[nodiscard]] double worst_to_expect() const;
};

/// All entries of all blocks, and the blocks with other entries.
std::vector<NodeId> roots_of(const std::vector<OutputBlock>& outputs);
std::vector<OutputBlock> with_roots(std::vector<OutputBlock> outputs, const std::vector<NodeId>& roots);

/// Random states at which errors are estimated, few or many.
class EstimatedStates {
 public:
  EstimatedStates() = default;
  /// @param steps  operations that an estimate takes at a state
  EstimatedStates(StateSource source, std::size_t steps);

  [[nodiscard]] bool empty() const { return few_.empty(); }
  [[nodiscard]] const States& few() const { return few_; }
  /// @param errors  estimates them at states, for several programs
  [[nodiscard]] std::vector<Outlook> outlooks(
      const std::function<std::vector<std::vector<double>>(const States&)>& errors) const;

 private:
  StateSource source_;
  std::size_t steps_ = 1;
  States few_;
  mutable States many_;  // once they are needed
};

/// States at which candidates are measured, and what is allowed there (rounding_errors).
struct MeasuredStates {
  States states, allowance;
  EstimatedStates estimated;
};
/// Measures the candidates that are not yet, and estimates what further states bring where these show little.
void measure(const Tape& tape, std::span<Candidate> candidates, const MeasuredStates& at);

/// Indices in the order of operations.
std::vector<std::size_t> by_operations(const std::vector<Candidate>& candidates);

/// From the errors of each program at each of many random states.
std::vector<Outlook> outlooks_of(std::vector<std::vector<double>> errors);

/// @param candidates  at least one; errors are filled in where they were measured
/// @param more  adds candidates; called where accuracy is wanted, or balance and the shortest one loses
/// digits
/// @return index of the one to be kept: of equals the first
std::size_t choose(const Tape& tape, std::vector<Candidate>& candidates, OptimiseFor mode,
                   const StateSource& states, const std::function<void(const MeasuredStates&)>& more);

}  // namespace anholon
