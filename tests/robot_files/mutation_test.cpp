// SPDX-License-Identifier: GPL-2.0-or-later

// Reading a robot file ends with a model or a ModelError, whatever the bytes.

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "describe/read_bytes.hpp"
#include "describe/read_robot.hpp"

namespace anholon::mutation_test {
namespace {

/// One or two changes: bytes, pieces of the formats, parts of the text moved or left out.
std::string mutated(std::string text, std::mt19937_64& random) {
  static const std::vector<std::string> pieces = {"nan",
                                                  "1e31",
                                                  "-",
                                                  "0 0 0",
                                                  "'",
                                                  "\"",
                                                  "<",
                                                  "/>",
                                                  "<pose/>",
                                                  "<axis/>",
                                                  "<body/>",
                                                  "<joint/>",
                                                  "<inertial/>",
                                                  "<frame name='f'/>",
                                                  "relative_to='hand' ",
                                                  "expressed_in='tool' ",
                                                  "class='free_running' ",
                                                  "type='ball' ",
                                                  "quat='0 0 0 0' ",
                                                  "euler='1 2 3' ",
                                                  "fromto='0 0 0 0 0 0' ",
                                                  "size='0' ",
                                                  "ref='1' ",
                                                  "name='' ",
                                                  "&lt;",
                                                  "\xff"};
  const auto changes = 1 + random() % 2;
  for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = random() % text.size();
    const std::size_t from = random() % text.size();
    switch (random() % 5) {
      case 0:
        text[at] = static_cast<char>(random() % 256);
        break;
      case 1:
        text.erase(at, 1 + random() % 40);
        break;
      case 2:
        text.insert(at, pieces[random() % pieces.size()]);
        break;
      case 3:
        text.insert(at, text.substr(from, random() % 120));
        break;
      default: {  // an attribute or element more, where one can stand
        const std::size_t space = text.find_first_of(" \n", at);
        if (space != std::string::npos) text.insert(space + 1, pieces[random() % pieces.size()]);
      }
    }
  }
  return text;
}

class RobotFileMutants : public ::testing::TestWithParam<std::string> {};

TEST_P(RobotFileMutants, AreReadOrRefused) {
  const auto path = std::filesystem::path(ANHOLON_SOURCE_DIR) / "tests" / "robot_files" / GetParam();
  const std::string good = read_bytes(path);
  std::mt19937_64 random(20131022);  // fixed: a failure must be repeatable
  int read = 0, refused = 0;
  for (int i = 0; i < 1500; ++i) {
    try {
      read_robot_text(mutated(good, random), "mutant");
      ++read;
    } catch (const ModelError& error) {
      EXPECT_FALSE(error.diagnostics().empty());
      ++refused;
    }
  }
  EXPECT_GT(read, 50);  // else the changes are too coarse to reach what lies behind the syntax
  EXPECT_GT(refused, 50);
}

INSTANTIATE_TEST_SUITE_P(All, RobotFileMutants,
                         ::testing::Values("arm.urdf", "arm.sdf", "arm.xml", "walker.xml"),
                         [](const auto& info) {
                           std::string name = info.param;
                           name[name.find('.')] = '_';
                           return name;
                         });

}  // namespace
}  // namespace anholon::mutation_test
