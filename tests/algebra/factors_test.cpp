// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/factors.hpp"

#include <gtest/gtest.h>

#include <random>

namespace anholon::factors_test {
namespace {

Polynomial random_polynomial(std::mt19937& rng, std::size_t variables, int terms, int degree) {
  Polynomial p;
  for (int t = 0; t < terms; ++t) {
    Monomial monomial(variables, 0);
    for (int d = 0; d < degree; ++d) {
      if (rng() % 3 != 0) ++monomial[rng() % variables];
    }
    p = p + Polynomial::term(monomial, static_cast<int>(rng() % 9) - 4);
  }
  return p;
}

TEST(Gcd, FindsTheCommonFactorOfProducts) {
  std::mt19937 rng(3);
  for (const std::size_t variables : {1U, 3U, 5U, 8U}) {
    for (int sample = 0; sample < 10; ++sample) {
      const Polynomial g = random_polynomial(rng, variables, 5, 4) + Polynomial::variable(0);
      const Polynomial a = random_polynomial(rng, variables, 4, 3) + Polynomial(11);
      const Polynomial b = random_polynomial(rng, variables, 6, 3) + Polynomial(13);
      if (g.is_zero() || a.is_zero() || b.is_zero()) continue;
      const Polynomial found = gcd(g * a, g * b);
      EXPECT_TRUE(divide(g * a, found));
      EXPECT_TRUE(divide(g * b, found));
      EXPECT_TRUE(divide(found, primitive(g)));
      EXPECT_TRUE(gcd(*divide(g * a, found), *divide(g * b, found)).is_constant());
    }
  }
}

TEST(Factors, MultiplyToThePrimitivePart) {
  std::mt19937 rng(5);
  for (const std::size_t variables : {1U, 2U, 4U}) {
    for (int sample = 0; sample < 10; ++sample) {
      const Polynomial p = random_polynomial(rng, variables, 3, 2) + Polynomial(1);
      const Polynomial q = random_polynomial(rng, variables, 3, 3) + Polynomial::variable(0);
      if (p.is_zero() || q.is_zero()) continue;
      const Polynomial whole = p * q * q;
      Polynomial product = 1;
      for (const auto& [factor, exponent] : factors(whole)) {
        EXPECT_EQ(factor, primitive(factor));
        product = product * pow(factor, exponent);
      }
      EXPECT_EQ(product, primitive(whole));
    }
  }
}

TEST(Factors, OfADifferenceOfSquares) {
  const Polynomial x = Polynomial::variable(0);
  const Polynomial y = Polynomial::variable(1);
  const auto found = factors(Polynomial(6) * (x * x - y * y) * x);
  ASSERT_EQ(found.size(), 3U);
  for (const auto& [factor, exponent] : found) {
    EXPECT_EQ(exponent, 1U);
    EXPECT_TRUE(factor == x || factor == x + y || factor == x - y);
  }
}

}  // namespace
}  // namespace anholon::factors_test
