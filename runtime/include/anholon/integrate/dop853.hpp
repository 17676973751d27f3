// SPDX-License-Identifier: MIT
//
// DOP853 for integrate_adaptive(): order 8 with step control, for smooth motions at tolerances below 1e-9.
// Output inside a step costs three evaluations more.
#pragma once

#include "anholon/integrate/adaptive.hpp"
#include "anholon/integrate/dop853_tableau.hpp"

namespace anholon::integrate {

template <class G>
using Dop853 = RkmkStages<G, DormandPrince853>;

}  // namespace anholon::integrate
