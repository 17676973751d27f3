// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Curves over a common axis as an SVG picture: panels above each other. The same values give the same bytes.

#include <string>
#include <vector>

namespace anholon {

struct Curve {
  std::string name;
  std::vector<double> values;  // one for each abscissa; what the ordinate cannot show is left out
};
struct Panel {
  std::string title;
  std::vector<Curve> curves;
  bool is_linear = false;  // the ordinate; else logarithmic
};

std::string svg_plot(const std::string& title, const std::string& abscissa, const std::vector<double>& x,
                     const std::vector<Panel>& panels);

}  // namespace anholon
