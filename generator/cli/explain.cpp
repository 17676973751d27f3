// SPDX-License-Identifier: GPL-2.0-or-later
#include "cli/common.hpp"

namespace anholon::cli {

int explain(const ExplainOptions& /*options*/) { throw std::runtime_error("explain is being built"); }

}  // namespace anholon::cli
