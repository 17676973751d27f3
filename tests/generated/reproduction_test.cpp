// SPDX-License-Identifier: GPL-2.0-or-later
// The checked-in sources of the models, and the equations on their pages, are what the generator writes
// today, byte for byte.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "derive/derive.hpp"
#include "derive/tree_functions.hpp"
#include "describe/read_model.hpp"
#include "describe/read_robot.hpp"
#include "emit/equations.hpp"
#include "emit/header.hpp"

namespace anholon::reproduction_test {
namespace {

namespace fs = std::filesystem;

const fs::path root = ANHOLON_SOURCE_DIR;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// First line in which two texts differ, for the message.
std::string first_difference(const std::string& a, const std::string& b) {
  std::istringstream x(a), y(b);
  std::string p, q;
  for (int line = 1;; ++line) {
    const bool more_a = static_cast<bool>(std::getline(x, p)), more_b = static_cast<bool>(std::getline(y, q));
    if (!more_a && !more_b) return "none";
    if (more_a != more_b || p != q) return fmt::format("line {}\n- {}\n+ {}", line, p, q);
  }
}

std::vector<std::string> names_of_model_files() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(root / "models")) {
    const std::string name = entry.path().filename().string();
    if (fs::exists(entry.path() / (name + ".toml"))) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(root / "models")) {
    const std::string name = entry.path().filename().string();
    if (fs::exists(entry.path() / (name + ".toml")) || fs::exists(entry.path() / (name + ".urdf")))
      names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Functions that a large model ships; of the others, all.
std::vector<std::string> shipped_functions(const std::string& name) {
  if (name == "humanoid") return {"inverse_dynamics", "gravity_forces"};
  if (name == "quadruped_stance")
    return {"torque_driven_kinematics", "torque_driven_velocities", "torque_driven_dynamics"};
  return {};
}

/// What `generate` writes of a model, as scripts/regenerate calls it.
std::string generated_text(const std::string& name) {
  const fs::path urdf = root / "models" / name / (name + ".urdf");
  if (!fs::exists(urdf)) {
    DeriveRequest request;
    request.functions = shipped_functions(name);
    return emit_header(derive(read_model(root / "models" / name / (name + ".toml")), request)->program);
  }
  RobotOptions options;
  options.floating = name != "arm7";
  TreeRequest request;
  request.functions = shipped_functions(name);
  return emit_header(derive_tree(read_robot(urdf, options), request)->program);
}

class EveryModel : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryModel, IsReproducedByteForByte) {
  const fs::path kept = root / "generated" / GetParam() / "standard.hpp";
  ASSERT_TRUE(fs::exists(kept)) << "run scripts/regenerate";
  const std::string expected = bytes_of(kept);
  const std::string text = generated_text(GetParam());
  EXPECT_TRUE(text == expected)
      << "generated code changed at " << first_difference(expected, text)
      << "\nif this is meant, run scripts/regenerate and commit the result with its cause";
  EXPECT_TRUE(text == generated_text(GetParam())) << "two derivations in one process differ";
}

/// Models that are described by a model file: their pages show equations, which those of URDF files do not.
class EveryModelFile : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryModelFile, ShowsItsEquationsOnItsPage) {
  const std::string page = bytes_of(root / "models" / GetParam() / "README.md");
  const std::string begin = "<!-- equations, written by scripts/regenerate: do not edit -->\n\n";
  const std::string end = "\n<!-- end of equations -->\n";
  const std::size_t from = page.find(begin), to = page.find(end);
  ASSERT_NE(from, std::string::npos) << "the page has no place for equations";
  ASSERT_NE(to, std::string::npos);
  const std::string shown = page.substr(from + begin.size(), to - from - begin.size());
  const Model model = read_model(root / "models" / GetParam() / (GetParam() + ".toml"));
  DeriveRequest request;
  request.functions = equation_functions();
  EquationStyle style;
  style.brief = true;
  style.heading = "###";
  const std::string expected = equations(model, *derive(model, request), style);
  EXPECT_TRUE(shown == expected) << "equations changed at " << first_difference(shown, expected)
                                 << "\nif this is meant, run scripts/regenerate and commit the result";
}

INSTANTIATE_TEST_SUITE_P(Models, EveryModel, ::testing::ValuesIn(model_names()));
INSTANTIATE_TEST_SUITE_P(Models, EveryModelFile, ::testing::ValuesIn(names_of_model_files()));

}  // namespace
}  // namespace anholon::reproduction_test
