// SPDX-License-Identifier: GPL-2.0-or-later
// Derivatives on the tape against difference quotients in 128 digits and against closed forms.

#include "tape/derivative.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "emit/random_program.hpp"
#include "tape/interpret.hpp"

namespace anholon::derivative_test {
namespace {

Exact value(const Tape& tape, NodeId root, const std::vector<Exact>& at) {
  return interpret<Exact>(tape, {root}, at).front();
}

/// (f(x + h) - f(x - h)) / 2h with h = 1e-30: the error is of order h^2 = 1e-60 times the third derivative.
Exact difference_quotient(const Tape& tape, NodeId root, std::vector<Exact> at,
                          const std::vector<Exact>& along) {
  const Exact h = Exact::from_decimal("1e-30");
  std::vector<Exact> back(at);
  for (std::size_t i = 0; i < at.size(); ++i) {
    at[i] += h * along[i];
    back[i] -= h * along[i];
  }
  return (value(tape, root, at) - value(tape, root, back)) / (Exact(2) * h);
}

TEST(Derivative, OfEveryOperationIsTheLimitOfDifferenceQuotients) {
  for (const OpInfo& op : op_table) {
    if (op.arity == 0) continue;
    SCOPED_TRACE(std::string(op.name));
    Tape tape;
    const NodeId x = tape.input("x");
    const NodeId y = tape.input("y");
    // an inner function, so that the chain rule takes part; arguments stay in (0, 1), inside every domain
    const NodeId a = tape.apply(Op::mul, tape.apply(Op::mul, x, y), tape.constant(Exact::ratio(1, 2)));
    const NodeId b = tape.apply(Op::add, y, tape.apply(Op::mul, x, x));
    const NodeId root = tape.apply(op.op, a, op.arity == 2 ? b : 0);
    for (const auto& [u, v] : {std::pair{"0.7", "0.9"}, std::pair{"0.25", "1.5"}}) {
      const std::vector<Exact> at = {Exact::from_decimal(u), Exact::from_decimal(v)};
      const Exact by_x = value(tape, derivative(tape, root, x), at);
      const Exact by_y = value(tape, derivative(tape, root, y), at);
      const Exact bound = Exact::from_decimal("1e-55");
      EXPECT_LE(abs(by_x - difference_quotient(tape, root, at, {1, 0})), bound);
      EXPECT_LE(abs(by_y - difference_quotient(tape, root, at, {0, 1})), bound);
    }
  }
}

TEST(Derivative, AlongADirectionOfRandomProgramsIsTheLimitOfDifferenceQuotients) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Program program = test::random_program({}, seed);
    Tape& tape = program.tape;
    test::Dice dice(seed + 100);
    std::vector<Exact> at;
    std::vector<Exact> along;
    std::vector<std::pair<NodeId, NodeId>> direction;
    for (std::size_t i = 0; i < tape.inputs().size(); ++i) {
      at.push_back(Exact::ratio(static_cast<long>(dice.below(200)) + 1, 101));
      along.push_back(Exact::ratio(static_cast<long>(dice.below(7)) - 3, 2));
      direction.emplace_back(tape.input_node(i), tape.constant(along.back()));
    }
    const std::vector<NodeId> roots = program.functions.front().outputs.front().nodes;
    const std::vector<NodeId> tangents = directional_derivative(tape, roots, direction);
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const Exact tangent = value(tape, tangents[i], at);
      const Exact quotient = difference_quotient(tape, roots[i], at, along);
      EXPECT_LE(abs(tangent - quotient), Exact::from_decimal("1e-40") * (Exact(1) + abs(tangent)));
    }
  }
}

TEST(Derivative, TakesClosedForms) {
  Tape tape;
  const Expr x(tape, tape.input("x"));
  const Expr y(tape, tape.input("y"));
  const auto d = [&](const Expr& f) { return derivative(tape, f.id(tape), x.id(tape)); };
  EXPECT_EQ(d(sin(x)), cos(x).id(tape));
  EXPECT_EQ(d(cos(x)), (-sin(x)).id(tape));
  EXPECT_EQ(d(x * x), (2 * x).id(tape));
  EXPECT_EQ(d(x * y), y.id(tape));
  EXPECT_EQ(d(exp(x)), exp(x).id(tape));
  EXPECT_EQ(d(log(x)), (Expr(1) / x).id(tape));
  EXPECT_EQ(d(y * sin(y)), tape.constant(0));
}

TEST(Derivative, MakesNoNodesForZeroTangents) {
  Tape tape;
  const Expr x(tape, tape.input("x"));
  const Expr y(tape, tape.input("y"));
  const Expr f = sin(y) * exp(y) + x;
  (void)f.id(tape);
  const std::size_t before = tape.size();
  EXPECT_EQ(derivative(tape, f.id(tape), x.id(tape)), tape.constant(1));
  EXPECT_EQ(tape.size(), before);
}

}  // namespace
}  // namespace anholon::derivative_test
