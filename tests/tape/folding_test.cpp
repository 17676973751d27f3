// SPDX-License-Identifier: GPL-2.0-or-later
// Folding on the tape never changes a value: random expressions, folded against computed as written.

#include <gtest/gtest.h>

#include <optional>

#include "emit/random_program.hpp"
#include "tape/expr.hpp"
#include "tape/interpret.hpp"

namespace anholon::folding_test {
namespace {

struct Written {
  Op op;
  std::size_t a, b;
};

constexpr std::size_t inputs = 3;
const Exact constants[] = {0, 1, -1, 2, Exact::ratio(1, 2), Exact::ratio(-3, 4)};
constexpr std::size_t leaves = inputs + std::size(constants);

/// Values of the expression as written, step by step; nothing where it leaves a domain.
std::optional<std::vector<Exact>> as_written(const std::vector<Written>& list, const std::vector<Exact>& at) {
  std::vector<Exact> values(at);
  values.insert(values.end(), std::begin(constants), std::end(constants));
  try {
    for (const Written& w : list) {
      // what should be 0 and is rounding noise must not be divided by
      const Exact& divisor = w.op == Op::div ? values[w.b] : values.front();
      if (w.op == Op::div && !divisor.is_zero() && abs(divisor) < Exact::from_decimal("1e-40"))
        return std::nullopt;
      if (w.op == Op::sqrt && !values[w.a].is_zero() && abs(values[w.a]) < Exact::from_decimal("1e-40"))
        return std::nullopt;
      if (w.op == Op::sign && !values[w.a].is_zero() && abs(values[w.a]) < Exact::from_decimal("1e-40"))
        return std::nullopt;
      values.push_back(apply(w.op, values[w.a], info(w.op).arity == 2 ? values[w.b] : Exact(0)));
      if (abs(values.back()) > Exact(1000000)) return std::nullopt;  // keeps the comparison well conditioned
    }
  } catch (const std::domain_error&) {
    return std::nullopt;
  }
  return values;
}

/// The last value through the tape; nothing where making or computing it leaves a domain.
std::optional<Exact> folded(const std::vector<Written>& list, const std::vector<Exact>& at) {
  try {
    Tape tape;
    std::vector<NodeId> nodes;
    for (std::size_t i = 0; i < inputs; ++i)
      nodes.push_back(tape.input(std::string(1, static_cast<char>('a' + i))));
    for (const Exact& c : constants) nodes.push_back(tape.constant(c));
    for (const Written& w : list)
      nodes.push_back(tape.apply(w.op, nodes[w.a], info(w.op).arity == 2 ? nodes[w.b] : 0));
    return interpret<Exact>(tape, {nodes.back()}, at).front();
  } catch (const std::domain_error&) {
    return std::nullopt;
  }
}

/// @return number of samples that were compared
int compare(const std::vector<Op>& ops, const Exact& tolerance, std::uint64_t seed, int samples) {
  test::Dice dice(seed);
  int compared = 0;
  for (int sample = 0; sample < samples; ++sample) {
    std::vector<Written> list;
    const std::size_t length = 3 + dice.below(8);
    for (std::size_t i = 0; i < length; ++i) {
      const std::size_t size = leaves + list.size();
      const auto operand = [&] {  // mostly recent values, so that folds meet folds
        return list.empty() || dice.below(3) == 0
                   ? dice.below(leaves)
                   : size - 1 - dice.below(std::min<std::size_t>(4, list.size()));
      };
      const std::size_t a = operand();
      list.push_back({ops[dice.below(ops.size())], a, operand()});
    }
    std::vector<Exact> at;
    for (std::size_t i = 0; i < inputs; ++i) {
      at.push_back(Exact::ratio(static_cast<long>(dice.below(13)) - 6, static_cast<long>(dice.below(4)) + 1));
    }
    const auto expected = as_written(list, at);
    if (!expected) continue;
    ++compared;
    const auto value = folded(list, at);
    if (!value) {
      ADD_FAILURE() << "sample " << sample << ": folding left a domain that the expression stays in";
      continue;
    }
    const Exact error = abs(*value - expected->back());
    EXPECT_LE(error, tolerance) << "sample " << sample << ": " << value->decimal(20) << " instead of "
                                << expected->back().decimal(20);
  }
  return compared;
}

TEST(Folding, KeepsRationalExpressionsExactly) {
  const int compared =
      compare({Op::add, Op::sub, Op::mul, Op::div, Op::neg, Op::abs, Op::sign}, 0, 20130922, 20000);
  EXPECT_GT(compared, 8000);
}

TEST(Folding, KeepsEveryFunctionToTheWorkingDigits) {
  // values below 1e6 with 128 digits, divisors above 1e-40: 40 digits are left after any ten steps
  const int compared = compare({Op::add,  Op::sub, Op::mul,  Op::div,  Op::neg,   Op::abs, Op::sign, Op::sin,
                                Op::cos,  Op::tan, Op::asin, Op::acos, Op::atan2, Op::exp, Op::log,  Op::tanh,
                                Op::sqrt, Op::mul, Op::sub,  Op::add,  Op::sin,   Op::cos},
                               Exact::from_decimal("1e-40"), 4711, 6000);
  EXPECT_GT(compared, 1500);
}

class FoldsTo : public ::testing::Test {
 protected:
  Tape tape;
  Expr x{tape, tape.input("x")}, y{tape, tape.input("y")};
  [[nodiscard]] NodeId id(const Expr& e) { return e.id(tape); }
};

TEST_F(FoldsTo, TheSameNodeWhicheverOperandComesFirst) {
  EXPECT_EQ(id(x + y), id(y + x));
  EXPECT_EQ(id(x * y), id(y * x));
  EXPECT_EQ(id((x + y) * (x - y)), id((x - y) * (y + x)));
  EXPECT_EQ(id(-x + -y), id(-y + -x));
}

TEST_F(FoldsTo, NothingWhereNothingIsLeft) {
  EXPECT_TRUE((x - x).is_zero());
  EXPECT_TRUE((x * 0).is_zero());
  EXPECT_TRUE((x + (-x)).is_zero());
  EXPECT_TRUE((2 * x - x - x).is_zero());
  EXPECT_EQ(id(x + y - y), id(x));
  EXPECT_EQ(id(x - y + y), id(x));
  EXPECT_EQ(id(x - (x - y)), id(y));
  EXPECT_EQ(id(x * y / y), id(x));
  EXPECT_EQ(id(x / y * y), id(x));
  EXPECT_EQ(id(x / x), id(Expr(1)));
  EXPECT_EQ(id(-(-x)), id(x));
  EXPECT_EQ(id(-(x - y)), id(y - x));
  EXPECT_EQ(id(sin(x) * sin(x) + cos(x) * cos(x)), id(Expr(1)));
  EXPECT_EQ(id(sqrt(x) * sqrt(x)), id(x));
}

TEST_F(FoldsTo, SignsThatMoveOutOfProductsAndFunctions) {
  EXPECT_EQ(id((-x) * y), id(-(x * y)));
  EXPECT_EQ(id((-x) * (-y)), id(x * y));
  EXPECT_EQ(id(x + (-y)), id(x - y));
  EXPECT_EQ(id(sin(-x)), id(-sin(x)));
  EXPECT_EQ(id(cos(-x)), id(cos(x)));
  EXPECT_EQ(id(Expr(-2) * x), id(-(2 * x)));
}

TEST_F(FoldsTo, ExactConstants) {
  EXPECT_EQ(id(Expr(1) / 3 + Expr(1) / 6), id(Expr(1) / 2));
  EXPECT_EQ(id(2 * (3 * x)), id(6 * x));
  EXPECT_EQ(id(1 + (2 + x)), id(3 + x));
  EXPECT_EQ(id(x / 4), id(x * (Expr(1) / 4)));
  EXPECT_EQ(id(2 * x + 3 * x), id(5 * x));
  EXPECT_THROW((void)(x / (y - y)), std::domain_error);
}

TEST_F(FoldsTo, SimpleNumbersThatIrrationalOnesMake) {
  const auto root = [&](const Exact& of) { return sqrt(Expr(tape, tape.constant(of))); };
  const Expr h = root(Exact::ratio(1, 2)), w = root(Exact::ratio(3, 4));
  EXPECT_EQ(id((h * h) * x), id(x / 2));
  EXPECT_EQ(id(x * (h * h - Expr(1) / 2) + y), id(y));
  EXPECT_EQ(id(w * w * x), id((Expr(3) / 4) * x));
  EXPECT_EQ(id(h * x - h * x), id(Expr(0)));
  EXPECT_NE(id(h * x), id(Expr(0)));
}

TEST(StructuralKeys, AgreeExactlyForEqualNodes) {
  const Program forwards = test::random_program({4, 6, 400, 5, 40}, 3, false);
  const Program backwards = test::random_program({4, 6, 400, 5, 40}, 3, true);
  ASSERT_EQ(forwards.tape.size(), backwards.tape.size());
  std::vector<StructuralKey> a, b;
  for (NodeId id = 0; id < forwards.tape.size(); ++id)
    a.push_back(forwards.tape.key(id)), b.push_back(backwards.tape.key(id));
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  EXPECT_EQ(a, b);
  EXPECT_EQ(std::unique(a.begin(), a.end()), a.end()) << "two nodes share a key";
}

}  // namespace
}  // namespace anholon::folding_test
