// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Which names a description may give, and which known name a mistyped one was meant to be.

#include <string>
#include <string_view>
#include <vector>

namespace anholon {

/// Why a name cannot be used in generated code, as the end of a sentence ("is a C++ keyword"); empty if it
/// can.
std::string objection_to_name(std::string_view name);

/// The candidate nearest to `name` in edit distance, if it is near enough to be what was meant; else empty.
std::string closest_name(std::string_view name, const std::vector<std::string>& candidates);

/// "did you mean 'x'?", or `otherwise` where no candidate is near.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates,
                         std::string_view otherwise);

/// "a, b and c"; at most twenty of them.
std::string listed(const std::vector<std::string>& names);

}  // namespace anholon
