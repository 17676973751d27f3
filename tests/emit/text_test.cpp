// SPDX-License-Identifier: GPL-2.0-or-later
// The small parts of emission: names, comments, constants, templates, hashes, files.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "emit/c_abi.hpp"
#include "emit/names.hpp"
#include "emit/pendulum_program.hpp"
#include "emit/provenance.hpp"
#include "emit/statements.hpp"
#include "emit/template.hpp"
#include "emit/toolbox.hpp"
#include "emit/write_file.hpp"

namespace anholon::text_test {
namespace {

TEST(Identifier, KeepsWhatIsSafeAndMendsTheRest) {
  EXPECT_EQ(identifier("r_p"), "r_p");
  EXPECT_EQ(identifier("M_00"), "M_00");
  EXPECT_EQ(identifier("front axle"), "front_axle");
  EXPECT_EQ(identifier("2nd"), "x_2nd");
  EXPECT_EQ(identifier("_Reserved"), "x_Reserved");
  EXPECT_EQ(identifier("a__b"), "a_b");
  EXPECT_EQ(identifier(""), "x_");
  EXPECT_EQ(identifier("\xC3\xA9tat"), "x_tat");
  for (const char* taken : {"class", "and", "sin", "Real", "par", "std", "NAN", "M_PI", "linux", "detail"}) {
    EXPECT_EQ(identifier(taken), std::string(taken) + "_");
  }
}

TEST(Identifier, OfANamespaceKeepsClearOfTheFunctionsOfC) {
  EXPECT_EQ(namespace_identifier("random"), "random_");
  EXPECT_EQ(namespace_identifier("link"), "link_");
  EXPECT_EQ(namespace_identifier("bicycle"), "bicycle");
}

TEST(NameScope, GivesEachNameOnce) {
  NameScope scope;
  EXPECT_EQ(scope.claim("q"), "q");
  EXPECT_EQ(scope.claim("q"), "q_2");
  EXPECT_EQ(scope.claim("q!"), "q_");
  EXPECT_EQ(scope.claim("class"), "class_");
  EXPECT_EQ(scope.claim("class"), "class_2");
}

TEST(Comment, WrapsAndNeverLeavesItsLines) {
  EXPECT_EQ(comment("one two three", "// ", 2, 10), "// one two\n//   three\n");
  EXPECT_EQ(comment("a\nb", "/// "), "/// a\n/// b\n");
  EXPECT_EQ(comment("", "// "), "//\n");
  EXPECT_EQ(comment("ends in \\", "// "), "// ends in\n");
  EXPECT_EQ(comment("a \\\nint evil;", "// "), "// a\n// int evil;\n");
  EXPECT_EQ(comment(std::string("a\rb\x01") + "c", "// "), "// a?b?c\n");
  EXPECT_EQ(comment("\xC2\xB0 \xE2\x80\xAE x", "// "), "// \xC2\xB0 ??? x\n") << "no change of direction";
  EXPECT_EQ(comment("\xFF\xC2", "// "), "// ??\n") << "no broken UTF-8";
}

TEST(ConstantText, HasTwentyOneDigitsAndIsAlwaysAFloatingLiteral) {
  EXPECT_EQ(constant_text(5), "constant<Real>(5.0L)");
  EXPECT_EQ(constant_text(Exact::ratio(-1, 3)), "constant<Real>(-0.333333333333333333333L)");
  EXPECT_EQ(constant_text(Exact::from_decimal("2e-9")), "constant<Real>(2e-9L)");
  EXPECT_EQ(constant_text(Exact::from_decimal("3e20")), "constant<Real>(3e20L)");
}

TEST(Template, ThrowsForAKeyThatNobodyGaveAndForBrokenText) {
  EXPECT_EQ(fill_template("a {{x}} <{{#l}}{{.}},{{/l}}>\n", {{"x", "&<b>"}, {"l", {"1", "2"}}}),
            "a &<b> <1,2,>\n");
  EXPECT_THROW((void)fill_template("{{missing}}", nlohmann::json::object()), std::logic_error);
  EXPECT_THROW((void)fill_template("{{#missing}}a{{/missing}}", nlohmann::json::object()), std::logic_error);
  EXPECT_THROW((void)fill_template("{{#open}}", {{"open", true}}), std::logic_error);
}

TEST(Sha256, IsThatOfTheStandard) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(WriteFile, ReplacesWholeFilesAndLeavesEqualOnesAlone) {
  const std::filesystem::path folder = test::test_folder();
  const std::filesystem::path file = folder / "new" / "a.txt";
  EXPECT_TRUE(write_file(file, "one"));
  EXPECT_EQ(test::read_text(file), "one");
  const auto old = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::filesystem::last_write_time(file, old);
  EXPECT_FALSE(write_file(file, "one"));
  EXPECT_EQ(std::filesystem::last_write_time(file), old);
  EXPECT_TRUE(write_file(file, "two"));
  EXPECT_EQ(test::read_text(file), "two");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file.parent_path()), {}), 1)
      << "no temporary stays";
  EXPECT_THROW(write_file(folder / "new", "a folder is there"), std::system_error);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(WriteFile, KeepsLinksAndDevices) {
  const std::filesystem::path folder = test::test_folder();
  const std::filesystem::path file = folder / "a.txt", link = folder / "link";
  write_file(file, "one");
  std::filesystem::create_symlink(file, link);
  EXPECT_TRUE(write_file(link, "two"));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(test::read_text(file), "two");
  EXPECT_TRUE(write_file("/dev/null", "gone"));
  EXPECT_FALSE(std::filesystem::is_regular_file("/dev/null"));
}

TEST(DescribeJson, ListsParametersFunctionsAndBlocks) {
  const auto data = nlohmann::json::parse(describe_json(test::cart_pendulum()));
  EXPECT_EQ(data["schema"], "anholon.program/1");
  EXPECT_EQ(data["parameters"].size(), 5U);
  EXPECT_EQ(data["parameters"][1]["digits"], "0.1");
  EXPECT_EQ(data["functions"].size(), 3U);
  EXPECT_EQ(data["functions"][1]["inputs"], (nlohmann::json{"r", "r_dot", "F"}));
  EXPECT_EQ(data["functions"][1]["outputs"][0]["rows"], 2);
  EXPECT_EQ(data["functions"][0]["operations"]["total"], 1);
  EXPECT_EQ(data["functions"][0]["operations_without_prepare"]["total"], 4);
}

}  // namespace
}  // namespace anholon::text_test
