// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The functions of a tree: compiled code against exact evaluation of the same program, and that program
// against the exact recursion on the mechanism as it is described (tree_reference).

#include "check/verify.hpp"
#include "derive/tree_functions.hpp"

namespace anholon {

/// @param progress  called now and then with the number of samples done; may be empty
Verification verify_tree(const Model& model, const TreeDerivation& derivation, const VerificationPlan& plan,
                         const std::function<void(int)>& progress);

}  // namespace anholon
