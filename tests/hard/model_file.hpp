// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "describe/read_model.hpp"
#include "describe/scene.hpp"

namespace anholon::testing {

/// @param path  below the root of the project
inline Model model_file(const std::string& path) {
  return read_model(std::string(ANHOLON_SOURCE_DIR) + "/" + path);
}
inline Scene scene_file(const std::string& path) {
  return read_scene(std::string(ANHOLON_SOURCE_DIR) + "/" + path);
}
/// A scene for a model of tests/hard, from its lines.
inline Scene scene_of_model(const std::string& model, const std::string& lines) {
  return read_scene_text("anholon = 1\nname = \"hard\"\nmodel = \"" + model + ".toml\"\n" + lines,
                         std::string(ANHOLON_SOURCE_DIR) + "/tests/hard/case.scene.toml");
}

}  // namespace anholon::testing
