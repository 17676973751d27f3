// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Lumped beams: [body.chain] is written out as rigid links with torsional springs between them. As with
// repetitions, all of it happens on the document, before anything else is read.

#include "describe/document.hpp"
#include "describe/findings.hpp"

namespace anholon {

/// Replaces the chain of every body that has one. The uniform beam is cut into n segments, each of which
/// bends in its middle by a spring EI n/L, so that the frequencies have an error of order 1/n^2:
///
///   NAME      the body itself, without the chain
///   NAME_0    half a segment, fixed to it
///   NAME_i    i = 1..n: what lies between the middles of segments i and i + 1, on a revolute joint; the last
///   is half NAME_end  a frame at the tip; bodies that have NAME as their parent hang there
void write_out_chains(Value& document, Findings& findings);

}  // namespace anholon
