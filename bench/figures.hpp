// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The figures of README and docs/: tables made from the records of docs/report/, which `scripts/figures`
// measures. In a document a table stands between two comments,
//
//   <!-- figures: NAME -->
//   | ... |
//   <!-- end of figures -->

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace anholon::bench {

/// Markdown by name.
using Figures = std::map<std::string, std::string>;

/// Of the records report.json, motions.json and stiffness_cost.json of a folder.
/// @throws std::runtime_error, nlohmann::json::exception where a record is missing or another than expected
Figures figures_of(const std::filesystem::path& folder);

/// The text with its tables replaced. @throws std::runtime_error naming what has no table, or no end
std::string with_figures(const std::string& text, const Figures& figures);

/// README.md, docs/*.md and models/*/README.md that hold figures.
std::vector<std::filesystem::path> documents_with_figures(const std::filesystem::path& project);

}  // namespace anholon::bench
