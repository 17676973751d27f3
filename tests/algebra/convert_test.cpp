// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/convert.hpp"

#include <gtest/gtest.h>

#include "algebra/ginac_scalar.hpp"
#include "algebra/tape_samples.hpp"

namespace anholon::convert_test {
namespace {

using test::input;
using test::text;

std::vector<Expr> samples(Tape& tape) {
  const Expr a = input(tape, "a");
  const Expr b = input(tape, "b");
  const Expr x = input(tape, "x");
  const Expr y = input(tape, "y");
  const Expr third(tape, tape.constant(Exact::ratio(1, 3)));
  const Expr half_turn(tape, tape.constant(Exact::pi()));
  return {
      a * a * b - third * a * b * b + x,
      (a - b) / (x - y) + (b - a) * (x - y),
      (a * cos(x) + b * sin(x)) * (a * cos(x) - b * sin(x)) * cos(y),
      sin(x + y) - cos(x - Expr(2) * y) + tan(y),
      sqrt(a * a + b * b) * exp(-(a * b)) + log(a * a + b * b) + tanh(a) + abs(b) + sign(a),
      atan2(a, b) - half_turn * b,
      -(a - b) * (y - x) / (a * b) / (a + b) + a / (b * b * b * b * b),
  };
}

TEST(GinacConverter, KeepsTheValueThereAndBack) {
  for (const auto angles : {GinacConverter::Angles::symbols, GinacConverter::Angles::functions}) {
    Tape tape;
    const auto expressions = samples(tape);
    std::mt19937_64 rng(7);
    for (std::size_t i = 0; i < expressions.size(); ++i) {
      SCOPED_TRACE(i);
      const NodeId id = expressions[i].id(tape);
      GinacConverter converter(tape, angles);
      const NodeId back = converter.to_tape(converter.to_ginac(id));
      for (int sample = 0; sample < 5; ++sample) {
        const auto v = test::values(tape, {id, back}, test::random_point(tape, rng));
        EXPECT_TRUE(test::vanishes(v[0] - v[1])) << text(tape, back);
      }
    }
  }
}

TEST(GinacConverter, GivesTheExpressionThatTheScalarGives) {
  Tape tape;
  const auto expressions = samples(tape);
  GinacConverter converter(tape, GinacConverter::Angles::functions);
  std::vector<GiNaC::ex> symbols;
  for (std::size_t i = 0; i < tape.inputs().size(); ++i)
    symbols.push_back(converter.to_ginac(tape.input_node(i)));
  for (std::size_t i = 0; i < 4; ++i) {
    const NodeId id = expressions[i].id(tape);
    const auto run = interpret<GiNaC::ex>(tape, {id}, symbols);
    EXPECT_TRUE((run[0] - converter.to_ginac(id)).normal().is_zero()) << i;
    EXPECT_TRUE(converter.residual(run[0] - converter.to_ginac(id)).is_zero()) << i;
  }
}

TEST(GinacConverter, KnowsThatCosineAndSineLieOnACircle) {
  for (const auto angles : {GinacConverter::Angles::symbols, GinacConverter::Angles::functions}) {
    Tape tape;
    const Expr x = input(tape, "x");
    const Expr y = input(tape, "y");
    GinacConverter converter(tape, angles);
    const auto residual = [&](const Expr& e) { return converter.residual(converter.to_ginac(e.id(tape))); };
    EXPECT_TRUE(residual(sin(x) * sin(x) * sin(x) + cos(x) * cos(x) * sin(x) - sin(x)).is_zero());
    EXPECT_TRUE(residual(sin(x + y) - sin(x) * cos(y) - cos(x) * sin(y)).is_zero());
    EXPECT_TRUE(residual(cos(Expr(3) * x) - Expr(4) * cos(x) * cos(x) * cos(x) + Expr(3) * cos(x)).is_zero());
    EXPECT_TRUE(residual(tan(x) * cos(x) - sin(x)).is_zero());
    EXPECT_FALSE(residual(sin(x) * sin(x) - cos(x) * cos(x)).is_zero());
    EXPECT_FALSE(residual(sin(x) - sin(y)).is_zero());
  }
}

TEST(GinacConverter, DoesNotShowGinacsOrder) {
  Tape tape;
  const Expr a = input(tape, "a");
  const Expr b = input(tape, "b");
  const Expr c = input(tape, "c");
  GinacConverter converter(tape, GinacConverter::Angles::symbols);
  const GiNaC::ex x = converter.to_ginac(a.id(tape));
  const GiNaC::ex y = converter.to_ginac(b.id(tape));
  const GiNaC::ex z = converter.to_ginac(c.id(tape));
  EXPECT_EQ(text(tape, converter.to_tape(x + y - z)), text(tape, ((a + b) - c).id(tape)));
  EXPECT_EQ(converter.to_tape((x - y) * (z - y)), converter.to_tape((y - x) * (y - z)));
  EXPECT_EQ(converter.to_tape((x - y) / (z - y)), converter.to_tape(((y - x) / (y - z)).normal()));
}

TEST(GinacConverter, RefusesSymbolsOfOthers) {
  Tape tape;
  GinacConverter converter(tape, GinacConverter::Angles::symbols);
  EXPECT_THROW(converter.to_tape(GiNaC::symbol("stranger") + 1), std::invalid_argument);
  EXPECT_THROW(converter.to_tape(GiNaC::I), std::invalid_argument);
}

}  // namespace
}  // namespace anholon::convert_test
