// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the cases have found, for docs/hard-cases.md: `hard_tests --table` prints it.

#include <string>
#include <vector>

namespace anholon::testing {

/// One row; what is empty was not asked.
struct Finding {
  std::string section, name, quantity;
  std::string in_double, in_float, recursion;  // digits kept
  std::string kappa;                           // where it explains the loss
  std::string why;
};
void note(const Finding& finding);

/// "13.2" of an error relative to the size; "none" where no digit is left.
std::string digits_text(double relative_error);

/// A curve over time, or over whatever the abscissa is.
struct PictureCurve {
  std::string name;
  std::vector<double> x, y;
};
/// Writes FOLDER/hard_NAME.svg by gnuplot where hard_tests was given --pictures FOLDER.
void draw_picture(const std::string& name, const std::string& title, const std::string& abscissa,
                  const std::string& ordinate, const std::vector<PictureCurve>& curves,
                  bool logarithmic_abscissa);

}  // namespace anholon::testing
