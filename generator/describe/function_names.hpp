// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Which functions can be asked for, by a scene or on the command line.

#include <string>
#include <vector>

namespace anholon {

/// Names of all functions, in the order in which programs list them.
const std::vector<std::string>& function_names();

/// @throws std::invalid_argument for a name that is not known
void refuse_unknown_functions(const std::vector<std::string>& functions,
                              const std::vector<std::string>& known);

}  // namespace anholon
