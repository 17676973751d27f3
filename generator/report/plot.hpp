// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Logarithmic plots by gnuplot, as SVG that goes into a page.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace anholon {

/// gnuplot is not there or refused its script; what() says what to do.
class PlotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;  // those that are not positive and finite are left out
};

struct LogPlot {
  std::string title, abscissa, ordinate;
  std::vector<Series> series;
  bool joined = true;                // points of a series by lines
  bool logarithmic_abscissa = true;  // else linear, as of time
};

/// An <svg> element. @throws PlotError
std::string draw(const LogPlot& plot);

}  // namespace anholon
