// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Closed forms of small programs.

#include <optional>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

struct ClosedFormLimits {
  std::size_t nodes = 1500;  // that the roots need
  std::size_t terms = 150;   // of any polynomial on the way
};

/// The roots as quotients of polynomials in the inputs, cosines and sines, simplified by c^2 + s^2 = 1,
/// cancelled, factored and nested, on the same tape. Of the forms that eliminate sines or cosines the
/// cheapest is given; whether it beats the tape's own program is for the caller to count, over all roots at
/// once.
///
/// @return nothing where a limit is passed; limits are sizes, so the answer is the same on every machine
std::optional<std::vector<NodeId>> closed_form(Tape& tape, const std::vector<NodeId>& roots,
                                               const ClosedFormLimits& limits = {});

}  // namespace anholon
