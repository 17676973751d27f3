// SPDX-License-Identifier: GPL-2.0-or-later
//
// Single evaluations where scales part: generated code in double and in float, and the numeric recursion,
// against exact arithmetic. What an error may be is said in robot.hpp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "check/verify.hpp"
#include "hard/model_file.hpp"
#include "hard/pendulum_equations.hpp"
#include "hard/robot.hpp"
#include "hard/table.hpp"

namespace anholon::testing::states_test {
namespace {

constexpr int states = 40;
const std::string of_states = "One evaluation of the accelerations, the worst of 40 random states";
using StateSource = std::function<NamedValues<double>(std::mt19937_64&)>;

/// Random angles, and rates of size v.
NamedValues<double> links(std::mt19937_64& random, int n, double v) {
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi), rate(-v, v);
  NamedValues<double> in;
  for (int i = 0; i < n; ++i) in["r_p"].push_back(angle(random)), in["nu"].push_back(rate(random));
  return in;
}

struct Case {
  std::string name, why;
  Values parameters = {};
  bool with_float = true;   // inputs and results are floats of normal size
  bool shows_M = false;     // the mass matrix explains what is lost
  double of_recursion = 0;  // condition of what the recursion alone inverts
};

/// Worst digits over random states, put on record; errors must stay within their bounds.
Kept check(Robot& robot, const Case& c, const StateSource& state) {
  SCOPED_TRACE(c.name);
  Kept kept;
  std::mt19937_64 random(7);
  for (int i = 0; i < states; ++i)
    robot.compare(state(random), c.parameters, kept, c.with_float, c.of_recursion);
  EXPECT_LE(kept.of_bound, 1);
  EXPECT_LE(kept.of_recursion_bound, 1);
  EXPECT_LE(kept.of_float_bound, 1);
  note({of_states, c.name, "accelerations", digits_text(kept.in_double),
        c.with_float ? digits_text(kept.in_float) : "", digits_text(kept.recursion),
        c.shows_M ? fmt::format("{:.2g}; of M {:.2g}", kept.kappa, kept.kappa_M)
                  : fmt::format("{:.2g}", kept.kappa),
        c.why});
  return kept;
}

const StateSource moderate = [](std::mt19937_64& random) { return links(random, 2, 3); };
const std::string pendulum = "tests/hard/double_pendulum.toml";

/// The program run exactly is what Lagrange's equations say, so that comparing with it is comparing with
/// them.
TEST(HardStates, ExactProgramOfThePendulumIsLagrangesEquations) {
  Robot robot(pendulum);
  const WorkingDigits precision(60);
  std::mt19937_64 random(3);
  const Values parameters = {{"m_1", 1e-12}, {"m_2", 1}, {"l_1", 1e-3}, {"l_2", 1e3}};
  const auto value = [&](const char* name) { return Exact::from_double(parameters.at(name)); };
  const Exact hundredth = Exact::from_double(0.01);
  const Links by_hand = {{value("m_1"), value("m_2")},
                         {value("l_1"), value("l_2")},
                         {hundredth * value("m_1") * value("l_1") * value("l_1"),
                          hundredth * value("m_2") * value("l_2") * value("l_2")},
                         Exact::from_double(9.81)};
  for (int i = 0; i < 10; ++i) {
    const NamedValues<Exact> in = exactly(moderate(random));
    const std::vector<Exact> want = accelerations(by_hand, in.at("r_p"), in.at("nu"));
    const std::vector<Exact> got = robot.exact("forward_dynamics", in, parameters).at("nu_dot");
    for (std::size_t j = 0; j < 2; ++j) {
      const double error = (abs(got[j] - want[j]) / (abs(want[0]) + abs(want[1]))).to_double();
      EXPECT_LT(error, 1e-30);  // 60 digits, of which the proportions take 2 log10(l_2/l_1) + 12
    }
  }
}

TEST(HardStates, DoublePendulumOfAnyProportions) {
  Robot robot(pendulum);
  const auto run = [&](const Case& c) { check(robot, c, moderate); };
  const std::string eliminated =
      "the upper link's own inertia is what is left of the lower one's when the joint between gives way: "
      "elimination loses the condition of M; the share of the angles is kappa";
  run({"double pendulum of equal links", "the reference: sums of terms of one size"});
  for (const double ratio : {1e6, 1e9, 1e12}) {
    run({fmt::format("lower link {:.0e} times as heavy", ratio),
         eliminated,
         {{"m_1", 1}, {"m_2", ratio}},
         true,
         true});
    run({fmt::format("upper link {:.0e} times as heavy", ratio),
         "the small mass adds nothing that the result needs",
         {{"m_1", ratio}, {"m_2", 1}}});
  }
  run({"upper link nearly massless, 1e-12 kg",
       "the same proportions as 1e12 : 1",
       {{"m_1", 1e-12}, {"m_2", 1}},
       true,
       true});
  run({"lower link nearly massless, 1e-12 kg",
       "all of its terms are small together",
       {{"m_1", 1}, {"m_2", 1e-12}}});
  run({"links of 1e-6 m", "a common scale cancels nothing", {{"l_1", 1e-6}, {"l_2", 1e-6}}});
  run({"links of 1e3 m", "likewise", {{"l_1", 1e3}, {"l_2", 1e3}}});
  run({"upper link of 1e3 m, lower one of 1e-6 m",
       "the short link hardly counts for the long one, and its own terms are small together",
       {{"l_1", 1e3}, {"l_2", 1e-6}}});
  run({"joint stiffness 1e8 N m/rad", "one force outweighs the others", {{"k", 1e8}}});
}

// The inertia of the upper link about its joint is what is left of terms of the lower one, (l_2/l_1)^2 times
// as large, when the lower link is free to turn. Joint coordinates lose as many digits; the motion itself
// would not.
TEST(HardStates, ShortLinkAboveALongOneLosesTheSquareOfTheRatio) {
  Robot robot(pendulum);
  for (const double ratio : {1e1, 1e3, 1e5, 1e7})
    check(robot,
          {fmt::format("lower link {:.0e} times as long as the upper", ratio),
           "the mass matrix in angles between links loses 2 log10 of the ratio; the problem does not",
           {{"l_1", 1e3 / ratio}, {"l_2", 1e3}},
           false,
           true},
          moderate);
}

TEST(HardStates, VelocitiesNearTheEndsOfTheRange) {
  Robot robot(pendulum);
  const auto run = [&](double v, const Values& parameters, const std::string& why) {
    const bool is_float = v < 1e16 && v > 1e-16;
    check(robot,
          {fmt::format("rates of {:.0e} rad/s{}", v, parameters.empty() ? "" : ", no gravity"), why,
           parameters, is_float},
          [v](auto& random) { return links(random, 2, v); });
  };
  const Values weightless = {{"g", 0}};
  run(1e15, {}, "centrifugal terms alone count");
  run(1e150, {}, "squares of 1e300 are representable, and nothing is squared again");
  run(1e150, weightless, "likewise");
  run(1e-150, weightless, "squares of 1e-300 are normal numbers");
  run(1e-150, {}, "gravity alone counts");
}

TEST(HardStates, RatesWhoseSquaresAreDenormalOrVanish) {
  Robot robot(pendulum);
  const Values weightless = {{"g", 0}};
  const WorkingDigits precision(400);
  const Exact least = Exact::from_double(std::numeric_limits<double>::denorm_min());
  std::mt19937_64 random(7);
  double worst = 0;
  for (const double v : {1e-155, 1e-158, 1e-162, 1e-300, 5e-324}) {
    for (int i = 0; i < states; ++i) {
      const NamedValues<double> in = links(random, 2, v);
      const auto got = robot.call("forward_dynamics", in, weightless);
      const auto want = robot.exact("forward_dynamics", exactly(in), weightless).at("nu_dot");
      const Exact size = abs(want[0]) + abs(want[1]);
      for (std::size_t j = 0; j < 2; ++j) {
        const Exact error = abs(Exact::from_double(got.at("nu_dot")[j]) - want[j]);
        // 1e-13 of the size, or some tens of roundings to the last denormal digit, magnified by the inverse
        // mass matrix of these links, whose entries stay below 100
        EXPECT_LE(error, size * Exact::from_double(1e-13) + Exact(1000) * least) << v;
        if (size < Exact::from_double(1e-300)) worst = std::max(worst, (error / least).to_double());
      }
    }
  }
  note({of_states, "rates of 1e-155 rad/s down to the least denormal, no gravity", "accelerations",
        fmt::format("to {:.0f} units of 4.9e-324", std::ceil(worst)), "", "", "",
        "squares are denormal or vanish: digits go one by one, the absolute error stays"});
}

TEST(HardStates, FreeBodyOfAnyShape) {
  Robot robot("tests/hard/free_body.toml");
  const auto run = [&](const std::string& name, const Values& parameters, double v, const std::string& why,
                       double of_recursion = 0) {
    const StateSource tumbling = [v](std::mt19937_64& random) {
      std::uniform_real_distribution<double> rate(-v, v);
      NamedValues<double> in;
      for (int i = 0; i < 6; ++i) in["nu"].push_back(rate(random));
      in["R"] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, in["p"] = {0, 0, 0};
      return in;
    };
    check(robot, {name, why, parameters, v < 1e15 && v > 1e-15, false, of_recursion}, tumbling);
  };
  run("free body, inertias 1, 2, 3 - 3e-15", {{"J_3", 3 - 3e-15}}, 3,
      "a flat body: nothing divides by J_1 + J_2 - J_3");
  run("free body, inertias 1e-9, 1, 1", {{"J_1", 1e-9}, {"J_2", 1}, {"J_3", 1}}, 3,
      "a needle: rounded inertias would move the spin by kappa, since J_2 - J_3 is divided by J_1; the code "
      "adds "
      "nothing to that");
  run("free body, inertias 1, 1, 1 + 1e-12", {{"J_1", 1}, {"J_2", 1}, {"J_3", 1 + 1e-12}}, 3,
      "differences of nearly equal inertias: their rounding moves them as much, and they count little");
  run("free body, mass centre 1e3 m off", {{"c", 1e3}}, 3,
      "parallel axes: 2e6 kg m^2 beside 1; the program has solved for the accelerations of the mass centre, "
      "the "
      "recursion factorises a mass matrix of condition 8e6",
      4 * 2e6);
  run("free body at 1e150 m/s and rad/s", {{"c", 0.5}}, 1e150, "squares of 1e300 are representable");
  run("free body at 1e-150 m/s and rad/s", {{"c", 0.5}}, 1e-150, "squares of 1e-300 are normal numbers");
}

TEST(HardStates, KernelsNextToWhereTheyDegenerate) {
  Robot board("models/rigid_snakeboard/rigid_snakeboard.toml");
  Robot bicycle("models/bicycle/bicycle.toml");
  for (const double off : {1e-3, 1e-8, 1e-15, 0.0}) {
    const auto near = [off](Robot& robot) {
      return [off, &robot](std::mt19937_64& random) {
        std::uniform_real_distribution<double> any(-1, 1);
        NamedValues<double> in;
        for (const InputBlock& block : robot.program().inputs) {
          for (std::size_t i = 0; i < block.nodes.size(); ++i) in[block.name].push_back(any(random));
        }
        in["r_a"][0] = std::numbers::pi / 2 - off;
        return in;
      };
    };
    // The recursion factorises rows of this condition; below 1e-12 it takes them for dependent.
    const double rows = off > 1e-12 ? 4 / off : 0;
    check(board,
          {fmt::format("snake-board, axles {:.0e} rad from a right angle", off),
           "the kernel basis divides by nothing that vanishes there; the recursion factorises rows of "
           "condition 1/off",
           {},
           true,
           false,
           rows},
          near(board));
    if (off > 1e-9)
      check(bicycle,
            {fmt::format("bicycle, steered {:.0e} rad from a right angle", off),
             "for the angle as it is rounded, which alone takes log10 kappa digits of an angle that is not",
             {},
             true,
             false,
             rows},
            near(bicycle));
  }
}

// Where the default parameters are such that every route through the mass matrix loses its digits,
// articulated bodies are emitted, and the problem's own condition is all that is lost.
TEST(HardStates, ArticulatedBodiesKeepWhatTheMassMatrixLoses) {
  for (const double l_1 : {1e-2, 1e-6}) {
    Robot robot(pendulum, {{"l_1", l_1}, {"l_2", 1e3}});
    EXPECT_EQ(robot.route(), "articulated bodies");
    const Kept kept =
        check(robot,
              {fmt::format("lower link {:.0e} times as long, generated for these lengths", 1e3 / l_1),
               "articulated bodies: the generator sees that the mass matrix would lose all and takes this "
               "route; the recursion keeps to the mass matrix",
               {},
               false,
               true,
               INFINITY},  // the recursion may lose all
              moderate);
    EXPECT_LE(kept.of_strict_bound, 1);
  }
  EXPECT_NE(Robot(pendulum).route(), "articulated bodies");  // equal links keep the cheaper one
}

/// What loses all digits does not pass unseen: `verify` fails at these parameters and says where. With
/// compensated operations nothing is lost there.
TEST(HardStates, VerifyNamesWhatLosesItsDigits) {
  DeriveRequest shortest;
  shortest.optimise = OptimiseFor::speed;
  Model model = model_file("tests/hard/pushed_pendulum.toml");
  const auto verification = [&](double l_1) {
    for (Parameter& p : model.parameters) {
      if (p.name == "l_1") p.value = Exact::from_double(l_1);
      if (p.name == "l_2") p.value = Exact(1000);
    }
    return verify_program(model, *derive(model, shortest), {.samples = 100}, {});
  };
  EXPECT_TRUE(verification(1000).passed);
  const Verification lost = verification(1e-6);
  EXPECT_FALSE(lost.passed);
  ASSERT_FALSE(lost.outputs.empty());
  const auto worst = std::ranges::max_element(lost.outputs, {}, &OutputError::worst);
  EXPECT_GT(worst->worst, 1e-3) << worst->function << " " << worst->output;
  EXPECT_FALSE(worst->passed);
  const Verification kept = verify_program(model, *derive(model), {.samples = 100}, {});
  for (const OutputError& e : kept.outputs) EXPECT_LT(e.worst, 1e-9) << e.function << " " << e.output;
}

}  // namespace
}  // namespace anholon::testing::states_test
