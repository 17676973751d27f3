// SPDX-License-Identifier: GPL-2.0-or-later
// What verification lets pass: an error beyond the bound needs the condition of the output as a reason.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "check/output_record.hpp"
#include "check/relative_condition.hpp"
#include "optimise/accuracy/rounding_shares.hpp"
#include "tape/interpret.hpp"

namespace anholon::judgement_test {
namespace {

constexpr double bound = 50 * eps;

/// Outputs of size one with these errors in ulps.
OutputRecord record_of(const std::vector<double>& ulps) {
  OutputRecord record;
  for (const double x : ulps) {
    record.error.push_back(x * eps);
    record.scale.push_back(1);
    record.sample.push_back(static_cast<int>(record.sample.size()) + 1);
  }
  return record;
}

struct Judge {
  std::vector<double> estimated, measured;  // kappa of each sample
  std::vector<int> asked;                   // samples whose condition was measured
  OutputError operator()(const std::vector<double>& ulps) {
    asked.clear();
    const auto at = [](const std::vector<double>& kappa, int sample) {
      return kappa[static_cast<std::size_t>(sample - 1)];
    };
    return judged(record_of(ulps), bound,
                  {[&](int sample, double) { return at(estimated, sample); },
                   [&](int sample, double, double) {
                     asked.push_back(sample);
                     return at(measured, sample);
                   }});
  }
};

TEST(Judgement, NeedsNoReasonWithinTheBound) {
  Judge judge;
  const OutputError e = judge({3, 49, 1});
  EXPECT_TRUE(e.passed);
  EXPECT_EQ(e.worst, 49 * eps);
  EXPECT_EQ(e.worst_at, "sample 2");
  EXPECT_TRUE(judge.asked.empty());
}

TEST(Judgement, MeasuresTheConditionOfTheWorstAndWhereTheEstimateIsClose) {
  Judge judge{{1000, 1000, 9, 1000}, {900, 1000, 11, 1000}, {}};
  const OutputError e = judge({200, 80, 100, 2});
  EXPECT_TRUE(e.passed);
  EXPECT_EQ(e.condition, 900) << "of the worst";
  EXPECT_EQ(judge.asked, (std::vector{1, 3}));
}

TEST(Judgement, RefusesWhatTheConditionDoesNotExcuse) {
  Judge judge{{1000, 1, 1}, {900, 2, 3}, {}};
  const OutputError e = judge({200, 80, 90});
  EXPECT_FALSE(e.passed);
  EXPECT_EQ(e.failed_at, "sample 2: 80.0 ulps, kappa 2.0e+00");
}

TEST(Judgement, RefusesWhatIsNoNumber) {
  Judge judge{{1, 1}, {1, 1}, {}};
  const OutputError e = judge({std::nan(""), 1});
  EXPECT_FALSE(e.passed);
  EXPECT_EQ(e.worst_at, "sample 1");
}

TEST(Condition, ToFirstOrderIsTheOneThatIsMeasured) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const OutputBlock block{"z", "", "", 2, 1, {(sin(x) / y - x * y).id(tape), (x * x - y * sqrt(y)).id(tape)}};
  const WorkingDigits precision(60);
  for (const auto& [at_x, at_y] : {std::pair{0.7, 1.3}, std::pair{2.0, 1.5874}, std::pair{0.1, 1e-5}}) {
    constexpr double scale = 0.25;
    const double measured = relative_condition(
        [&](const NamedValues<Exact>& in) {
          return interpret<Exact>(tape, block.nodes, std::vector{in.at("x")[0], in.at("y")[0]});
        },
        {{"x", {Exact::from_double(at_x)}}, {"y", {Exact::from_double(at_y)}}}, scale);
    EXPECT_NEAR(first_order_condition(tape, block, {at_x, at_y}, scale), measured, 1e-9 * measured)
        << "second order, and what double loses of a derivative";
  }
}

}  // namespace
}  // namespace anholon::judgement_test
