// SPDX-License-Identifier: GPL-2.0-or-later
// Errors of several files in one reading, and files that are too large.
#include "describe/findings.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "describe/document.hpp"

namespace anholon::findings_test {
namespace {

TEST(Findings, KeepOneErrorAPlaceOfEachFile) {
  Findings findings;
  findings.error({"model.toml", 3, 1}, "one", "mend it");
  findings.error({"model.toml", 3, 1}, "what follows from it", "mend it");
  findings.error({"beam.toml", 3, 1}, "another file's", "mend it");
  EXPECT_EQ(findings.size(), 2U);
  try {
    findings.throw_if_any();
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_EQ(std::string(error.what()),
              "beam.toml:3:1: error: another file's; mend it\nmodel.toml:3:1: error: one; mend it");
  }
}

TEST(ReadBytes, RefusesWhatIsTooLargeInsteadOfItsEnd) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "large_table.csv";
  std::ofstream(file) << std::string(largest_file, '1');
  EXPECT_EQ(read_bytes(file).size(), largest_file);
  std::ofstream(file, std::ios::app) << "1";
  EXPECT_THROW(read_bytes(file), ModelError);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace anholon::findings_test
