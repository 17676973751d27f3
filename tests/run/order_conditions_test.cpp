// SPDX-License-Identifier: GPL-2.0-or-later
//
// Tableaux against every condition of order: one for each rooted tree (Butcher), in quadruple precision.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "anholon/integrate/cooper_verner.hpp"
#include "anholon/integrate/dop853_tableau.hpp"
#include "anholon/integrate/tableau.hpp"

namespace anholon::testing::order_conditions_test {
namespace {

__extension__ using Quad = __float128;  // 113 bits, 34 digits

/// A rooted tree of n vertices: the density gamma and, for each stage, the elementary weight
///   Phi_i = prod over its branches of sum_j a_ij Phi_j(branch)
/// A method of order p has sum_i b_i Phi_i = 1/gamma for every tree of n <= p.
struct Tree {
  int size;
  Quad gamma;
  std::vector<Quad> Phi;
};

using Matrix = std::vector<std::vector<Quad>>;

/// All trees of at most `most` vertices, smaller ones first: 1, 1, 2, 4, 9, 20, 48, 115, 286, ...
std::vector<Tree> trees_up_to(int most, const Matrix& a) {
  std::vector<Tree> trees;
  // Branches are taken in falling order of their number, so that each set of them is met once.
  const auto add = [&](auto& self, int left, std::size_t largest, const Tree& root) -> void {
    if (left == 0) {
      Tree whole = root;
      whole.gamma *= Quad(root.size);
      trees.push_back(whole);
      return;
    }
    for (std::size_t k = 0; k < largest; ++k) {
      if (trees[k].size > left) break;
      Tree grown = root;
      grown.gamma *= trees[k].gamma;
      for (std::size_t i = 0; i < a.size(); ++i) {
        Quad sum = 0;
        for (std::size_t j = 0; j < a[i].size(); ++j) sum += a[i][j] * trees[k].Phi[j];
        grown.Phi[i] *= sum;
      }
      self(self, left - trees[k].size, k + 1, grown);
    }
  };
  for (int n = 1; n <= most; ++n) add(add, n - 1, trees.size(), {n, 1, std::vector<Quad>(a.size(), 1)});
  return trees;
}

/// Largest |sum_i b_i Phi_i - s^n/gamma| of the trees of n vertices, by n.
template <class Weights>
std::vector<double> defects(const std::vector<Tree>& trees, const Weights& b, Quad s = 1) {
  std::vector<double> worst(static_cast<std::size_t>(trees.back().size) + 1, 0);
  for (const Tree& tree : trees) {
    Quad sum = 0, power = 1;
    for (int i = 0; i < tree.size; ++i) power *= s;
    for (std::size_t i = 0; i < b.size(); ++i) sum += b[i] * tree.Phi[i];
    double& largest = worst[static_cast<std::size_t>(tree.size)];
    largest = std::max(largest, std::abs(static_cast<double>(sum - power / tree.gamma)));
  }
  return worst;
}

template <class Row>
void append(Matrix& a, const Row& rows) {
  for (const auto& row : rows) a.emplace_back(row.begin(), row.end());
}

/// c_i = sum_j a_ij, conditions hold up to `order` and no further. 30 digits are given of irrational
/// coefficients, of up to 400 each: 1e-26 is left of them, far below the last digit of long double.
template <class Tableau>
void expect_order(const std::array<Quad, Tableau::stages>& b, int order) {
  Matrix a;
  append(a, Tableau::a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    Quad sum = 0;
    for (const Quad& entry : a[i]) sum += entry;
    EXPECT_LT(std::abs(static_cast<double>(sum - Tableau::c[i])), 1e-26) << "stage " << i;
  }
  const std::vector<double> found = defects(trees_up_to(order + 1, a), b);
  for (int n = 1; n <= order; ++n) EXPECT_LT(found[static_cast<std::size_t>(n)], 1e-26) << n << " vertices";
  EXPECT_GT(found.back(), 1e-7) << "of a higher order than it says";
}

/// b of the embedded solution.
template <class Tableau>
std::array<Quad, Tableau::stages> embedded(const std::array<Quad, Tableau::stages>& difference) {
  std::array<Quad, Tableau::stages> b = Tableau::b;
  for (std::size_t i = 0; i < b.size(); ++i) b[i] -= difference[i];
  return b;
}

TEST(OrderConditions, TreesAreCountedAsCayleyDid) {
  std::vector<int> count(9, 0);
  for (const Tree& tree : trees_up_to(8, {{}})) ++count[static_cast<std::size_t>(tree.size)];
  EXPECT_EQ(count, (std::vector<int>{0, 1, 1, 2, 4, 9, 20, 48, 115}));
}

TEST(OrderConditions, OfTheClassicalMethod) {
  using Tableau = integrate::ClassicalRungeKutta4<Quad>;
  expect_order<Tableau>(Tableau::b, 4);
}

TEST(OrderConditions, OfDormandPrince54) {
  using Tableau = integrate::DormandPrince54<Quad>;
  expect_order<Tableau>(Tableau::b, 5);
  expect_order<Tableau>(embedded<Tableau>(Tableau::error), 4);
}

TEST(OrderConditions, OfCooperVerner8) {
  using Tableau = integrate::CooperVerner8<Quad>;
  expect_order<Tableau>(Tableau::b, 8);
}

TEST(OrderConditions, OfDormandPrince853) {
  using Tableau = integrate::DormandPrince853<Quad>;
  expect_order<Tableau>(Tableau::b, 8);
  expect_order<Tableau>(embedded<Tableau>(Tableau::error), 5);
  expect_order<Tableau>(embedded<Tableau>(Tableau::error_of_order_3), 3);
}

/// The continuous solution at s, and its continuation at the ends: s = 0 gives the start, s = 1 the end.
template <class Tableau>
void expect_continuous(const Matrix& a, int order) {
  const std::vector<Tree> trees = trees_up_to(order + 1, a);
  for (const int s : {1, 3, 5, 8, 9}) {
    SCOPED_TRACE(s);
    const std::vector<double> found = defects(trees, Tableau::weights(Quad(s) / 10), Quad(s) / 10);
    for (int n = 1; n <= order; ++n) EXPECT_LT(found[static_cast<std::size_t>(n)], 1e-24) << n << " vertices";
    EXPECT_GT(found.back(), 1e-9);
  }
  const auto start = Tableau::weights(Quad(0)), end = Tableau::weights(Quad(1));
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_EQ(static_cast<double>(start[i]), 0);
    EXPECT_EQ(static_cast<double>(end[i] - (i < Tableau::b.size() ? Tableau::b[i] : Quad(0))), 0);
  }
}

TEST(OrderConditions, OfTheContinuousSolutions) {
  using Five = integrate::DormandPrince54<Quad>;
  using Eight = integrate::DormandPrince853<Quad>;
  Matrix a;
  append(a, Five::a);
  expect_continuous<Five>(a, 4);
  a.clear();
  append(a, Eight::a);
  append(a, Eight::a_dense);
  expect_continuous<Eight>(a, 7);
}

/// What a decimal constant becomes in each scalar: the nearest number, as the compiler's own literals are.
TEST(Decimal, IsRoundedToTheScalarAtHand) {
  using integrate::operator""_decimal;
  constexpr double small = 8.27378916381402288758473766002e-03_decimal;
  constexpr double large = -4.34898841810699588477366255144e+01_decimal;
  constexpr float quarter = 0.25_decimal;
  constexpr long double tenth = 0.1_decimal;
  EXPECT_EQ(small, 8.27378916381402288758473766002e-03);
  EXPECT_EQ(large, -4.34898841810699588477366255144e+01);
  EXPECT_EQ(quarter, 0.25f);
  EXPECT_EQ(tenth, 0.1L);
  const Quad third = 0.333333333333333333333333333333333333_decimal;
  EXPECT_LT(std::abs(static_cast<double>(third * 3 - 1)), 1e-33);
}

}  // namespace
}  // namespace anholon::testing::order_conditions_test
