// SPDX-License-Identifier: GPL-2.0-or-later
// A scene pays only for what moves: a locked joint costs what the model with one body in place of the two
// costs, a frozen parameter nothing.

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "derive/derive.hpp"
#include "describe/read_model.hpp"
#include "describe/scene.hpp"
#include "describe/specialise.hpp"

namespace anholon::locked_joint_test {
namespace {

const std::string folder = std::string(ANHOLON_SOURCE_DIR) + "/models/";

std::string text_of(const std::string& file) {
  std::ifstream in(folder + file);
  std::ostringstream text;
  text << in.rdbuf();
  EXPECT_FALSE(text.str().empty()) << file;
  return text.str();
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  for (; at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
}

/// Operations of each function, but for the poses, which are wanted of every body that is described.
std::map<std::string, int> operations(const Model& model) {
  const auto derivation = derive(model);
  std::map<std::string, int> counts;
  for (const Function& f : derivation->program.functions) {
    if (f.name == "body_poses") continue;
    std::vector<NodeId> roots;
    for (const OutputBlock& b : f.outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
    counts[f.name] = operations_per_call(derivation->program, roots).total();
  }
  return counts;
}

Model specialised(const std::string& model, const std::string& rest) {
  const Scene scene = read_scene_text("anholon = 1\nname = \"test\"\nmodel = \"" + model + ".toml\"\n" + rest,
                                      folder + model + "/test.scene.toml");
  return specialise(scene.model, scene);
}

/// The soft snake-board without the shaft as a body of its own, its beams turned by `angle` in the platform.
Model snakeboard_without_shaft(const std::string& angle) {
  std::string text = text_of("soft_snakeboard/soft_snakeboard.toml");
  const std::size_t shaft = text.find("[[body]]\nname    = \"hub\"");
  text.erase(shaft, text.find("# The beams point") - shaft);
  replace(text, "zz = \"J_p\"", "zz = \"J_p + J_h\"");
  replace(text, "parent = \"hub\"\npose   = { rotation = { axis = \"z\", angle = \"pi\" } }",
          "parent = \"platform\"\npose   = { rotation = [{ axis = \"z\", angle = \"" + angle +
              "\" }, { axis = \"z\", angle = \"pi\" }] }");
  replace(text, "parent = \"hub\"",
          "parent = \"platform\"\npose   = { rotation = { axis = \"z\", angle = \"" + angle + "\" } }");
  return read_model_text(text, "merged.toml");
}

TEST(LockedJoint, CostsAsMuchAsOneBodyInPlaceOfTwo) {
  for (const std::string angle : {"0", "0.3", "pi/2"}) {
    SCOPED_TRACE(angle);
    EXPECT_EQ(operations(specialised("soft_snakeboard", "locked = { r3 = \"" + angle + "\" }")),
              operations(snakeboard_without_shaft(angle)));
  }
}

TEST(LockedJoint, TakesItsRowsAlong) {
  std::string text = text_of("trailer/trailer.toml");
  const std::size_t trailer = text.find("[[body]]\nname    = \"trailer\"");
  text.erase(trailer, text.find("[[body]]\nname    = \"rotor\"") - trailer);
  replace(text, "mass = \"m_c\", com = [\"c\", 0, 0], about_com = { zz = \"J_c\" }",
          "mass = \"m_c + m_t\", first_moment = [\"m_c*c - m_t*(b + e)\", 0, 0], "
          "about_origin = { zz = \"J_c + m_c*c^2 + J_t + m_t*(b + e)^2\" }");
  replace(text, "body  = \"trailer\"\npoint = [\"-d\", 0, 0]",
          "body  = \"cart\"\npoint = [\"-b - d\", 0, 0]");
  EXPECT_EQ(operations(specialised("trailer", "locked = { r1 = 0 }")),
            operations(read_model_text(text, "merged.toml")));
}

TEST(FrozenParameter, IsGoneFromTheProgram) {
  const Model model = specialised("soft_snakeboard", "frozen = \"all\"");
  const auto derivation = derive(model);
  EXPECT_TRUE(derivation->program.parameters.empty());
  const std::map<std::string, int> whole =
      operations(read_model(folder + "soft_snakeboard/soft_snakeboard.toml"));
  for (const auto& [function, count] : operations(model)) EXPECT_LE(count, whole.at(function)) << function;
}

}  // namespace
}  // namespace anholon::locked_joint_test
