// SPDX-License-Identifier: GPL-2.0-or-later

// GiNaC orders by address, and addresses change from process to process. This program is therefore run again
// and again, and must write the same text each time.

#include <ginac/ginac.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "algebra/closed_form.hpp"
#include "algebra/kernel_core.hpp"
#include "algebra/latex.hpp"
#include "algebra/tape_samples.hpp"

namespace anholon::determinism_test {
namespace {

using test::input;
using test::text;

constexpr const char* begin_mark = "<<<algebra\n";
constexpr const char* end_mark = "algebra>>>\n";

/// Everything of this folder that passes through GiNaC, as text.
std::string everything(unsigned symbols_made_before) {
  std::vector<GiNaC::symbol> others(symbols_made_before);
  std::string result;
  const auto add = [&result](const Tape& tape, const std::vector<NodeId>& ids) {
    for (const NodeId id : ids) result += text(tape, id) + "\n";
  };
  Tape tape;
  const Expr a = input(tape, "a"), b = input(tape, "b"), c = input(tape, "c"), d = input(tape, "d");
  const Expr x = input(tape, "x"), y = input(tape, "y");
  const Expr energy = (a * cos(x) + b * sin(x)) * (a * cos(x) + b * sin(x)) * c +
                      (b - a) * (d - c) * sin(x + y) +
                      (a * a - b * b) / (a - b) * sqrt(c * d + sin(y) * sin(y));
  const std::vector<NodeId> roots{energy.id(tape), (energy * (c - d) / (a * cos(x))).id(tape)};
  if (const auto form = closed_form(tape, roots)) add(tape, *form);
  const LatexText latex = latex_text(tape, {roots});
  result += latex.formula + "\n";
  for (const std::string& definition : latex.definitions) result += definition + "\n";

  const auto A = test::matrix(tape, {{a * cos(x), b - c, sin(y), d, 0},
                                     {c, a * sin(x), (b - d) * cos(y), 0, d},
                                     {b, 1, cos(x), cos(y), sin(x + y)}});
  const auto B = test::matrix(tape, {{a, 0}, {0, b - d}, {sin(x), cos(y)}});
  const auto core = kernel_core(tape, A, B, {1, 3});
  if (core) {
    add(tape, test::entries(core->H));
    add(tape, test::entries(core->J));
  }
  return result;
}

/// Run by the test below, in processes of its own.
TEST(Determinism, DISABLED_WritesItsText) {
  const char* count = std::getenv("ANHOLON_TEST_SYMBOLS");
  std::fputs(begin_mark, stdout);
  std::fputs(everything(count == nullptr ? 0 : static_cast<unsigned>(std::atoi(count))).c_str(), stdout);
  std::fputs(end_mark, stdout);
}

std::string text_of_another_process(unsigned symbols_made_before) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command =
      "ANHOLON_TEST_SYMBOLS=" + std::to_string(symbols_made_before) + " '" + self +
      "' --gtest_also_run_disabled_tests --gtest_filter=Determinism.DISABLED_WritesItsText";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string output;
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe.get())) output.append(buffer, n);
  const std::size_t begin = output.find(begin_mark);
  const std::size_t end = output.find(end_mark);
  if (begin == std::string::npos || end == std::string::npos) return {};
  return output.substr(begin, end - begin);
}

TEST(Determinism, TwentyProcessesWriteTheSameText) {
  const std::string first = text_of_another_process(0);
  ASSERT_GT(first.size(), 1000U);
  for (unsigned run = 1; run < 20; ++run) EXPECT_EQ(text_of_another_process(run % 5), first) << "run " << run;
}

}  // namespace
}  // namespace anholon::determinism_test
