// SPDX-License-Identifier: GPL-2.0-or-later
// What rounding costs, stable forms of differences, and the choice between short programs and accurate ones.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "derive/derive.hpp"
#include "describe/read_model.hpp"
#include "emit/header.hpp"
#include "optimise/accuracy/choice.hpp"
#include "optimise/accuracy/sine_and_cosine.hpp"
#include "optimise/tape/stable_forms.hpp"
#include "reduce/samples.hpp"
#include "tape/interpret.hpp"

namespace anholon::accuracy_test {
namespace {

OutputBlock output(const std::vector<NodeId>& nodes) {
  return {"y", "", "", static_cast<int>(nodes.size()), 1, nodes};
}

TEST(RoundingErrors, CountsTheUlpsOfOneRoundingAndTellsMedianFromWorst) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const NodeId product = (x * y).id(tape);
  // 3 * (1/3 rounded) is 1 - 2^-54, which rounds to 1: an error of 2^-54, a quarter of 2^-52.
  const auto one = rounding_errors(tape, {{output({product})}}, {{3.0, 1.0 / 3}});
  EXPECT_NEAR(one[0].worst, 0.25, 1e-12);
  EXPECT_EQ(one[0].median, one[0].worst);
  const auto three = rounding_errors(tape, {{output({product})}}, {{1, 1}, {3, 1.0 / 3}, {1, 1}});
  EXPECT_NEAR(three[0].worst, 0.25, 1e-12);
  EXPECT_EQ(three[0].median, 0) << "two of three products are exact";
}

TEST(RoundingErrors, TakesTheNaturalScaleOfTheWholeBlock) {
  Tape tape;
  const Expr x(tape, tape.input("x"));
  const NodeId small = (Expr(1) - cos(x)).id(tape);
  const std::vector<double> state = {1e-4};
  const double alone = rounding_errors(tape, {{output({small})}}, {state})[0].worst;
  const double beside = rounding_errors(tape, {{output({small, tape.constant(1)})}}, {state})[0].worst;
  EXPECT_GT(alone, 1e6) << "1e-16 of 5e-9";
  EXPECT_LE(beside, 0.5) << "1e-16 of 1";
}

TEST(RoundingErrors, LeavesOutStatesThatDivideByZero) {
  Tape tape;
  const Expr x(tape, tape.input("x"));
  const NodeId inverse = (Expr(1) / x).id(tape);
  EXPECT_FALSE(rounding_errors(tape, {{output({inverse})}}, {{0.0}})[0].is_measured());
  EXPECT_LE(rounding_errors(tape, {{output({inverse})}}, {{0.0}, {3.0}})[0].worst, 0.5);
}

/// A difference that cancels where its inputs x and y are small or close to each other.
struct Difference {
  std::string name;
  std::function<Expr(Tape&, Expr x, Expr y)> of;
  double x, y;
};
void PrintTo(const Difference& d, std::ostream* out) { *out << d.name; }

Expr number(Tape& tape, const char* decimal) { return {tape, tape.constant(Exact::from_decimal(decimal))}; }

class StableForm : public ::testing::TestWithParam<Difference> {};

TEST_P(StableForm, HasTheSameValueAndKeepsTheDigitsThatTheDifferenceLoses) {
  const Difference& d = GetParam();
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const NodeId plain = d.of(tape, x, y).id(tape);
  const NodeId stable = stable_forms(tape, {plain})[0];
  ASSERT_NE(stable, plain);
  const WorkingDigits precision(60);
  for (const auto& [at_x, at_y] : {std::pair{0.7, -0.4}, {2.9, 1.3}, {-1.1, 2.2}, {d.x, d.y}}) {
    const std::vector<Exact> in = {Exact::from_double(at_x), Exact::from_double(at_y)};
    const std::vector<Exact> value = interpret<Exact>(tape, {plain, stable}, in);
    EXPECT_LT(abs(value[0] - value[1]).to_double(), 1e-50) << "at " << at_x << ", " << at_y;
  }
  const auto errors = rounding_errors(tape, {{output({plain})}, {output({stable})}}, {{d.x, d.y}});
  EXPECT_GT(errors[0].worst, 1e3);
  EXPECT_LT(errors[1].worst, 6) << "half an ulp for each of a dozen operations, in the worst case";
}

INSTANTIATE_TEST_SUITE_P(
    Forms, StableForm,
    ::testing::Values(
        Difference{"versine", [](Tape&, Expr x, Expr) { return Expr(1) - cos(x); }, 1e-5, 0},
        Difference{
            "scaled versine",
            [](Tape& t, Expr x, Expr y) { return y * number(t, "0.3") * cos(x) - number(t, "0.3") * y; },
            1e-5, 2},
        Difference{"product of cosines", [](Tape&, Expr x, Expr y) { return Expr(1) - cos(x) * cos(y); },
                   1e-5, -3e-6},
        Difference{"1 - cos^2", [](Tape&, Expr x, Expr) { return Expr(1) - cos(x) * cos(x); }, 1e-5, 0},
        Difference{"1 - sin^2", [](Tape&, Expr x, Expr y) { return y - y * sin(x) * sin(x); }, 1.5707, 2},
        Difference{"cos^2 - sin^2", [](Tape&, Expr x, Expr) { return cos(x) * cos(x) - sin(x) * sin(x); },
                   0.785398, 0},
        Difference{"difference of cosines", [](Tape&, Expr x, Expr y) { return cos(x) - cos(y); }, 0.3,
                   0.3000001},
        Difference{"difference of sines",
                   [](Tape&, Expr x, Expr y) { return Expr(3) * sin(x) - Expr(3) * sin(y); }, 0.3, 0.3000001},
        Difference{"sine of a difference",
                   [](Tape&, Expr x, Expr y) { return sin(x) * cos(y) - cos(x) * sin(y); }, 1.3, 1.3000017},
        Difference{"difference of squares", [](Tape&, Expr x, Expr y) { return x * x - y * y; }, 0.3000000007,
                   0.3},
        Difference{"square minus one", [](Tape&, Expr x, Expr) { return x * x - Expr(1); }, 1.000000007, 0},
        Difference{
            "root",
            [](Tape& t, Expr x, Expr y) { return y * (sqrt(number(t, "0.25") + x * x) - number(t, "0.5")); },
            1e-5, 0.7},
        Difference{"exponential", [](Tape&, Expr x, Expr) { return exp(x) - Expr(1); }, 1e-7, 0},
        Difference{"inside a longer sum", [](Tape&, Expr x, Expr y) { return Expr(1) + (y - cos(x)); }, 1e-5,
                   1e-12}));

TEST(StableForms, LeavesSumsAloneThatDoNotCancel) {
  Tape tape;
  const Expr x(tape, tape.input("x")), y(tape, tape.input("y"));
  const std::vector<NodeId> roots = {(Expr(1) + cos(x)).id(tape), (x * x + y * y).id(tape), (x - y).id(tape),
                                     (sin(x) * cos(y) + cos(x) * sin(y)).id(tape),
                                     (Expr(2) - cos(x)).id(tape)};
  EXPECT_EQ(stable_forms(tape, roots), roots);
}

TEST(SineAndCosine, HaveThirtyDigitsAndTheFirstSixteenRoundedToNearest) {
  const WorkingDigits precision(60);
  SampleSource source;
  const auto compare = [](double x) {
    const auto [sine, cosine] = sine_and_cosine(x);
    const Exact angle = Exact::from_double(x);
    for (const auto& [got, expected] : {std::pair{sine, sin(angle)}, std::pair{cosine, cos(angle)}}) {
      EXPECT_EQ(got.rounded, expected.to_double()) << x;
      const Exact sum = Exact::from_double(got.rounded) + Exact::from_double(got.rest);
      EXPECT_LT(std::abs((sum - expected).to_double()), 1e-30) << x;
    }
  };
  for (int i = 0; i < 2000; ++i) compare(8 * source.uniform() - 4);
  for (int i = 0; i < 200; ++i) compare(largest_angle * (2 * source.uniform() - 1));
  for (int i = -8; i <= 8; ++i) compare(i * 0.78539816339744831);
  for (const double x : {1e-300, 1e-20, 1e-9, 1e-3}) compare(x);
}

/// Two candidates: a short one that loses digits where x is small, and a longer one.
class Choice : public ::testing::Test {
 protected:
  Choice() {
    const Expr x(tape, tape.input("x"));
    const Expr half = sin(x * Expr(tape, tape.constant(Exact::ratio(1, 2))));
    candidates = {{"short", {output({(Expr(1) - cos(x)).id(tape)})}, 1, 0},
                  {"long", {output({(Expr(2) * half * half).id(tape)})}, 3, 1}};
  }
  std::size_t chosen(OptimiseFor mode, double x) {
    for (Candidate& c : candidates) c.error = {};
    return choose(
        tape, candidates, mode, [x](int) { return std::vector<std::vector<double>>{{x}}; },
        [](const MeasuredStates&) {});
  }
  Tape tape;
  std::vector<Candidate> candidates;
};

TEST_F(Choice, IsForTheShortOneWhereItLosesLittle) {
  for (const OptimiseFor mode : {OptimiseFor::accuracy, OptimiseFor::balanced, OptimiseFor::speed})
    EXPECT_EQ(chosen(mode, 2.5), 0U) << name(mode);
}

TEST_F(Choice, IsForTheLongOneWhereTheShortOneLosesDigitsButForSpeed) {
  EXPECT_EQ(chosen(OptimiseFor::accuracy, 1e-4), 1U);
  EXPECT_EQ(chosen(OptimiseFor::balanced, 1e-4), 1U);
  EXPECT_EQ(chosen(OptimiseFor::speed, 1e-4), 0U);
  EXPECT_EQ(chosen(OptimiseFor::balanced, 0.5), 0U) << "a few ulps are tolerated";
  EXPECT_EQ(chosen(OptimiseFor::accuracy, 0.5), 1U);
}

TEST_F(Choice, KeepsTheShortOneWhereTheOthersAreNoBetter) {
  candidates[1].outputs = candidates[0].outputs;
  EXPECT_EQ(chosen(OptimiseFor::balanced, 1e-4), 0U);
  EXPECT_EQ(chosen(OptimiseFor::accuracy, 1e-4), 0U);
}

TEST_F(Choice, AsksForMoreOnlyWhereItIsNeeded) {
  const auto asked = [&](OptimiseFor mode, double x) {
    bool more = false;
    choose(
        tape, candidates, mode, [x](int) { return std::vector<std::vector<double>>{{x}}; },
        [&](const MeasuredStates&) { more = true; });
    return more;
  };
  EXPECT_FALSE(asked(OptimiseFor::speed, 1e-4));
  EXPECT_FALSE(asked(OptimiseFor::balanced, 2.5));
  EXPECT_TRUE(asked(OptimiseFor::balanced, 1e-4));
  EXPECT_TRUE(asked(OptimiseFor::accuracy, 2.5));
}

/// A pendulum that swings by a ten-thousandth of a radian, with a potential of its own.
Model small_pendulum(const std::string& potential) {
  return read_model_text(R"(
anholon = 1
name    = "small_pendulum"
group   = "fixed"
potential = ")" + potential + R"("
[parameters]
k = { value = 2.3, unit = "N m", meaning = "stiffness" }
d = { value = 1.7, unit = "1", meaning = "offset" }
[[body]]
name = "base"
[[body]]
name    = "bob"
parent  = "base"
joint   = { kind = "revolute", axis = [0, 1, 0], coordinate = "q", drive = "passive", range = [-1e-4, 1e-4] }
inertia = { mass = 1, com = [0, 0, -1], about_com = { yy = 0.1 } }
)",
                         "small_pendulum.toml");
}

/// Worst relative error of the elastic energy in double against 60 digits, in ulps.
double energy_error(const Model& model, OptimiseFor mode) {
  DeriveRequest request;
  request.functions = {"energies"};
  request.optimise = mode;
  const auto derivation = derive(model, request);
  const Program& program = derivation->program;
  const std::vector<OutputBlock>& outputs = program.functions.at(0).outputs;
  const NodeId energy = std::ranges::find(outputs, "elastic", &OutputBlock::name)->nodes[0];
  const WorkingDigits precision(60);
  double worst = 0;
  for (const double q : {9.7e-5, -6.1e-5, 3.3e-5, 8.8e-5}) {
    std::vector<double> in(program.tape.inputs().size(), 0.0);
    for (const ParameterInfo& p : program.parameters) in[program.tape.node(p.node).a] = p.value.to_double();
    for (const InputBlock& b : program.inputs) {
      if (b.name == "r_p") in[program.tape.node(b.nodes[0]).a] = q;
    }
    std::vector<Exact> exactly;
    for (const double x : in) exactly.push_back(Exact::from_double(x));
    const Exact expected = interpret<Exact>(program.tape, {energy}, exactly)[0];
    const double got = interpret<double>(program.tape, {energy}, in)[0];
    worst = std::max(worst, std::abs(((Exact::from_double(got) - expected) / expected).to_double()) * 0x1p52);
  }
  return worst;
}

TEST(OptimiseFor, AccuracyKeepsTheDigitsOfSmallEnergiesThatSpeedLoses) {
  for (const char* potential :
       {"k*(1 - cos(q))", "k*(1 - cos(q)*cos(3*q))", "k*(sqrt(1 + q^2) - 1)", "k*(exp(q) - 1)",
        "k*((d*exp(q))^2 - d^2)", "k*(1 - cos(q)^2) + 2*k*(cos(2*q) - cos(q))"}) {
    SCOPED_TRACE(potential);
    const Model model = small_pendulum(potential);
    EXPECT_GT(energy_error(model, OptimiseFor::speed), 1e3);
    EXPECT_LT(energy_error(model, OptimiseFor::accuracy), 5) << "a handful of roundings";
    EXPECT_LT(energy_error(model, OptimiseFor::balanced), 16) << "tolerated_ulps";
  }
}

TEST(OptimiseFor, GivesTheSameBytesAgainAndSaysWhatItWasFor) {
  const Model model = small_pendulum("k*(1 - cos(q))");
  DeriveRequest request;
  request.optimise = OptimiseFor::accuracy;
  const std::string once = emit_header(derive(model, request)->program);
  EXPECT_EQ(once, emit_header(derive(model, request)->program));
  EXPECT_NE(once.find("optimised for accuracy"), std::string::npos);
  EXPECT_EQ(emit_header(derive(model)->program).find("optimised for"), std::string::npos);
}

TEST(OptimiseFor, SpeedTakesNoMoreOperationsThanBalancedAndAccuracyLosesNoMoreDigits) {
  const Model model =
      read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/rigid_snakeboard/rigid_snakeboard.toml");
  const auto kept = [&](OptimiseFor mode) {
    DeriveRequest request;
    request.functions = {"forward_dynamics", "multipliers", "energies"};
    request.optimise = mode;
    request.trace = true;
    const auto derivation = derive(model, request);  // outlives the loop
    std::vector<CandidateReport> chosen;
    for (const CandidateReport& c : derivation->candidates) {
      if (c.chosen) chosen.push_back(c);
    }
    return chosen;
  };
  const auto speed = kept(OptimiseFor::speed), balanced = kept(OptimiseFor::balanced),
             accuracy = kept(OptimiseFor::accuracy);
  for (std::size_t i = 0; i < speed.size(); ++i) {
    SCOPED_TRACE(speed[i].function);
    EXPECT_LE(speed[i].operations, balanced[i].operations);
    EXPECT_LE(accuracy[i].error.worst,
              std::max(balanced[i].error.worst + 0.5, 1.25 * balanced[i].error.worst))
        << "what counts as the same error";
  }
}

}  // namespace
}  // namespace anholon::accuracy_test
