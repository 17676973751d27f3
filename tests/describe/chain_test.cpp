// SPDX-License-Identifier: GPL-2.0-or-later
// Chains of links with springs: which bodies they are written out as, and what is refused of them.
#include <gtest/gtest.h>

#include <algorithm>

#include "describe/read_model.hpp"

namespace anholon::chain_test {
namespace {

const std::string arm = R"(anholon = 1
name = "arm"
group = "SE3"
[[body]]
name = "base"
inertia = { mass = 1, about_com = { xx = 1, yy = 1, zz = 1 } }
[[body]]
name = "tail"
parent = "base"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "a" }
chain = { length = 0.6, mass_per_length = 2, bending_stiffness = 0.9, segments = 3, material_damping = 0.01 }
[[body]]
name = "hand"
parent = "tail"
joint = { kind = "fixed" }
inertia = { mass = 0.1 }
)";

TEST(Chain, IsWrittenOutAsLinksWithSprings) {
  const Model model = read_model_text(arm, "arm.toml");
  std::vector<std::string> names, parents;
  Exact mass = 0, length = 0;
  for (const BodyDescription& body : model.bodies) {
    names.push_back(body.name);
    parents.push_back(body.parent < 0 ? "" : model.bodies[static_cast<std::size_t>(body.parent)].name);
    if (!body.name.starts_with("tail")) continue;
    mass += body.mass.constant_value().value();
    length += body.p[0].constant_value().value();
  }
  EXPECT_EQ(names, (std::vector<std::string>{"base", "tail", "tail_0", "tail_1", "tail_2", "tail_3",
                                             "tail_end", "hand"}));
  EXPECT_EQ(parents, (std::vector<std::string>{"", "base", "tail", "tail_0", "tail_1", "tail_2", "tail_3",
                                               "tail_end"}));
  EXPECT_EQ(mass, Exact::from_decimal("1.2"));
  EXPECT_EQ(length, Exact::from_decimal("0.6"));  // from the root to the tip
  ASSERT_EQ(model.coordinates.size(), 4U);
  EXPECT_EQ(model.coordinates[1].name, "tail_q1");
  EXPECT_EQ(model.coordinates[3].name, "tail_q3");
  const BodyDescription& link = model.bodies[4];  // a whole segment: m = 0.4, h = 0.2, m h^2/12
  EXPECT_EQ(link.mass.constant_value(), Exact::from_decimal("0.4"));
  EXPECT_EQ(link.p[0].constant_value(), Exact::from_decimal("0.2"));
}

TEST(Chain, TakesItsNumbersFromCountsAndItsNamesFromKeys) {
  std::string text = arm;
  text.replace(text.find("segments = 3"), 12, "segments = \"{2*N}\", coordinate = \"q\", plane = \"z\"");
  text.insert(text.find("[[body]]"), "counts = { N = { value = 4, range = [2, 9] } }\n");
  const Model model = read_model_text(text, "arm.toml");
  EXPECT_EQ(model.bodies.size(), 3U + 8 + 2);
  EXPECT_EQ(model.coordinates.back().name, "q8");
}

/// The arm with something else in it, and the message that it gets.
std::string message(const std::string& from, const std::string& to) {
  std::string text = arm;
  text.replace(text.find(from), from.size(), to);
  try {
    read_model_text(text, "arm.toml");
    return "accepted";
  } catch (const ModelError& error) {
    return error.what();
  }
}

TEST(Chain, RefusesWhatItCannotCutOnceForAllLinks) {
  EXPECT_EQ(message("segments = 3", "segments = 2.5"),
            "arm.toml:11:82: error: the chain of body 'tail' has no number of segments; write a whole number "
            "from 1 "
            "to 200");
  EXPECT_EQ(message(", segments = 3", ""),
            "arm.toml:11:9: error: the chain of body 'tail' has no 'segments'; write how many: segments = 8");
  EXPECT_NE(message("segments = 3", "segments = 3, modes = 2")
                .find("unknown key 'modes' in the chain of body 'tail'"),
            std::string::npos);
  EXPECT_EQ(message("length = 0.6", "length = \"Q\"").substr(0, 24), "arm.toml:11:21: error: '");
  EXPECT_EQ(std::ranges::count(message("length = 0.6", "length = \"Q\""), '\n'), 0);
  EXPECT_EQ(
      message("chain = {", "beam = { length = 1, mass_per_length = 1, bending_stiffness = 1 }\nchain = {"),
      "arm.toml:11:8: error: body 'tail' has a chain and a beam; keep one");
}

TEST(Chain, ChecksTheUnitsOfItsParameters) {
  std::string text = arm;
  text.insert(text.find("[[body]]"), "parameters = { L = { value = 1, unit = \"kg\" } }\n");
  text.replace(text.find("length = 0.6"), 12, "length = \"L\"");
  try {
    read_model_text(text, "arm.toml");
    FAIL() << "the unit was accepted";
  } catch (const ModelError& error) {
    EXPECT_EQ(std::string(error.what()),
              "arm.toml:12:20: error: the length of the chain of body 'tail' has the unit kg, but needs m; "
              "check the "
              "expression and the units of its parameters");
  }
}

}  // namespace
}  // namespace anholon::chain_test
