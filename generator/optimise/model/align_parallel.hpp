// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Two revolute joints in a row that are parallel get frames with equal axes at zero angles, so that formulas
// for parallel joints (anholon/joint_frames.hpp) see them.

#include "anholon/mechanism.hpp"

namespace anholon {

/// Names the axes of a body anew: those of its parent's frame at zero angle. Its children and moments follow.
template <class S>
void take_axes_of_parent(Mechanism<S>& mechanism, std::size_t k);

/// Does so for bodies whose joint is parallel to their parent's, with the same sense, where it takes quarter
/// turns alone. Instantiated for Exact and Expr.
/// @return number of bodies whose axes changed
template <class S>
int align_parallel(Mechanism<S>& mechanism);

}  // namespace anholon
