// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A frame may be turned about the axis of its revolute joint by a constant angle, which the joint's angle
// takes up. At a tip nothing else depends on it: the frame is turned so that the first moment has one
// component across the axis.

#include "anholon/mechanism.hpp"

namespace anholon {

/// Turns the frame of body k about its joint's axis by the angle of cosine c and sine s. Multiples of pi/2
/// are the caller's to put into Body::R; here the joint's angle becomes r + angle, as a coupling.
template <class S>
void turn_frame(Mechanism<S>& mechanism, std::size_t k, const S& angle, const S& c, const S& s);

/// Turns the frame of every tip. Moments are constants or depend on parameters alone. Instantiated for Exact
/// and Expr.
/// @return number of frames that turned
template <class S>
int rotate_leaves(Mechanism<S>& mechanism);

}  // namespace anholon
