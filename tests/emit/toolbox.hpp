// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Folders, compilers and symbol tables for the tests of emitted text.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace anholon::test {

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

/// A folder of the running test in the build tree, empty at the start.
inline std::filesystem::path test_folder() {
  const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = fmt::format("{}.{}", info->test_suite_name(), info->name());
  for (char& c : name) c = c == '/' ? '_' : c;
  const std::filesystem::path folder = std::filesystem::path(ANHOLON_BINARY_DIR) / "test-scratch" / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

/// Runs a shell command; what it prints is returned with its status.
inline std::pair<int, std::string> run(const std::string& command, const std::filesystem::path& folder) {
  const std::filesystem::path log = folder / "log";
  const int status = std::system(fmt::format("{} >'{}' 2>&1", command, log.string()).c_str());
  return {status, read_text(log)};
}

/// Those of g++ and clang++ that are installed.
inline std::vector<std::string> compilers() {
  std::vector<std::string> found;
  for (const char* name : {"g++", "clang++"}) {
    if (std::system(fmt::format("command -v {} >/dev/null 2>&1", name).c_str()) == 0)
      found.emplace_back(name);
  }
  return found;
}

/// Names of an object's undefined symbols.
inline std::vector<std::string> undefined_symbols(const std::filesystem::path& object) {
  const auto [status, text] = run(fmt::format("nm -u '{}'", object.string()), object.parent_path());
  EXPECT_EQ(status, 0) << text;
  std::istringstream words(text);
  std::vector<std::string> names;
  for (std::string word; words >> word;) {
    if (word != "U") names.push_back(word);
  }
  return names;
}

}  // namespace anholon::test
