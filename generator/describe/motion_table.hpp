// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Tables of numbers with a header line, as spreadsheets write them: comma-separated, "t" first.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "describe/findings.hpp"

namespace anholon {

struct NumberTable {
  std::vector<std::string> names;         // of the columns
  std::vector<std::vector<double>> rows;  // one number a column
};

/// Reads a table. Lines that start with # and empty lines are skipped; errors go to `findings`.
NumberTable read_number_table(std::string_view text, const std::string& file_name, Findings& findings);

}  // namespace anholon
