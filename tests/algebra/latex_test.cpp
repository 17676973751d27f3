// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/latex.hpp"

#include <gtest/gtest.h>

#include "algebra/tape_samples.hpp"

namespace anholon::latex_test {
namespace {

using test::input;

TEST(LatexName, PutsIndicesBelowAndRatesUnderDots) {
  EXPECT_EQ(latex_name("m_c"), "m_{c}");
  EXPECT_EQ(latex_name("r1"), "r_{1}");
  EXPECT_EQ(latex_name("alpha"), "\\alpha");
  EXPECT_EQ(latex_name("Omega_Z"), "\\Omega_{Z}");
  EXPECT_EQ(latex_name("m_wheel"), "m_{\\mathrm{wheel}}");
  EXPECT_EQ(latex_name("dot(r1)"), "\\dot{r}_{1}");
  EXPECT_EQ(latex_name("r1_ddot"), "\\ddot{r}_{1}");
  EXPECT_EQ(latex_name("mX0"), "\\mathrm{mX}_{0}");
  EXPECT_EQ(latex_name("nu[0]"), "\\nu_{0}");
  EXPECT_EQ(latex_name("r_a_dot[1]"), "\\dot{r}_{a,1}");
  EXPECT_EQ(latex_name("J_w_2"), "J_{w,2}");
}

TEST(Latex, WritesSumsProductsAndPowers) {
  Tape tape;
  const Expr m = input(tape, "m"), l = input(tape, "l"), r1 = input(tape, "r1"), r2 = input(tape, "r2"),
             w = input(tape, "r1_dot");
  const auto written = [&](const Expr& e) { return latex_text(tape, {{e.id(tape)}}).formula; };
  EXPECT_EQ(written(m * l * l * cos(r1) * w), "m l^{2} \\dot{r}_{1} \\cos r_{1}");
  EXPECT_EQ(written(-(m * l)), "-m l");
  EXPECT_EQ(written(-m + l), "l - m");
  EXPECT_EQ(written(m * sin(r1) * sin(r1) + m * cos(r1) * cos(r1)), "m");
  EXPECT_EQ(written(m * (l + r1)), "m \\left(l + r_{1}\\right)");
  EXPECT_EQ(written(Expr(1) / (m + l)), "\\frac{1}{m + l}");
  EXPECT_EQ(written(m / Expr(2)), "\\frac{1}{2} m");
  EXPECT_EQ(written(m / (Expr(2) * l)), "\\frac{m}{2 l}");
  EXPECT_EQ(written(l * sin(r1) * cos(r2) / (cos(r1) * (m + l))), "\\frac{l \\tan r_{1} \\cos r_{2}}{m + l}");
  EXPECT_EQ(written(sqrt(m + l)), "\\sqrt{m + l}");
  EXPECT_EQ(written(Expr(0) * m), "0");
}

TEST(Latex, WritesMatrices) {
  Tape tape;
  const Expr l = input(tape, "l"), r1 = input(tape, "r1");
  const auto H = test::matrix(tape, {{-(l * cos(r1))}, {0}, {sin(r1)}});
  EXPECT_EQ(latex_text(tape, H).formula,
            "\\begin{bmatrix} -l \\cos r_{1} \\\\ 0 \\\\ \\sin r_{1} \\end{bmatrix}");
  LatexNames names;
  names.inputs = {"\\ell", ""};
  EXPECT_EQ(latex_text(tape, H, names).formula,
            "\\begin{bmatrix} -\\ell \\cos r_{1} \\\\ 0 \\\\ \\sin r_{1} \\end{bmatrix}");
}

TEST(Latex, NamesThePartsOfLongFormulas) {
  Tape tape;
  std::vector<Expr> x;
  for (int i = 0; i < 8; ++i) x.push_back(input(tape, "x" + std::to_string(i)));
  Expr product = 1;
  for (int i = 0; i < 7; ++i)
    product = product *
              (x[static_cast<std::size_t>(i)] + sqrt(x[static_cast<std::size_t>(i) + 1] * product + Expr(1)));
  LatexNames names;
  names.entry_size = 12;
  const LatexText text = latex_text(tape, {{product.id(tape)}}, names);
  EXPECT_FALSE(text.definitions.empty());
  EXPECT_LT(text.formula.size(), 400U);
  for (std::size_t i = 0; i < text.definitions.size(); ++i) {
    const std::string own = "k_{" + std::to_string(i + 1) + "} = ";
    EXPECT_EQ(text.definitions[i].substr(0, own.size()), own);
    for (std::size_t later = i; later < text.definitions.size(); ++later) {
      EXPECT_EQ(text.definitions[i].find("k_{" + std::to_string(later + 1) + "}", own.size()),
                std::string::npos);
    }
  }
}

}  // namespace
}  // namespace anholon::latex_test
