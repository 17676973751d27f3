// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Compensated programs: where an operation's rounding reaches the outputs enlarged, what it rounded off is
// computed as well, by an error-free transformation, and handed on to first order until it no longer counts.
// The automatic form of compensated summation (Ogita, Rump and Oishi 2005; Thevenoux, Langlois and Martel
// 2015).

#include <optional>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// The same outputs with compensated operations.
/// @param shares  of each node in the rounding error of the outputs, in ulps (rounding_shares)
/// @param tolerated  ulps; nodes with a larger share keep their rounding errors
/// @return nothing where no node has
std::optional<std::vector<NodeId>> compensated(Tape& tape, const std::vector<NodeId>& roots,
                                               const std::vector<double>& shares, double tolerated);

/// Whether what such an operation loses can be computed: then nothing of it is left where it is compensated.
bool has_known_error(Op op);

}  // namespace anholon
