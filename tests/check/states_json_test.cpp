// SPDX-License-Identifier: GPL-2.0-or-later
// Files of states that cannot be used say so with their path.
#include "check/states_json.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "describe/read_model.hpp"
#include "reduce/samples.hpp"

namespace anholon::states_json_test {
namespace {

const std::string body = R"(anholon = 1
name = "body"
group = "SE3"
[[body]]
name = "base"
inertia = { mass = 2, about_com = { xx = 1, yy = 1, zz = 1 } }
)";

std::string message(const std::string& R) {
  const Model model = read_model_text(body, "body.toml");
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "states.json";
  std::ofstream(file) << R"({"coordinates": {}, "states": [{"label": "a", "inputs": {"g": {"R": )" << R
                      << R"(, "p": [0, 0, 0]}, "eta": [0, 0, 0, 0, 0, 0]}}]})";
  try {
    read_states(file, model);
    return "accepted";
  } catch (const ModelError& error) {
    const std::string text = error.what(), path = file.string();
    return text.starts_with(path) ? text.substr(path.size()) : text;
  }
}

TEST(States, AreRefusedWithTheirFile) {
  EXPECT_EQ(message("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"), "accepted");
  const std::string no_rotation =
      ": error: state 'a': g.R is not a rotation; its rows must be orthonormal to 1e-9, its determinant 1";
  EXPECT_EQ(message("[[2, 0, 0], [0, 1, 0], [0, 0, 1]]"), no_rotation);
  EXPECT_EQ(message("[[1, 0, 0], [0, 1, 0], [0, 0, -1]]"), no_rotation);
  EXPECT_TRUE(message("[[1e999, 0, 0], [0, 1, 0], [0, 0, 1]]")
                  .starts_with(": error: has a number that no double holds: "));
}

/// Rank, conditioning and errors are judged at random states; what depends on time would show nothing at t = 0.
TEST(RandomStates, HaveATimeWhereTheModelReadsIt) {
  const std::string force = "[[force]]\ncomponent = \"V_X\"\nforce = \"5*sin(2*t)\"\n";
  SampleSource one, other;
  EXPECT_TRUE(random_state(read_model_text(body, "body.toml"), one).t.is_zero());
  const Model model = read_model_text(body + force, "body.toml");
  EXPECT_GT(random_state(model, other).t, Exact(0));
}

}  // namespace
}  // namespace anholon::states_json_test
