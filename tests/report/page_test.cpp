// SPDX-License-Identifier: GPL-2.0-or-later
// The page of a report, made of records written by hand, and the times that go into them.
#include "report/page.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "emit/pendulum_program.hpp"
#include "report/timing.hpp"

namespace anholon::page_test {
namespace {

using nlohmann::ordered_json;

ordered_json point(const char* code, double tolerance, double error, double seconds,
                   const char* status = "ok") {
  return {{"code", code},           {"tolerance", tolerance}, {"error", error},
          {"cpu_seconds", seconds}, {"evaluations", 100},     {"status", status}};
}

/// Errors that fall as the fourth power of the time; the recursion takes ten times as long.
ordered_json motion() {
  ordered_json points = ordered_json::array();
  for (int k = 2; k <= 10; k += 2) {
    const double seconds = std::pow(10.0, k / 4.0);
    points.push_back(point("generated", std::pow(10.0, -k), std::pow(10.0, -k), seconds));
    points.push_back(point("recursion", std::pow(10.0, -k), std::pow(10.0, -k), 10 * seconds));
  }
  points.push_back(point("recursion", 1e-12, 0, 0, "step too small"));
  return {{"schema", "anholon.report.motion/1"},
          {"model", "swing"},
          {"scene", "fast<1>"},
          {"title", ""},
          {"duration_s", 1},
          {"ladder",
           {{"reference", {{"method", "m"}, {"steps", 64}, {"own_error", 1e-19}}}, {"points", points}}}};
}

ordered_json report() {
  const ordered_json time = {{"median", 20.0}, {"least", 19.0}, {"spread", 1.0}};
  const ordered_json function = {
      {"function", "forward_dynamics"},
      {"operations", {{"total", 12}, {"sines_and_cosines", 2}}},
      {"operations_without_prepare", 20},
      {"ns_double", time},
      {"ns_float", time},
      {"ns_double_batch_sines", time},
      {"routes", {{{"route", "dear"}, {"operations", 99}, {"kept", false}}}},
      {"passes",
       {{{"after", "as derived"}, {"operations", 15}, {"median_ulps", 0.4}, {"worst_ulps", 2.5}},
        {{"after", "nothing new"}, {"operations", 15}, {"median_ulps", 0.4}, {"worst_ulps", 2.5}},
        {{"after", "common factors"}, {"operations", 12}, {"median_ulps", 0.4}, {"worst_ulps", 321.0}}}},
      {"modes",
       {{{"mode", "speed"}, {"operations", 12}, {"median_ulps", 0.4}, {"worst_ulps", 321.0}},
        {{"mode", "accuracy"}, {"operations", 17}, {"median_ulps", 0.25}, {"worst_ulps", 1.5}}}},
      {"errors",
       {{{"output", "nu_dot"},
         {"median_ulps", 0.3},
         {"p99_ulps", 1.0},
         {"worst_ulps", 7.25},
         {"passed", false}}}}};
  const ordered_json model = {
      {"model", "swing"},
      {"title", "A swing & its <seat>"},
      {"sizes", {{"bodies", 2}, {"coordinates", 1}}},
      {"table_I", "free"},
      {"generation_s", 0.5},
      {"header_bytes", 1000},
      {"compile_s", 0.25},
      {"object_bytes", 2000},
      {"verification",
       {{"samples", 5}, {"formulas_worst", 1e-70}, {"energy_balance", 1e-16}, {"passed", false}}},
      {"functions", {function}}};
  return {{"machine", {{"processor", "P"}, {"compiler", "C"}, {"flags", {"-O2"}}, {"anholon", "0"}}},
          {"states", 10},
          {"models", {model}},
          {"motions", {motion()}}};
}

TEST(ReportPage, InterpolatesTimesBetweenThePointsOfALadder) {
  // Between 1e-4 and 1e-6 the time is error^(-1/4), a straight line in logarithms: exact but for rounding.
  EXPECT_NEAR(cpu_seconds_at(motion(), "generated", 1e-5), std::pow(10.0, 1.25), 1e-12);
  EXPECT_NEAR(cpu_seconds_at(motion(), "recursion", 1e-6), 10 * std::pow(10.0, 1.5), 1e-12);
  EXPECT_EQ(cpu_seconds_at(motion(), "generated", 0.5), std::pow(10.0, 0.5)) << "the cheapest that there is";
  EXPECT_TRUE(std::isnan(cpu_seconds_at(motion(), "recursion", 1e-11)))
      << "a run that failed reaches nothing";
}

TEST(ReportPage, StandsAloneAndShowsWhatFailed) {
  const std::string page = report_page(report());
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_NE(page.find("A swing &amp; its &lt;seat&gt;"), std::string::npos) << "titles are text, not markup";
  EXPECT_NE(page.find("<span class=\"failed\">FAILED</span>"), std::string::npos);
  EXPECT_NE(page.find("<td class=\"failed\">7.25</td>"), std::string::npos);
  EXPECT_NE(page.find("recursion at tolerance 1e-12: step too small"), std::string::npos);
  EXPECT_NE(page.find("<td>10.0</td><td>10.0</td>"), std::string::npos) << "ratio at equal error";
  std::size_t plots = 0;
  for (std::size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1)) ++plots;
  EXPECT_EQ(plots, 4U)
      << "all functions; operations against digits; error against time and evaluations of the motion";
  EXPECT_NE(page.find("<td>12</td><td>0.4</td><td>321</td><td>17</td><td>0.25</td><td>1.5</td>"),
            std::string::npos)
      << "the aims of the optimiser side by side";
  EXPECT_NE(page.find("<td class=\"text\">common factors</td><td>12</td>"), std::string::npos);
  EXPECT_EQ(page.find("nothing new"), std::string::npos) << "a pass that changes nothing";
}

TEST(ReportTiming, TimesEachFunctionForDoubleAndFloat) {
  const Program program = test::cart_pendulum();
  std::size_t stride = 0;
  for (const InputBlock& block : program.inputs) stride += block.nodes.size();
  const std::vector<double> states(stride * 16, 0.25);
  const auto times = time_functions(program, states, 3);
  ASSERT_EQ(times.size(), program.functions.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(times[i].function, program.functions[i].name);
    for (const CallTime& t : {times[i].by_double, times[i].by_float}) {
      EXPECT_GT(t.least, 0);
      EXPECT_GE(t.median, t.least);
      EXPECT_GE(t.spread, 0);
    }
  }
}

}  // namespace
}  // namespace anholon::page_test
