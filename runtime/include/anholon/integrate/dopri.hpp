// SPDX-License-Identifier: MIT
//
// Dormand-Prince 5(4) for integrate_adaptive(): the method for most motions at tolerances down to 1e-9.
#pragma once

#include "anholon/integrate/adaptive.hpp"
#include "anholon/integrate/dense.hpp"
#include "anholon/integrate/tableau.hpp"

namespace anholon::integrate {

template <class G>
using DormandPrince = RkmkStages<G, DormandPrince54>;

/// Its step, as observers see it; a quartic inside.
template <class G>
using DenseStep = DenseStepOf<DormandPrince<G>, NoField>;

}  // namespace anholon::integrate
