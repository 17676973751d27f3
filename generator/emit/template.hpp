// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Mustache templates, filled from JSON so that the template library stays in one file.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace anholon {

/// Fills a template with strings, booleans, arrays and objects; nothing is escaped. Of several blank lines in
/// a row, which sections that are left out leave behind, one stays.
/// @throws std::logic_error if the template names a key that the data lack (mustache itself would print
/// nothing) or is malformed
std::string fill_template(std::string_view text, const nlohmann::json& data);

}  // namespace anholon
