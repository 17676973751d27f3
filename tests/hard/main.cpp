// SPDX-License-Identifier: GPL-2.0-or-later
//
// hard_tests [--table] [--pictures FOLDER] [gtest options]: with --table, the rows of docs/hard-cases.md as
// Markdown on standard output, and nothing else there; with --pictures, its pictures.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "emit/write_file.hpp"
#include "hard/table.hpp"
#include "report/plot.hpp"

namespace anholon::testing {
namespace {

std::vector<Finding>& findings() {
  static std::vector<Finding> all;
  return all;
}
std::string pictures;  // folder

void print_table() {
  std::vector<std::string> sections;
  for (const Finding& f : findings()) {
    if (std::ranges::find(sections, f.section) == sections.end()) sections.push_back(f.section);
  }
  for (const std::string& section : sections) {
    fmt::print("\n### {}\n\n| case | quantity | double | float | recursion | kappa | why |\n", section);
    fmt::print("| --- | --- | --- | --- | --- | --- | --- |\n");
    for (const Finding& f : findings()) {
      if (f.section == section)
        fmt::print("| {} | {} | {} | {} | {} | {} | {} |\n", f.name, f.quantity, f.in_double, f.in_float,
                   f.recursion, f.kappa, f.why);
    }
  }
}

}  // namespace

void note(const Finding& finding) { findings().push_back(finding); }

std::string digits_text(double relative_error) {
  if (!(relative_error < 1)) return "none";
  return relative_error > 0 ? fmt::format("{:.1f}", -std::log10(relative_error)) : "all";
}

void draw_picture(const std::string& name, const std::string& title, const std::string& abscissa,
                  const std::string& ordinate, const std::vector<PictureCurve>& curves,
                  bool logarithmic_abscissa) {
  if (pictures.empty()) return;
  LogPlot plot{title, abscissa, ordinate, {}, true, logarithmic_abscissa};
  for (const PictureCurve& curve : curves) {
    Series series{curve.name, {}};
    for (std::size_t i = 0; i < curve.x.size(); ++i) series.points.emplace_back(curve.x[i], curve.y[i]);
    plot.series.push_back(std::move(series));
  }
  write_file(std::filesystem::path(pictures) / ("hard_" + name + ".svg"), draw(plot) + "\n");
}

}  // namespace anholon::testing

int main(int argc, char** argv) {
  using namespace anholon::testing;
  ::testing::InitGoogleTest(&argc, argv);
  bool table = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (option == "--table") {
      table = true;
    } else if (option == "--pictures" && i + 1 < argc) {
      pictures = argv[++i];
    } else {
      fmt::print(stderr, "usage: hard_tests [--table] [--pictures FOLDER] [gtest options]\n");
      return 2;
    }
  }
  if (table) {
    auto& listeners = ::testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
  }
  const int outcome = RUN_ALL_TESTS();
  if (table) print_table();
  if (table && outcome != 0) fmt::print("\nTHESE FIGURES FAILED THEIR TESTS\n");
  return outcome;
}
