// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// One self-contained C++17 header per program.

#include <string>

#include "emit/statements.hpp"
#include "tape/interface.hpp"

namespace anholon {

/// Text of the header. Equal programs give equal bytes, whatever the order in which their nodes were made.
std::string emit_header(const Program& program, const StatementStyle& style = {});

}  // namespace anholon
