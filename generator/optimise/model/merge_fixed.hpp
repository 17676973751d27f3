// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Bodies joined by fixed joints become one: a mass, a frame and a joint less to compute.

#include "anholon/mechanism.hpp"

namespace anholon {

/// Merges every rigid body on a fixed joint into its parent; rows and wrenches that refer to it go along. A
/// compliant body stays what it is. Instantiated for Exact and Expr.
/// @return number of bodies that are gone
template <class S>
int merge_fixed(Mechanism<S>& mechanism);

}  // namespace anholon
