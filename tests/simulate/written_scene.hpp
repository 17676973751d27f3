// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Models and scenes that a test writes itself.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "describe/scene.hpp"

namespace anholon::testing {

/// A folder of this test alone, for tests run at the same time.
inline std::filesystem::path test_folder() {
  const ::testing::TestInfo& test = *::testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / (std::string(test.test_suite_name()) + "_" + test.name());
  std::filesystem::create_directories(folder);
  return folder;
}

/// A scene of a model, both given as text; what the scene says begins in line 4.
inline Scene written_scene(const std::string& model, const std::string& scene) {
  const std::filesystem::path folder = test_folder();
  std::ofstream(folder / "model.toml") << model;
  return read_scene_text("anholon = 1\nname = \"scene\"\nmodel = \"model.toml\"\n" + scene,
                         folder / "scene.toml");
}

/// Two masses on a line: the second slides on the first, by r1, and may be latched to it.
inline const std::string two_bodies = R"toml(anholon = 1
name = "two_bodies"
group = "R1"
[[body]]
name = "first"
inertia = { mass = 2 }
[[body]]
name = "second"
parent = "first"
joint = { kind = "prismatic", axis = [1, 0, 0], coordinate = "r1", range = [-10, 10] }
inertia = { mass = 3 }
[[constraint]]
name = "latch"
row = "dot(r1)"
)toml";

}  // namespace anholon::testing
