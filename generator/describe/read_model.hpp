// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The reader of robot descriptions, format version 1; docs/model-file.md documents every key.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "describe/model.hpp"
#include "describe/repetition.hpp"

namespace anholon {

/// Values that replace those of the description's parameters, by name.
using ParameterValues = std::map<std::string, Exact, std::less<>>;

/// Reads a description. @throws ModelError with everything that is wrong with it
/// @param overrides  values for some of its parameters; names that are not parameters of it are ignored
/// @param counts  numbers for some of its counts
Model read_model(const std::filesystem::path& path, const ParameterValues& overrides = {},
                 const CountValues& counts = {});

/// Likewise from text. @param file_name  stands in messages; its last component becomes Model::file
Model read_model_text(std::string_view text, const std::string& file_name,
                      const ParameterValues& overrides = {}, const CountValues& counts = {});

}  // namespace anholon
