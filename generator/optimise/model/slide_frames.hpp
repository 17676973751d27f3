// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A body's origin may lie anywhere on the axis of its revolute joint, and anywhere at all on a prismatic one.
// It is put where the offset from the parent has the fewest components.

#include "anholon/mechanism.hpp"

namespace anholon {

/// Moves the origin of body k by t along its joint's axis; its children and moments follow.
template <class S>
void slide(Mechanism<S>& mechanism, std::size_t k, const Vec3<S>& t);

enum class SlideTowards {
  tips,  // a body's offset from its parent loses its component along the body's own axis; the children take
         // it over
  base,  // a body with one child takes over the component of the child's offset along its own axis
};

/// Slides every frame. Instantiated for Exact and Expr.
/// @return number of frames that moved
template <class S>
int slide_frames(Mechanism<S>& mechanism, SlideTowards towards = SlideTowards::tips);

}  // namespace anholon
