// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The reader of robot descriptions, format version 1; docs/model-file.md documents every key.

#include <filesystem>
#include <string>
#include <string_view>

#include "describe/model.hpp"

namespace anholon {

/// Reads a description. @throws ModelError with everything that is wrong with it
Model read_model(const std::filesystem::path& path);

/// Likewise from text. @param file_name  stands in messages; its last component becomes Model::file
Model read_model_text(std::string_view text, const std::string& file_name);

}  // namespace anholon
