// SPDX-License-Identifier: GPL-2.0-or-later
// Reading ends soon, with a model or a ModelError, whatever the bytes. The long run is tests/fuzz.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "describe/read_model.hpp"
#include "describe/specialise.hpp"

namespace anholon::mutation_test {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(std::filesystem::path(ANHOLON_SOURCE_DIR) / "models" / file).rdbuf();
  return text.str();
}

/// One to four changes of bytes, pieces and ends.
std::string mutated(std::string text, std::mt19937_64& rng) {
  static const std::vector<std::string> pieces = {"\"",     "'",
                                                  "{",      "}",
                                                  "[",      "]",
                                                  "[[",     "#",
                                                  "=",      ",",
                                                  "1e308",  "-",
                                                  "^",      "(",
                                                  ")",      "0",
                                                  "nan",    "inf",
                                                  "1e-4",   "r1",
                                                  "dot(",   "V_X",
                                                  "\n",     "\\u",
                                                  "\"\"\"", "\xff",
                                                  "true",   ".",
                                                  "e9",     "\t",
                                                  "pi",     "/0",
                                                  "^64",    "modes = 30\n",
                                                  "range",  "sqrt(",
                                                  "exp("};
  const std::size_t changes = 1 + rng() % 4;
  for (std::size_t i = 0; i < changes; ++i) {
    const std::size_t at = rng() % text.size();
    switch (rng() % 5) {
      case 0:
        text[at] = static_cast<char>(rng() % 256);
        break;
      case 1:
        text.erase(at, 1 + rng() % 20);
        break;
      case 2:
        text.insert(at, pieces[rng() % pieces.size()]);
        break;
      case 3:
        text.insert(at, text.substr(rng() % text.size(), rng() % 60));
        break;
      default:
        text.resize(std::max<std::size_t>(at, 1));
        break;
    }
    if (text.empty()) text = "x";
  }
  return text;
}

/// Reads mutants of good texts; returns how many were accepted.
template <class Read>
int read_mutants(const std::vector<std::string>& good, int samples, const Read& read) {
  std::mt19937_64 rng(20130922);  // fixed: a failure must be repeatable
  int accepted = 0;
  for (int sample = 0; sample < samples; ++sample) {
    const std::string text = mutated(good[rng() % good.size()], rng);
    try {
      read(text);
      ++accepted;
    } catch (const ModelError& error) {
      EXPECT_FALSE(error.diagnostics().empty());
    } catch (const std::exception& error) {
      ADD_FAILURE() << "sample " << sample << ": " << error.what() << "\n" << text;
    }
  }
  return accepted;
}

TEST(Mutation, OfGoodFilesEndsInAModelOrAModelError) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::string> good = {
      text_of("mobile_pendulum/mobile_pendulum.toml"), text_of("bicycle/bicycle.toml"),
      text_of("soft_snakeboard/soft_snakeboard.toml"), text_of("trailer/trailer.toml")};
  EXPECT_GT(read_mutants(good, 4000, [](const std::string& text) { read_model_text(text, "mutant.toml"); }),
            10);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  EXPECT_LT(time.count(), 240);  // measured: below 10 s
}

TEST(Mutation, OfGoodScenesEndsInASceneOrAModelError) {
  const std::filesystem::path path =
      std::filesystem::path(ANHOLON_SOURCE_DIR) / "models/soft_snakeboard/mutant.toml";
  const std::vector<std::string> good = {text_of("soft_snakeboard/gait.scene.toml"),
                                         text_of("soft_snakeboard/fixed_rotor.scene.toml"),
                                         text_of("soft_snakeboard/rigid_beams.scene.toml")};
  EXPECT_GT(read_mutants(good, 1000,
                         [&](const std::string& text) {
                           const Scene scene = read_scene_text(text, path);
                           specialise(scene.model, scene);
                         }),
            10);
}

TEST(Mutation, DeepAndLongFilesAreRefusedSoon) {
  const std::string head = "anholon = 1\nname = \"x\"\ngroup = \"SE3\"\n";
  const auto repeated = [](const std::string& piece, std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += piece;
    return text;
  };
  const std::vector<std::string> texts = {
      head + "gravity = " + repeated("[", 5000),
      head + "gravity = " + repeated("[\n", 100000),
      head + repeated("a.", 4000) + "b = 1\n",
      head + "[" + repeated("a.", 250) + "b]\n" + repeated("c.", 250) + "d = 1\n",
      head + "potential = \"" + repeated("(", 4000) + "\"\n",
      head + "potential = \"\"\"" + repeated("(1+\n", 100000) + "\"\"\"\n",
      head + repeated("[[body]]\nname = \"b\"\n", 30000),
      head + "[parameters]\n" + repeated("a = { value = 1, unit = \"m\" }\n", 20000),
      repeated("#", 2000000),
  };
  for (const std::string& text : texts) EXPECT_THROW(read_model_text(text, "large.toml"), ModelError);
  std::string many = head + "[[body]]\nname = \"b\"\n";
  for (int i = 0; i < 900; ++i)
    many += "[[body]]\nname = \"b" + std::to_string(i) +
            "\"\nparent = \"b\"\njoint = { kind = \"revolute\", axis = [1, 2, " + std::to_string(i) +
            "], coordinate = \"q" + std::to_string(i) + "\" }\n";
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(read_model_text(many, "many.toml").coordinates.size(), 900U);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  EXPECT_LT(time.count(), 60);
}

}  // namespace
}  // namespace anholon::mutation_test
