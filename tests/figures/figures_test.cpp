// SPDX-License-Identifier: GPL-2.0-or-later
// The figures of README and docs/ are those of docs/report/, and these are of the code as it is.
#include "figures.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>

namespace anholon {
namespace {

namespace fs = std::filesystem;

const fs::path project = ANHOLON_SOURCE_DIR;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST(Figures, OfEveryDocumentAreThoseOfTheRecords) {
  const bench::Figures figures = bench::figures_of(project / "docs" / "report");
  const auto documents = bench::documents_with_figures(project);
  ASSERT_GE(documents.size(), 2U) << "README.md and docs/report.md at least";
  for (const fs::path& document : documents) {
    const std::string text = text_of(document);
    EXPECT_TRUE(bench::with_figures(text, figures) == text)
        << document << " holds other figures than docs/report/: run scripts/figures";
  }
}

/// Without the functions of further charts, which have the names of those of the first.
std::string first_chart_of(std::string header) {
  for (std::size_t at = 0; (at = header.find("\nnamespace chart", at)) != std::string::npos;)
    header.erase(at, header.find("\n}  // namespace chart", at) - at);
  return header;
}

/// Additions, multiplications and divisions of each function of a generated header, from its comments.
std::map<std::string, int> operations_of(const std::string& header) {
  std::map<std::string, int> operations;
  const std::regex line("/// operations: ([^\n]*)\n"), name("inline void ([A-Za-z_0-9]+)\\(");
  const std::regex count("([0-9]+) (add|mul|div)");
  for (std::sregex_iterator it(header.begin(), header.end(), line), end; it != end; ++it) {
    const std::string counts = (*it)[1];
    int total = 0;
    for (std::sregex_iterator c(counts.begin(), counts.end(), count); c != end; ++c)
      total += std::stoi((*c)[1]);
    std::smatch function;
    const auto from = (*it)[0].second;
    if (std::regex_search(from, from + std::min<std::ptrdiff_t>(8000, header.end() - from), function, name))
      operations[function[1]] = total;
  }
  return operations;
}

TEST(Figures, CountTheOperationsOfTheCodeThatIsShipped) {
  const auto report = nlohmann::json::parse(text_of(project / "docs" / "report" / "report.json"));
  int compared = 0;
  for (const auto& model : report.at("models")) {
    const std::string name = model.at("model");
    const fs::path header = project / "generated" / name / "standard.hpp";
    if (!fs::exists(header)) continue;
    const std::map<std::string, int> shipped = operations_of(first_chart_of(text_of(header)));
    for (const auto& function : model.at("functions")) {
      const auto found = shipped.find(function.at("function"));
      if (found == shipped.end()) continue;
      ++compared;
      EXPECT_EQ(function.at("operations").at("total"), found->second)
          << name << ", " << found->first << ": measure again, scripts/figures --measure";
    }
  }
  EXPECT_GT(compared, 250);
}

TEST(Figures, StandBetweenTheirMarks) {
  const bench::Figures figures = {{"a", "| 1 |\n"}};
  const std::string text = "x\n<!-- figures: a -->\nold\n<!-- end of figures -->\ny\n";
  const std::string fresh = "x\n<!-- figures: a -->\n\n| 1 |\n\n<!-- end of figures -->\ny\n";
  EXPECT_EQ(bench::with_figures(text, figures), fresh);
  EXPECT_EQ(bench::with_figures(fresh, figures), fresh);
  EXPECT_THROW(bench::with_figures("<!-- figures: b -->\n<!-- end of figures -->", figures),
               std::runtime_error);
  EXPECT_THROW(bench::with_figures("<!-- figures: a -->\n", figures), std::runtime_error);
}

}  // namespace
}  // namespace anholon
