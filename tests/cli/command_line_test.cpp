// SPDX-License-Identifier: GPL-2.0-or-later
// What the program says, and its exit status, where a command asks for something that cannot be.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "cli/commands.hpp"

namespace anholon::cli {
namespace {

namespace fs = std::filesystem;

struct Answer {
  int status;
  std::string text;  // of both streams
};

Answer run(const std::string& arguments, const std::string& variables) {
  const std::string command = "(cd '" ANHOLON_SOURCE_DIR "' && " + variables +
                              "'" ANHOLON_BINARY_DIR "/generator/anholon' " + arguments + ") 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  Answer answer{-1, ""};
  if (pipe == nullptr) return answer;
  std::array<char, 4096> part{};
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe))
    answer.text.append(part.data(), n);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) answer.status = WEXITSTATUS(status);
  return answer;
}

void expect(const std::string& arguments, int status, const std::string& text,
            const std::string& variables = "") {
  const Answer answer = run(arguments, variables);
  EXPECT_EQ(answer.status, status) << arguments << "\n" << answer.text;
  EXPECT_NE(answer.text.find(text), std::string::npos) << arguments << "\n" << answer.text;
}

const std::string pendulum = "models/mobile_pendulum/mobile_pendulum.toml";
const std::string bicycle = "models/bicycle/bicycle.toml";
const std::string weave = "models/bicycle/weave.scene.toml";

TEST(CommandLine, HelpsWithoutDoingAnything) {
  expect("--help", ok, "generate");
  for (const char* verb : {"check", "generate", "explain", "evaluate", "verify", "simulate", "report"})
    expect(std::string(verb) + " --help", ok, "-h,--help");
}

TEST(CommandLine, RefusesWhatItDoesNotKnow) {
  expect("", usage, "subcommand is required");
  expect("chek " + pendulum, usage, "there is no 'chek'; did you mean 'check'? choose from check, generate,");
  expect("check " + pendulum + " --jsn", usage, "--jsn");
  expect("verify " + pendulum + " --samples 0", usage, "--samples");
  expect("generate " + pendulum + " --functions kinematcs -o /dev/null/x", usage,
         "there is no function 'kinematcs'");
  expect("check " + bicycle + " --inverse leading:9", usage, "rows are whole numbers from 1 to");
  expect("check " + pendulum + " --gravity 1.62", usage, "are for a robot file");
  expect("check bench/free_chain.urdf --gravity heavy", usage,
         "--gravity is 'heavy', not a decimal number in m/s^2");
  expect("check " + pendulum + " --count N=many", usage, "--count is 'N=many', not NAME=NUMBER");
}

TEST(CommandLine, EvaluatesNoFunctionThatThereIsNot) {
  const std::string states = " tests/reference/A_mobile_pendulum.json --with recursion --functions ";
  expect("evaluate " + pendulum + states + "nosuch", usage, "there is no function 'nosuch'");
}

TEST(CommandLine, NamesTheFileThatIsWrong) {
  expect("check nowhere.toml", bad_input, "nowhere.toml");
  expect("check models", bad_input, "models: error: the file cannot be read");
  expect("check " + pendulum + " --scene " + weave, bad_input, "the scene is one of");
  expect("simulate " + pendulum, bad_input, pendulum);
  expect("evaluate " + pendulum + " README.md --with recursion", bad_input, "README.md:1:1: error: ");
}

TEST(CommandLine, SaysWhereItCannotWrite) {
  expect("check " + pendulum + " > /dev/full", environment, "cannot write standard output");
  expect("explain " + pendulum + " -o /dev/null/equations.md", environment, "[/dev/null");
  expect("generate " + pendulum + " --functions kinematics -o /dev/null/x", environment, "[/dev/null");
}

TEST(CommandLine, SaysWhichCompilerIsNotThere) {
  expect("verify " + pendulum + " --samples 1", environment, "no-such-compiler", "CXX=no-such-compiler ");
}

TEST(Depfile, IsARuleOfMakeWithAllThatWasRead) {
  const fs::path folder = fs::path(testing::TempDir()) / "anholon depfile";
  fs::create_directories(folder);
  const std::string header = (folder / "weave.hpp").string(), rule = (folder / "weave.d").string();
  expect("generate " + weave + " --functions kinematics -o '" + header + "' --depfile '" + rule + "'", ok,
         "wrote");
  std::ifstream stream(rule);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const auto escaped = [](std::string path) {
    for (std::size_t at = 0; (at = path.find(' ', at)) != std::string::npos; at += 2) path.insert(at, "\\");
    return path;
  };
  EXPECT_EQ(text, escaped(header) + ": \\\n  " + escaped(ANHOLON_SOURCE_DIR "/" + bicycle) + " \\\n  " +
                      escaped(ANHOLON_SOURCE_DIR "/" + weave) + "\n");
  fs::remove_all(folder);
}

}  // namespace
}  // namespace anholon::cli
