// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Compensated programs: where an operation's rounding reaches the outputs enlarged, what it rounded off is
// computed as well, by an error-free transformation, and handed on to first order until it no longer counts.
// The automatic form of compensated summation (Ogita, Rump and Oishi 2005; Thevenoux, Langlois and Martel
// 2015).

#include <optional>
#include <unordered_map>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// The same outputs with compensated operations.
/// @param shares  of each node in the rounding error of the outputs, in ulps (rounding_shares)
/// @param tolerated  ulps; nodes with a larger share keep their rounding errors
/// @return nothing where no node has
std::optional<std::vector<NodeId>> compensated(Tape& tape, const std::vector<NodeId>& roots,
                                               const std::vector<double>& shares, double tolerated);

/// Whether an operation with such a share is compensated: sines and cosines, which cost as much as three
/// products, beyond three times of what is tolerated.
bool is_beyond(Op op, double share, double tolerated);

/// Whether what such an operation loses can be computed: then nothing of it is left where it is compensated.
bool has_known_error(Op op);

/// Sines and cosines of one angle among some nodes, each with the other. What they lose is known in one
/// direction: by how much the two miss the unit circle. Along the circle their error is one of the angle.
std::unordered_map<NodeId, NodeId> partners_on_circle(const Tape& tape, const std::vector<NodeId>& nodes);

}  // namespace anholon
