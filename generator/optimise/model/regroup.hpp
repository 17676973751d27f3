// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Base inertial parameters, Gautier and Khalil 1990: mass whose motion a joint does not change counts as the
// parent's. For the second moment Sigma about a revolute axis n these are the mass, its moment along n and
// Sigma_nn; for a prismatic joint all of Sigma. Joint forces and the base wrench stay; wrenches inside the
// joints and energies of single bodies change.

#include "anholon/mechanism.hpp"

namespace anholon {

/// Moves what body k may give to its parent.
template <class S>
void regroup(Mechanism<S>& mechanism, std::size_t k);

/// The same for all bodies, tips first. Instantiated for Exact and Expr.
template <class S>
void regroup(Mechanism<S>& mechanism);

}  // namespace anholon
