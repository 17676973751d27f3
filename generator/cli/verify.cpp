// SPDX-License-Identifier: GPL-2.0-or-later
#include "cli/common.hpp"

namespace anholon::cli {

int verify(const VerifyOptions& /*options*/) { throw std::runtime_error("verify is being built"); }

}  // namespace anholon::cli
