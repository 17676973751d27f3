// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The order in which nodes are emitted. Node ids depend on the order in which a compiler evaluates operands,
// so within a section only structure decides: the same program gives the same text whichever compiler built
// the generator.

#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// How nodes follow each other.
enum class NodeOrder {
  by_length,    // lifetimes for long functions, depth_first for others, which people may read
  levels,       // section by section; in each by the longest path from what the section is given, then by
                // structural key
  depth_first,  // section by section; in each, what a result needs right before it
  lifetimes,    // depth first through all sections, from the last output to the first: values die soon
};

struct EmissionOrder {
  std::vector<NodeId> nodes;  // operations only; operands precede their users
  std::size_t sincos = 0;  // so many of them, in front, are sines and cosines and what their arguments need
};

/// Order of the operations that the roots need: sines and cosines of the inputs first, so that the calls
/// stand together and nothing else is alive across them, then the rest.
/// @param given  nodes that are there already
EmissionOrder emission_order(const Tape& tape, const std::vector<NodeId>& roots,
                             const std::vector<NodeId>& given = {}, NodeOrder order = NodeOrder::by_length);

}  // namespace anholon
