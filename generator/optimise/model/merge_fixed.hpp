// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Bodies joined by fixed joints become one.

#include "anholon/mechanism.hpp"

namespace anholon {

/// Merges every body on a fixed joint into its parent. Instantiated for Exact and Expr.
/// @return number of bodies that are gone
template <class S>
int merge_fixed(Mechanism<S>& mechanism);

}  // namespace anholon
