// SPDX-License-Identifier: GPL-2.0-or-later
// Compensated operations: the same numbers, without the digits that rounding takes.

#include "optimise/accuracy/compensation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "derive/derive.hpp"
#include "describe/read_model.hpp"
#include "optimise/accuracy/rounding_shares.hpp"
#include "optimise/accuracy/variants.hpp"
#include "tape/interpret.hpp"

namespace anholon::compensation_test {
namespace {

OutputBlock output(const std::vector<NodeId>& nodes) {
  return {"y", "", "", static_cast<int>(nodes.size()), 1, nodes};
}

/// (x - 1)^5 written out, by Horner's rule.
Expr expanded_power(const Expr& x) {
  Expr y = x - Expr(5);
  for (const int c : {10, -10, 5, -1}) y = y * x + Expr(c);
  return y;
}

TEST(RoundingShares, AreHalfAnUlpOfTheNodeTimesTheDerivative) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y")), z(tape, tape.input("z"));
  const Expr product = x * y, difference = product - z, unused = x + z;
  const RoundingShares shares =
      rounding_shares(tape, {output({difference.id(tape)})}, {{3, 5, 14}, {3, 5, 14.75}, {3, 5, 14}});
  // at the second state the difference is 1/4, but the median state sets the scale: 1
  EXPECT_DOUBLE_EQ(shares.of_node[product.id(tape)], 15.0 / 2 / (44.0 / 5));
  EXPECT_DOUBLE_EQ(shares.of_node[difference.id(tape)], 1.0 / 2 / (44.0 / 5));
  EXPECT_EQ(shares.of_node[unused.id(tape)], 0);
  EXPECT_DOUBLE_EQ(shares.allowance[0][0], (15.0 + 15 + 14) / 5) << "x, y and z change it by 15, 15 and 14";
}

TEST(RoundingShares, TellWhereMostIsToBeExpected) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const Expr sum = (x + y) * y - x * y;  // y^2, and x only loses digits
  const std::vector<double> expected =
      first_order_errors(tape, {output({sum.id(tape)})}, {{1, 1}, {1e8 / 3, 0.7}, {1, 1}}).front();
  EXPECT_LT(expected[0], 5);
  EXPECT_GT(expected[1], 1e5);
}

TEST(FirstOrderErrors, AreWhatIsMeasured) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const Expr third(tape, tape.constant(Exact::ratio(1, 3)));
  const Expr sum = (x * Expr(1000) + sin(third * y)) / y - x * (Expr(1000) / y) + sqrt(y) * exp(-x);
  const std::vector<OutputBlock> program = {output({sum.id(tape)})};
  for (const auto& state : std::vector<std::vector<double>>{{0.7, 1.3}, {1.9, 0.6}, {0.31, 2.7}}) {
    const double expected = first_order_errors(tape, program, {state}).front().front();
    const double allowance = rounding_shares(tape, program, {state}).allowance[0][0];
    const double measured = rounding_errors(tape, {program}, {state})[0].worst / allowance;
    EXPECT_NEAR(expected, measured, 1e-9 * measured) << "what is left is of second order";
  }
}

TEST(FirstOrderErrors, LeaveOutWhatIsCompensated) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const Expr shifted = (x + y) * y, product = x * y;
  const std::vector<OutputBlock> program = {output({(shifted - product).id(tape)})};  // y^2
  std::vector<double> shares(tape.size(), 1.0);
  shares[shifted.id(tape)] = 10;
  const auto errors = first_order_errors(tape, program, {{1e8 / 3, 0.7}}, shares, {20, 5, 0.5});
  EXPECT_GT(errors[0][0], 1e5);
  EXPECT_GT(errors[1][0], 1e5) << "the other product loses as much";
  EXPECT_NE(errors[0][0], errors[1][0]);
  EXPECT_EQ(errors[2][0], 0);
}

TEST(Outlook, GoesOnAsTheTailDoes) {
  constexpr int states = 2048;
  std::vector<double> heavy, bounded;
  for (int i = 1; i <= states; ++i) {
    heavy.push_back(std::pow(static_cast<double>(i), -0.25));
    bounded.push_back(7);
  }
  const std::vector<Outlook> outlooks = outlooks_of({heavy, bounded});
  EXPECT_EQ(outlooks[0].largest, 1);
  EXPECT_NEAR(outlooks[0].growth, std::pow(expected_states / states, 0.25), 0.2)
      << "the sum over the tail for an integral";
  EXPECT_EQ(outlooks[1].worst(), 7);
}

TEST(Compensation, KeepsTheDigitsThatAnExpandedPowerLosesAndTheExactValue) {
  Tape tape;
  const Expr x(tape, tape.input("x"));
  const std::vector<OutputBlock> plain = {output({expanded_power(x).id(tape)})};
  const std::vector<std::vector<double>> states = {{1.02}, {0.987}, {1.013}};
  const auto roots = compensated(tape, plain[0].nodes, rounding_shares(tape, plain, states).of_node, 0.5);
  ASSERT_TRUE(roots);
  // kappa is 5 x / (x - 1), some hundreds, and the plain value loses 1e8 ulps
  const auto errors = rounding_errors(tape, {plain, {output(*roots)}}, states);
  EXPECT_GT(errors[0].worst, 1e5);
  EXPECT_LT(errors[1].worst, 2) << "the last operation, and what is left of second order";
  const Exact at = Exact::ratio(2, 7);
  const std::vector<Exact> exact = interpret<Exact>(tape, {plain[0].nodes[0], (*roots)[0]}, std::vector{at});
  EXPECT_EQ(exact[0], exact[1]) << "fractions";
}

TEST(Compensation, ReachesThroughQuotientsSinesAndConstants) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const Expr third(tape, tape.constant(Exact::ratio(1, 3)));
  const Expr angle = third * x;
  const Expr sum = sin(angle) / y + third * y;
  const Expr result = (sum + x * Expr(1000)) * y - y * (x * Expr(1000));
  const std::vector<OutputBlock> plain = {output({result.id(tape)})};
  const std::vector<std::vector<double>> states = {{0.7, 1.3}, {-0.9, 2.1}, {1.9, 0.6}};
  const auto roots = compensated(tape, plain[0].nodes, rounding_shares(tape, plain, states).of_node, 0.1);
  ASSERT_TRUE(roots);
  const auto errors = rounding_errors(tape, {plain, {output(*roots)}}, states);
  EXPECT_GT(errors[0].worst, 50);
  EXPECT_LT(errors[1].worst, 1.5) << "the sine rounds to double in any case";
}

/// Sine and cosine in a difference that only their distance to the unit circle matters to, as in the inertia
/// that a chain of bodies keeps about an axis it is stretched along.
TEST(Compensation, PutsSineAndCosineOnTheUnitCircle) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const Expr c = cos(x), s = sin(x);
  const Expr difference = ((c * y) * c + (s * y) * s) - y + Expr(tape, tape.constant(Exact::ratio(1, 1024)));
  const std::vector<OutputBlock> plain = {output({difference.id(tape)})};
  std::vector<std::vector<double>> states;
  for (int i = 1; i <= 32; ++i) states.push_back({0.09 * i, 1 + 1 / static_cast<double>(i)});
  const std::vector<double> shares = rounding_shares(tape, plain, states).of_node;
  const auto roots = compensated(tape, plain[0].nodes, shares, 1);
  ASSERT_TRUE(roots);
  const auto errors = rounding_errors(tape, {plain, {output(*roots)}}, states);
  EXPECT_GT(errors[0].worst, 300);
  EXPECT_LT(errors[1].worst, 2) << "an angle of other digits moves nothing here";
  const std::vector<double> expected = first_order_errors(tape, plain, states, shares, {1}).front();
  EXPECT_LT(*std::ranges::max_element(expected), 2);
}

TEST(Compensation, IsNotAddedWhereNoShareIsLarge) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const std::vector<OutputBlock> plain = {output({(x * y + x).id(tape)})};
  const std::vector<double> shares = rounding_shares(tape, plain, {{2, 3}, {5, 7}}).of_node;
  EXPECT_FALSE(compensated(tape, plain[0].nodes, shares, 1));
}

/// The index that balance keeps of a single candidate and what it adds to it.
Candidate kept(Tape& tape, const Expr& y, const std::vector<std::vector<double>>& states) {
  std::vector<Candidate> candidates = {{"plain", {output({y.id(tape)})}, 1, 0}};
  const std::size_t best = choose(
      tape, candidates, OptimiseFor::balanced, [&](int) { return states; },
      [&](const MeasuredStates& at) {
        add_compensated(tape, candidates, {}, OptimiseFor::balanced, at, {0});
      });
  return candidates[best];
}

TEST(Compensation, IsChosenWhereTheProgramLosesWhatTheInputsDoNotExcuse) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const std::vector<std::vector<double>> states = {{1e5 / 3, 0.7}, {2e5 / 3, 1.9}, {1e5 / 7, 1.1}};
  const Candidate best = kept(tape, (x + y) * y - x * y, states);
  EXPECT_NE(best.name, "plain");
  EXPECT_LE(best.error.worst, tolerated_ulps);
}

TEST(Compensation, IsNotChosenWhereTheRoundingOfTheInputsCostsAsMuch) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const std::vector<std::vector<double>> states = {{1.1, 1.1 + 1e-9}, {0.7, 0.7 - 1e-9}, {1.3, 1.3 + 1e-9}};
  const Candidate best = kept(tape, x * x * x - y * y * y, states);
  EXPECT_EQ(best.name, "plain") << "an ulp of x changes this by 1e9 ulps";
  EXPECT_GT(rounding_errors(tape, {best.outputs}, states)[0].worst, 1e6);
}

TEST(Compensation, OfABeamThatGivesWayKeepsTheJointsAcceleration) {
  const Model model = read_model(std::string(ANHOLON_SOURCE_DIR) +
                                 "/models/two_link_flexible_arm/two_link_flexible_arm.toml");
  const auto chosen = [&](OptimiseFor aim) {
    DeriveRequest request;
    request.functions = {"torque_driven_dynamics"};
    request.optimise = aim;
    request.trace = true;
    const auto derivation = derive(model, request);  // outlives the loop
    for (const CandidateReport& c : derivation->candidates) {
      if (c.chosen && c.function == "torque_driven_dynamics") return c;
    }
    return CandidateReport{};
  };
  EXPECT_GT(chosen(OptimiseFor::speed).error.worst, 100);
  const CandidateReport balanced = chosen(OptimiseFor::balanced);
  EXPECT_LE(balanced.error.worst, allowed_ulps);
  EXPECT_NE(balanced.route.find("compensated"), std::string::npos) << balanced.route;
}

}  // namespace
}  // namespace anholon::compensation_test
