// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// How long the functions of a program take, in double and in float.

#include <string>
#include <vector>

#include "emit/statements.hpp"
#include "tape/interface.hpp"

namespace anholon {

/// Of one call [ns], over rounds that each go through all states.
struct CallTime {
  double median = 0, least = 0;
  double spread = 0;  // distance of the quartiles
};

struct FunctionTime {
  std::string function;
  CallTime by_double, by_float;
};

/// Compiles the functions with the flags of CompileOptions, those of the code whose errors are reported, and
/// times them in turn, so that whatever else the machine does meets all of them alike.
/// @param states  input blocks one behind the other, in the order of Program::inputs; each state is as long
/// as all of them
/// @throws CompileError
std::vector<FunctionTime> time_functions(const Program& program, const std::vector<double>& states,
                                         int rounds, const StatementStyle& style = {});

/// The source that time_functions() compiles beside the header, which it includes as "program.hpp".
std::string emit_timing(const Program& program);

}  // namespace anholon
