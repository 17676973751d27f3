// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/expression.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tape/interpret.hpp"

namespace anholon::expression_test {
namespace {

class Expression : public ::testing::Test {
 protected:
  Expression() {
    const auto input = [&](const std::string& name, SymbolKind kind, Dimension unit, int value) {
      inputs.emplace_back(value);
      return Symbol{kind, {Expr(tape, tape.input(name)), unit}, "", ""};
    };
    scope.add("l", input("l", SymbolKind::parameter, units::m, 3));
    scope.add("m", input("m", SymbolKind::parameter, units::kg, 5));
    scope.add("n", input("n", SymbolKind::parameter, units::one, 7));
    scope.add("r1", input("r1", SymbolKind::coordinate, units::one, 2));
    scope.add_rate("r1", input("r1_dot", SymbolKind::velocity, units::one / units::s, 11));
  }

  Quantity read(std::string_view text) {
    return read_expression(tape, text, scope,
                           SymbolKind::parameter | SymbolKind::coordinate | SymbolKind::velocity);
  }

  /// Value with l = 3, m = 5, n = 7, r1 = 2, dot(r1) = 11.
  Exact value(std::string_view text) {
    const NodeId root = read(text).value.id(tape);
    return interpret<Exact>(tape, {root}, inputs).front();
  }

  /// "offset: fact; mend"
  std::string error(std::string_view text) {
    try {
      read(text);
    } catch (const ExpressionError& e) {
      return fmt::format("{}: {}; {}", e.offset, e.fact, e.mend);
    }
    return "no error";
  }

  Tape tape;
  Scope scope;
  std::vector<Exact> inputs;
};

TEST_F(Expression, HasThePrecedenceOfArithmetic) {
  EXPECT_EQ(value("1 + 2*3"), Exact(7));
  EXPECT_EQ(value("2*3^2"), Exact(18));
  EXPECT_EQ(value("-2^2"), Exact(-4));
  EXPECT_EQ(value("2^3^2"), Exact(512));
  EXPECT_EQ(value("2^-1"), Exact::ratio(1, 2));
  EXPECT_EQ(value("7 - 2 - 1"), Exact(4));
  EXPECT_EQ(value("12/3/2"), Exact(2));
  EXPECT_EQ(value("-(1 - n)*2"), Exact(12));
  EXPECT_EQ(value("2*-n"), Exact(-14));
  EXPECT_EQ(value("+n"), Exact(7));
  EXPECT_EQ(value(" l\n+\t2 "), Exact(5));
}

TEST_F(Expression, KeepsDecimalsExact) {
  EXPECT_EQ(value("0.1 + 0.2"), Exact::ratio(3, 10));
  EXPECT_EQ(value("1.5e-3"), Exact::ratio(3, 2000));
  EXPECT_EQ(value(".5 + 5."), Exact::ratio(11, 2));
  EXPECT_EQ(value("1E2"), Exact(100));
}

TEST_F(Expression, RaisesToIntegerAndHalfIntegerPowersWithoutExponentials) {
  EXPECT_EQ(value("n^0"), Exact(1));
  EXPECT_EQ(value("n^13"), Exact::from_decimal("96889010407"));
  EXPECT_EQ(value("n^(-2)"), Exact::ratio(1, 49));
  EXPECT_EQ(value("(n + 2)^0.5"), Exact(3));
  EXPECT_EQ(value("(n + 2)^(-3/2)"), Exact::ratio(1, 27));
  for (const Node& node : [&] {
         std::vector<Node> nodes;
         for (NodeId id = 0; id < tape.size(); ++id) nodes.push_back(tape.node(id));
         return nodes;
       }()) {
    EXPECT_NE(node.op, Op::exp);
    EXPECT_NE(node.op, Op::log);
  }
  EXPECT_NEAR(value("n^0.3").to_double(), std::pow(7, 0.3), 1e-15);
  EXPECT_NEAR(value("n^r1").to_double(), 49, 1e-13);
}

TEST_F(Expression, KnowsItsFunctions) {
  EXPECT_EQ(value("sin(pi/6)"), Exact::ratio(1, 2));
  EXPECT_EQ(value("cos(0)"), Exact(1));
  EXPECT_EQ(value("abs(-n) + sign(-n)"), Exact(6));
  EXPECT_EQ(value("sqrt(n + 2)"), Exact(3));
  EXPECT_NEAR(value("tan(0.3) + asin(0.3) + acos(0.2)").to_double(),
              std::tan(0.3) + std::asin(0.3) + std::acos(0.2), 1e-15);
  EXPECT_NEAR(value("atan2(-n, -3) + exp(0.5) + log(n) + tanh(0.2)").to_double(),
              std::atan2(-7, -3) + std::exp(0.5) + std::log(7) + std::tanh(0.2), 1e-14);
  EXPECT_EQ(value("dot(r1)*l"), Exact(33));
}

TEST_F(Expression, FoldsLiteralsIntoStructuralZerosAndOnes) {
  EXPECT_TRUE(read("0").value.is_zero());
  EXPECT_TRUE(read("0*l + sin(0)*m").value.is_zero());
  EXPECT_TRUE(tape.is_one(read("2/4 + 0.5").value.id(tape)));
}

TEST_F(Expression, CarriesUnitsAndLetsNumbersTakeAny) {
  EXPECT_EQ(read("m*l^2").unit, (Dimension{{1, 2, 0}}));
  EXPECT_EQ(read("sqrt(l^2 + l*l)").unit, units::m);
  EXPECT_EQ(read("l + 0.1").unit, units::m);
  EXPECT_EQ(read("l*dot(r1)").unit, (Dimension{{0, 1, -1}}));
  EXPECT_EQ(read("2*l").unit, std::nullopt);
  EXPECT_EQ(error("l + m"), "2: sum of m and kg; all terms of a sum need the same unit");
  EXPECT_EQ(error("l*m - m"), "4: difference of kg m and kg; all terms of a sum need the same unit");
  EXPECT_EQ(error("sin(l)"), "4: sin of a quantity in m; its argument must be a plain number or an angle");
  EXPECT_EQ(error("n^l"), "1: a power in m; the exponent must be a plain number");
  EXPECT_EQ(error("atan2(l, m)"), "7: atan2 of m and kg; both need the same unit");
}

TEST_F(Expression, NamesThePlaceTheFactAndTheWayOut) {
  EXPECT_EQ(error(""), "0: the expression is empty; write a number, a name or a formula");
  EXPECT_EQ(error("   "), "3: the expression is empty; write a number, a name or a formula");
  EXPECT_EQ(error("1 +"), "3: the expression ends where a value is expected; write a number or a name there");
  EXPECT_EQ(error("(1 + 2"), "0: '(' is not closed; add ')'");
  EXPECT_EQ(error("1 + 2)"), "5: ')' closes nothing; remove it or add '('");
  EXPECT_EQ(error("2 l"), "2: 'l' is not expected here; write an operator + - * / ^ between two terms");
  EXPECT_EQ(error("2l"), "1: 'l' is not expected behind a number; write * between factors");
  EXPECT_EQ(error("l ** 2"), "3: '*' is not expected here; write a number or a name there");
  EXPECT_EQ(error("1.2.3"), "0: this is not a number; write digits with at most one '.'");
  EXPECT_EQ(error("1e"), "2: the exponent of this number has no digits; write for example 1e-3");
  EXPECT_EQ(error("ll"), "0: 'll' is not a known name; did you mean 'l'?");
  EXPECT_EQ(error("somewhere"), "0: 'somewhere' is not a known name; known here: l, m, n and r1");
  EXPECT_EQ(error("sinn(1)"), "0: 'sinn' is not a known function; did you mean 'sin'?");
  EXPECT_EQ(error("system(1)"),
            "0: 'system' is not a known function; docs/model-file.md lists the functions");
  EXPECT_EQ(error("l(1)"), "1: 'l' is not a function; write * between factors");
  EXPECT_EQ(error("2*sin"), "2: 'sin' is a function; write sin(...)");
  EXPECT_EQ(error("atan2(1)"), "7: 'atan2' takes two arguments; write atan2(y, x)");
  EXPECT_EQ(error("sin(1, 2)"), "5: 'sin' takes one argument; remove the other");
  EXPECT_EQ(error("dot(2)"), "4: dot takes the name of a coordinate; write for example dot(r1)");
  EXPECT_EQ(error("dot(r2)"), "4: 'r2' is not a coordinate; did you mean 'r1'?");
  EXPECT_EQ(error("dot(r1 + r1)"), "7: dot takes the name of a coordinate; write dot(name)");
  EXPECT_EQ(error("l $ 2"), "2: '$' is not expected here; write an operator + - * / ^ between two terms");
  EXPECT_EQ(error("\xc3\xa9"), "0: the byte \\xc3 is not expected here; write a number or a name there");
  EXPECT_EQ(error("1/(2 - 2)"), "1: division by a constant zero; mend this constant part of the expression");
  EXPECT_EQ(error("sqrt(-4)"),
            "0: square root of a negative number; mend this constant part of the expression");
  EXPECT_EQ(error("log(0)"),
            "0: logarithm of a number that is not positive; mend this constant part of the expression");
}

TEST_F(Expression, RefusesSymbolsThatMayNotStandThere) {
  try {
    read_expression(tape, "l*r1", scope, SymbolKind::parameter);
    FAIL();
  } catch (const ExpressionError& e) {
    EXPECT_EQ(e.offset, 2U);
    EXPECT_EQ(e.fact, "'r1' is a coordinate");
    EXPECT_EQ(e.mend, "only parameters may stand here");
  }
  try {
    read_expression(tape, "dot(r1)", scope, SymbolKind::parameter | SymbolKind::coordinate);
    FAIL();
  } catch (const ExpressionError& e) {
    EXPECT_EQ(e.offset, 0U);
    EXPECT_EQ(e.fact, "'dot(r1)' is a velocity");
    EXPECT_EQ(e.mend, "only parameters and coordinates may stand here");
  }
}

TEST_F(Expression, EndsSoonWhateverTheText) {
  EXPECT_EQ(error("1e999999999"), "0: the number is out of range; numbers lie between 1e-300 and 1e300");
  EXPECT_EQ(error("1e301"), "0: the number is out of range; numbers lie between 1e-300 and 1e300");
  EXPECT_EQ(error("n^1000000"), "1: the exponent is beyond 64; use exp(y*log(x)) if you mean it");
  EXPECT_EQ(error("(9^64)^8"), "6: the number is out of range; numbers lie between 1e-300 and 1e300");
  EXPECT_EQ(error("exp(exp(500))"),
            "0: the exponential is out of range; its argument lies between -600 and 600");
  EXPECT_EQ(error("sin(1e200)"), "0: the angle is out of range; angles lie between -1e6 and 1e6 rad");
  EXPECT_EQ(error("1e200*n*1e200"), "7: the number is out of range; numbers lie between 1e-300 and 1e300");
  EXPECT_EQ(error(std::string(5000, '1')),
            "4096: the expression is longer than 4096 characters; split it with parameters or simplify it");
  EXPECT_EQ(error(std::string(500, '1')), "0: the number has more than 400 digits; round it");
  EXPECT_EQ(error(std::string(2000, '(')), "200: more than 200 levels of nesting; simplify the expression");
  EXPECT_EQ(error(std::string(2000, '-')), "200: more than 200 levels of nesting; simplify the expression");
  std::string tower = "n";
  for (int i = 0; i < 300; ++i) tower += "^2";
  EXPECT_EQ(error(tower), "400: more than 200 levels of nesting; simplify the expression");
  std::string roots = "n";
  for (int i = 0; i < 150; ++i) roots = fmt::format("sqrt({})", roots);
  EXPECT_EQ(error(roots), "no error");
}

}  // namespace
}  // namespace anholon::expression_test
