// SPDX-License-Identifier: GPL-2.0-or-later
#include "cli/common.hpp"

namespace anholon::cli {

int simulate(const SimulateOptions& /*options*/) { throw std::runtime_error("simulate is being built"); }

}  // namespace anholon::cli
