// SPDX-License-Identifier: GPL-2.0-or-later
// Counts and repetitions of a description, and what is refused of them.
#include <gtest/gtest.h>

#include "describe/read_model.hpp"

namespace anholon::repetition_test {
namespace {

const std::string chain = R"(anholon = 1
name = "chain"
group = "SE2"
counts = { N = { value = 4, range = [2, 9] } }
[[body]]
name = "b_1"
inertia = { mass = 1, about_com = { zz = 1 } }
[[body]]
repeat = "i = 2..N"
name = "b_{i}"
parent = "b_{i - 1}"
pose = { translation = ["{2*i}/10", 0, 0] }
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r{i-1}" }
inertia = { mass = "{i}", about_com = { zz = 1 } }
[[constraint]]
kind = "no_lateral_slip"
body = "b_{N}"
)";

TEST(Repetition, WritesOutBodiesWithTheirNumbers) {
  const Model model = read_model_text(chain, "chain.toml");
  ASSERT_EQ(model.bodies.size(), 4U);
  EXPECT_EQ(model.bodies[3].name, "b_4");
  EXPECT_EQ(model.bodies[3].parent, 2);
  EXPECT_EQ(model.bodies[3].p[0].constant_value(), Exact::ratio(8, 10));
  EXPECT_EQ(model.bodies[2].mass.constant_value(), Exact(3));
  EXPECT_EQ(model.coordinates.back().name, "r3");
  EXPECT_EQ(model.rows[0].name, "no_lateral_slip_b_4");
  EXPECT_EQ(read_model_text(chain, "chain.toml", {}, {{"N", 7}}).bodies.size(), 7U);
}

/// The chain with something else in it, and the message that it gets.
std::string message(const std::string& from, const std::string& to, const CountValues& counts = {}) {
  std::string text = chain;
  text.replace(text.find(from), from.size(), to);
  try {
    read_model_text(text, "chain.toml", {}, counts);
    return "accepted";
  } catch (const ModelError& error) {
    return error.what();
  }
}

TEST(Repetition, RefusesWhatItCannotCount) {
  EXPECT_EQ(message("N = {", "N = {", {{"N", 12}}),
            "chain.toml:4:26: error: the count 'N' is 12; take a number from 2 to 9");
  EXPECT_EQ(message("N = {", "N = {", {{"M", 3}}),
            "chain.toml:4:10: error: the description has no count 'M'; there are N");
  EXPECT_EQ(message("\"i = 2..N\"", "\"i = 2\""),
            "chain.toml:9:10: error: the repetition does not say what runs; write repeat = \"i = 1..N\"");
  EXPECT_EQ(message("b_{N}", "b_{K}"),
            "chain.toml:17:8: error: 'K' is not a count; use the numbers of [counts] and of repeat = \"i = "
            "1..N\": N");
  EXPECT_EQ(message("2..N", "2..5000"),
            "chain.toml:9:10: error: the repetition makes more than 1000 copies; take a smaller range");
  EXPECT_EQ(message("b_{i - 1}", "b_{i - 2}"),
            "chain.toml:11:10: error: body 'b_2' has parent 'b_0', which is not a body; did you mean 'b_1'?");
}

TEST(Repetition, RefusesWhatHasNoBounds) {
  EXPECT_EQ(message("{2*i}", "{" + std::string(5000, '-') + "1}"),
            "chain.toml:12:25: error: a number is nested deeper than 50; use the numbers of [counts] and of "
            "repeat = \"i = 1..N\": N and i");
  std::string many = "1";
  for (int k = 0; k < 60; ++k) many += "+(1)";  // beside each other, not nested
  EXPECT_EQ(message("{2*i}", "{" + many + "}"), "accepted");
  EXPECT_EQ(message("{2*i}", "{1000000}"), "accepted");
  EXPECT_TRUE(message("counts = { N = { value = 4, range = [2, 9] } }", "counts = 5")
                  .starts_with("chain.toml:4:10: error: counts is a number; write a table [counts]"));
}

TEST(Repetition, RefusesCopiesOfCopiesWithoutEnd) {
  std::string text =
      "anholon = 1\nname = \"chain\"\nx = [{ repeat = \"i = 1..900\", y = [{ repeat = \"j = "
      "1..900\", z = [{ repeat = \"k = 1..900\", n = 1 }] }] }]\n";
  try {
    read_model_text(text, "copies.toml");
    FAIL() << "accepted";
  } catch (const ModelError& error) {
    EXPECT_NE(std::string(error.what()).find("the repetitions make more than 20000 copies"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace anholon::repetition_test
