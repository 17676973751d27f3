// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/motion_table.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace anholon {
namespace {

struct Cell {
  std::string_view text;
  int column = 1;  // of its first character
};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<Cell> cells_of(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    const std::string_view text =
        trimmed(line.substr(begin, comma == std::string_view::npos ? comma : comma - begin));
    const std::size_t first = text.empty() ? begin : static_cast<std::size_t>(text.data() - line.data());
    cells.push_back({text, static_cast<int>(first) + 1});
    if (comma == std::string_view::npos) return cells;
    begin = comma + 1;
  }
}

}  // namespace

NumberTable read_number_table(std::string_view text, const std::string& file_name, Findings& findings) {
  NumberTable table;
  int line_number = 0;
  while (!text.empty()) {
    ++line_number;
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    const std::vector<Cell> cells = cells_of(line);
    if (table.names.empty()) {
      for (const Cell& cell : cells) table.names.emplace_back(cell.text);
      continue;
    }
    if (cells.size() != table.names.size()) {
      findings.error(
          {file_name, line_number, 1},
          fmt::format("the line has {} numbers, the header {} names", cells.size(), table.names.size()),
          "write one number a name");
      continue;
    }
    std::vector<double>& row = table.rows.emplace_back();
    for (const Cell& cell : cells) {
      double value = 0;
      const char* stop = cell.text.data() + cell.text.size();
      const auto [at, problem] = std::from_chars(cell.text.data(), stop, value);
      if (problem != std::errc() || at != stop || !std::isfinite(value))
        findings.error({file_name, line_number, cell.column},
                       fmt::format("'{}' is not a number", cell.text.substr(0, 40)),
                       "write a finite decimal number");
      row.push_back(value);
    }
  }
  return table;
}

}  // namespace anholon
