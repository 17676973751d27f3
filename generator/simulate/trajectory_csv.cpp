// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>

#include <cmath>

#include "simulate/simulation.hpp"

namespace anholon {

std::string trajectory_csv(const SimulationResult& result) {
  std::string text;
  for (const std::string& c : result.columns) text += (text.empty() ? "" : ",") + c;
  text += "\n";
  for (const auto& row : result.rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      text += (i == 0 ? "" : ",") + (std::isnan(row[i]) ? "" : fmt::format("{}", row[i]));
    text += "\n";
  }
  return text;
}

}  // namespace anholon
