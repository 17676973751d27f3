// SPDX-License-Identifier: GPL-2.0-or-later
// Every checked-in header compiles alone, under strict warnings, and needs nothing but the mathematical
// library.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "emit/toolbox.hpp"

namespace anholon::alone_test {
namespace {

namespace fs = std::filesystem;

const fs::path generated = fs::path(ANHOLON_SOURCE_DIR) / "generated";

/// All headers below generated/, relative to it.
std::vector<std::string> header_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(generated)) {
    if (entry.path().extension() == ".hpp")
      names.push_back(entry.path().lexically_relative(generated).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// First group of every match of a pattern, line by line.
std::vector<std::string> matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, match, pattern)) found.push_back(match[1]);
  }
  return found;
}

/// Functions that a header defines for its users, with the namespace of their chart before those of charts.
std::vector<std::string> functions_of(const std::string& header) {
  static const std::regex opening(R"(^namespace (chart\d+) \{$)"), closing(R"(^\}  // namespace chart\d+$)"),
      definition(R"(^inline (?:void|Prepared<Real>) (\w+)\()");
  std::vector<std::string> functions;
  std::string scope;
  bool is_detail = false;
  std::istringstream lines(header);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, match, opening)) scope = match[1].str() + "::";
    if (std::regex_search(line, closing)) scope.clear();
    if (line == "namespace detail {" || line == "}  // namespace detail") is_detail = line.front() == 'n';
    if (!is_detail && std::regex_search(line, match, definition)) functions.push_back(scope + match[1].str());
  }
  return functions;
}

using HeaderAndCompiler = std::tuple<std::string, std::string>;
class EveryHeader : public ::testing::TestWithParam<HeaderAndCompiler> {};

TEST_P(EveryHeader, CompilesAloneAndNeedsNothingButTheMathLibrary) {
  const auto& [name, compiler] = GetParam();
  const std::vector<std::string> installed = test::compilers();
  if (std::find(installed.begin(), installed.end(), compiler) == installed.end())
    GTEST_SKIP() << compiler << " is not installed";
  const std::string header = test::read_text(generated / name);

  const std::vector<std::string> spaces = matches(header, std::regex(R"(^namespace ([\w:]*::\w+) \{$)"));
  ASSERT_EQ(spaces.size(), 1U);
  std::vector<std::string> functions = functions_of(header);
  // The table at the top names the same ones: none was missed.
  std::vector<std::string> announced =
      matches(header, std::regex(R"(^//   (\w+) +(?:\d+ (?:add|mul|div|neg|sqrt|sin|cos|other)|none)\b)"));
  for (std::string& function : announced)
    function = std::regex_replace(function, std::regex("^(chart\\d+)_"), "$1::");
  std::sort(functions.begin(), functions.end());
  std::sort(announced.begin(), announced.end());
  ASSERT_FALSE(functions.empty());
  ASSERT_EQ(functions, announced);

  std::string use = fmt::format("#include \"{}\"\n", (generated / name).string());
  for (const char* real : {"float", "double", "long double"}) {
    for (const std::string& function : functions)
      use += fmt::format("template decltype({0}::{1}<{2}>) {0}::{1}<{2}>;\n", spaces[0], function, real);
  }
  const fs::path folder = test::test_folder();
  test::write_text(folder / "use.cpp", use);
  const auto [status, text] =
      test::run(fmt::format("cd '{}' && {} -std=c++17 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror "
                            "-fno-exceptions -fno-rtti -O1 -c use.cpp -o use.o",
                            folder.string(), compiler),
                folder);
  ASSERT_EQ(status, 0) << text;
  static const std::regex libm(
      "(a?sin|a?cos|sincos|a?tan|atan2|[st]anh|cosh|exp|log|sqrt|fabs|pow)[fl]?|_GLOBAL_OFFSET_TABLE_|memcpy|"
      "memset");
  for (const std::string& symbol : test::undefined_symbols(folder / "use.o"))
    EXPECT_TRUE(std::regex_match(symbol, libm)) << symbol;
}

INSTANTIATE_TEST_SUITE_P(Headers, EveryHeader,
                         ::testing::Combine(::testing::ValuesIn(header_names()),
                                            ::testing::Values("g++", "clang++")));

}  // namespace
}  // namespace anholon::alone_test
