// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The flat C interface of a program, see runtime/include/anholon/abi.hpp, and the same table as JSON.

#include <string>
#include <string_view>

#include "tape/interface.hpp"

namespace anholon {

/// A C++ source that includes the program's header and exports its functions for double.
/// @param header  as written between the quotes of the include
std::string emit_c_abi(const Program& program, std::string_view header);

/// Parameters, inputs, functions, outputs and counts as JSON, schema "anholon.program/1".
std::string describe_json(const Program& program);

}  // namespace anholon
