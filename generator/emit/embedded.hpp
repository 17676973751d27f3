// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Files that are built into the library at configure time, so that the installed program needs no data files.

#include <string_view>

namespace anholon::embedded {

extern const std::string_view version;          // of the project
extern const std::string_view header_template;  // templates/header.mustache
extern const std::string_view sines_cosines;    // templates/sines_cosines.inl
extern const std::string_view rounding_errors;  // templates/rounding_errors.inl
extern const std::string_view tree_loops;       // templates/tree_loops.inl
extern const std::string_view c_abi_template;   // templates/c_abi.mustache
extern const std::string_view timing_template;  // templates/timing.mustache
extern const std::string_view report_template;  // templates/report.mustache
extern const std::string_view abi_header;       // runtime/include/anholon/abi.hpp

}  // namespace anholon::embedded
