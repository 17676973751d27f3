// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/ginac_view.hpp"

#include <gtest/gtest.h>

#include "algebra/tape_samples.hpp"

namespace anholon::ginac_view_test {
namespace {

using test::GinacView;
using test::input;

TEST(GinacView, GivesTheExpressionThatTheScalarGives) {
  Tape tape;
  const Expr a = input(tape, "a");
  const Expr b = input(tape, "b");
  const Expr x = input(tape, "x");
  const Expr y = input(tape, "y");
  const Expr third(tape, tape.constant(Exact::ratio(1, 3)));
  GinacView view(tape);
  std::vector<GiNaC::ex> symbols;
  for (std::size_t i = 0; i < tape.inputs().size(); ++i) symbols.push_back(view.to_ginac(tape.input_node(i)));
  for (const Expr& e : {a * a * b - third * a * b * b + x, (a - b) / (x - y) + (b - a) * (x - y),
                        (a * cos(x) + b * sin(x)) * (a * cos(x) - b * sin(x)) * cos(y),
                        sin(x + y) - cos(x - Expr(2) * y) + tan(y)}) {
    const NodeId id = e.id(tape);
    const auto run = interpret<GiNaC::ex>(tape, {id}, symbols);
    EXPECT_TRUE((run[0] - view.to_ginac(id)).normal().is_zero());
    EXPECT_TRUE(view.vanishes(run[0] - view.to_ginac(id)));
  }
}

TEST(GinacView, KnowsThatCosineAndSineLieOnACircle) {
  Tape tape;
  const Expr x = input(tape, "x");
  const Expr y = input(tape, "y");
  GinacView view(tape);
  const auto vanishes = [&](const Expr& e) { return view.vanishes(view.to_ginac(e.id(tape))); };
  EXPECT_TRUE(vanishes(sin(x) * sin(x) * sin(x) + cos(x) * cos(x) * sin(x) - sin(x)));
  EXPECT_TRUE(vanishes(sin(x + y) - sin(x) * cos(y) - cos(x) * sin(y)));
  EXPECT_TRUE(vanishes(cos(Expr(3) * x) - Expr(4) * cos(x) * cos(x) * cos(x) + Expr(3) * cos(x)));
  EXPECT_TRUE(vanishes(tan(x) * cos(x) - sin(x)));
  EXPECT_FALSE(vanishes(sin(x) * sin(x) - cos(x) * cos(x)));
  EXPECT_FALSE(vanishes(sin(x) - sin(y)));
}

}  // namespace
}  // namespace anholon::ginac_view_test
