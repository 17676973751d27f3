// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The orders of deformation by name, and what they keep.

#include <string>
#include <vector>

#include "describe/model.hpp"

namespace anholon {

/// In the order of Deformation.
const std::vector<std::string>& deformation_names();

/// For reports: one line for each order that compliant bodies of the model have, and what T keeps there; none
/// for a rigid robot.
std::vector<std::string> kept_terms(const Model& model);

}  // namespace anholon
