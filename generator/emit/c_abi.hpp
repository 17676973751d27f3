// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The flat C interface of a program, see runtime/include/anholon/abi.hpp, and the same table as JSON.

#include <string>
#include <string_view>

#include "tape/interface.hpp"

namespace anholon {

/// In what the functions behind the interface compute. The interface itself is one of double.
enum class AbiScalar { is_double, is_float };

/// A C++ source that includes the program's header and exports its functions.
/// @param header  as written between the quotes of the include
std::string emit_c_abi(const Program& program, std::string_view header,
                       AbiScalar scalar = AbiScalar::is_double);

/// Parameters, inputs, functions, outputs and counts as JSON, schema "anholon.program/1".
std::string describe_json(const Program& program);

}  // namespace anholon
