// SPDX-License-Identifier: GPL-2.0-or-later
// Every file in bad/ begins with the messages that reading it gives, one comment line each.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "describe/read_model.hpp"

namespace anholon::bad_files_test {
namespace {

const std::filesystem::path folder = ANHOLON_SOURCE_DIR "/tests/describe/bad";

std::vector<std::string> bad_files() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class BadFile : public ::testing::TestWithParam<std::string> {};

TEST_P(BadFile, IsRefusedWithPlaceFactAndWayOut) {
  const std::string text = text_of(folder / (GetParam() + ".toml"));
  std::string expected;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && line.starts_with("# ");)
    expected += (expected.empty() ? "" : "\n") + line.substr(2);
  try {
    read_model_text(text, GetParam() + ".toml");
    FAIL() << "the file was accepted";
  } catch (const ModelError& error) {
    EXPECT_EQ(std::string(error.what()), expected);
    for (const Diagnostic& d : error.diagnostics()) {
      EXPECT_GT(d.where.line, 0);
      EXPECT_FALSE(d.mend.empty());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, BadFile, ::testing::ValuesIn(bad_files()),
                         [](const auto& info) { return info.param; });

TEST(BadFiles, AreAtLeastForty) { EXPECT_GE(bad_files().size(), 40U); }

}  // namespace
}  // namespace anholon::bad_files_test
