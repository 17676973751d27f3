// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/read_bytes.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "describe/location.hpp"
#include "describe/scene.hpp"

namespace anholon::read_bytes_test {
namespace {

TEST(ReadBytes, RefusesWhatIsTooLargeInsteadOfItsEnd) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "large_table.csv";
  std::ofstream(file) << std::string(largest_file, '1');
  EXPECT_EQ(read_bytes(file).size(), largest_file);
  std::ofstream(file, std::ios::app) << "1";
  EXPECT_THROW(read_bytes(file), ModelError);
  std::filesystem::remove(file);
}

TEST(FilesRead, AreAllThatASceneStandsOn) {
  const std::string scene = std::string(ANHOLON_SOURCE_DIR) + "/models/quadruped_stance/stances.scene.toml";
  std::vector<std::string> names;
  const FilesRead outer;
  {
    const FilesRead read;
    (void)read_scene(scene);
    (void)read_scene(scene);
    for (const std::filesystem::path& file : read.files()) names.push_back(file.filename().string());
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"quadruped.urdf", "quadruped_stance.toml", "stances.scene.toml"}));
  EXPECT_EQ(outer.files().size(), names.size());  // they are those of the outer one, too
}

}  // namespace
}  // namespace anholon::read_bytes_test
