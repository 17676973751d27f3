// SPDX-License-Identifier: GPL-2.0-or-later
//
// The article's equations (40), (41), (44) of the mobile pendulum and (51)-(54) of the bicycle, typed by hand
// with the errata of docs/references.md, against what the generator derives and what `explain` prints of it:
// normal(difference) == 0 with c^2 + s^2 = 1.
#include <gtest/gtest.h>

#include "algebra/latex.hpp"
#include "emit/equations.hpp"
#include "emit/latex_reader.hpp"
#include "mechanics/symbolic_model.hpp"

namespace anholon::article_test {
namespace {

using GiNaC::cos;
using GiNaC::pow;
using GiNaC::sin;
using GiNaC::tan;
using test::ex;
using test::Expressions;

DeriveRequest explained(Inverse inverse, const std::vector<int>& rows) {
  DeriveRequest request;
  request.functions = equation_functions();
  request.inverse = inverse;
  request.leading_rows = rows;
  return request;
}

/// The equations as the page of `explain` shows them, by their left sides.
class ExplainedModel : public test::SymbolicModel {
 public:
  ExplainedModel(const std::string& name, Inverse inverse, const std::vector<int>& rows)
      : SymbolicModel(test::shipped_model(name), explained(inverse, rows)),
        page_(equations(model(), derivation())) {
    for (const ParameterInfo& p : derivation().program.parameters)
      symbols_[latex_name(p.name)] = node(p.node);
    name_inputs("r_p", "r_p", ""), name_inputs("r_a", "r_a", "");
    name_inputs("r_a_dot", "r_a", "_dot"), name_inputs("r_a_ddot", "r_a", "_ddot");
    if (const Expressions s = input("lambda_stat"); !s.empty()) symbols_["s_{1}"] = s[0];
    for (const auto& [left, right] : test::equations_of_page(page_)) shown_[left] = right;
  }

  [[nodiscard]] const std::string& page() const { return page_; }
  /// The page writes the one reduced velocity of these systems as the velocity that it is.
  void name_reduced_velocity(const std::string& nu, const std::string& nu_dot) {
    symbols_[nu] = input("nu").at(0);
    if (const Expressions rates = input("nu_dot"); !rates.empty()) symbols_[nu_dot] = rates[0];
  }
  /// The page's matrix with this left side, read back.
  std::vector<Expressions> shown(const std::string& left) {
    return test::read_latex_matrix<ex>(symbols_, shown_.at(left));
  }

 private:
  /// Coordinates by the names that the description gives them.
  void name_inputs(const std::string& block, const std::string& coordinates, const std::string& suffix) {
    const Expressions entries = input(block);
    const Partition& p = partition();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const int velocity = coordinates == "r_a" ? p.active[i] : p.passive[i + static_cast<std::size_t>(p.n)];
      symbols_[latex_name(model().coordinates[static_cast<std::size_t>(velocity - p.n)].name + suffix)] =
          entries[i];
    }
  }

  std::string page_;
  test::LatexSymbols<ex> symbols_;
  std::map<std::string, std::string> shown_;
};

// ---- mobile pendulum
// -----------------------------------------------------------------------------------------------

class Pendulum : public ExplainedModel {
 public:
  explicit Pendulum(Inverse inverse = Inverse::leading, const std::vector<int>& rows = {0})
      : ExplainedModel("mobile_pendulum", inverse, rows) {
    name_reduced_velocity("\\dot{r}_{3}", "\\ddot{r}_{3}");
  }
  // the article's letters; the description has gravity as a number
  ex m = parameter("m"), l = parameter("l"), R = parameter("R"), J_w = parameter("J_w");
  ex M = parameter("m_c") + 2 * parameter("m_w") + m;
  ex gamma = GiNaC::numeric(981, 100);
  ex r3 = input("r_p").at(0), r3_dot = input("nu").at(0), r3_ddot = input("nu_dot").at(0);
  ex r1_dot = input("r_a_dot").at(0);
  ex r1_ddot = input("r_a_ddot").at(0), r2_ddot = input("r_a_ddot").at(1);

  /// (40), everything on the left.
  [[nodiscard]] ex equation_40() const {
    return m * l * l * r3_ddot + m * l * gamma * sin(r3) + m * l * R * cos(r3) * r1_ddot;
  }
  /// (44) at the antagonist force T.
  [[nodiscard]] std::array<ex, 2> equation_44(const ex& T) const {
    return {(J_w + M * R * R) * r1_ddot + m * R * l * (cos(r3) * r3_ddot - sin(r3) * r3_dot * r3_dot) + R * T,
            J_w * r2_ddot - R * T};
  }
  /// What the article calls the force required by the motion.
  [[nodiscard]] ex required_force() const {
    return M * R * R * r1_ddot + m * R * l * (cos(r3) * r3_ddot - sin(r3) * r3_dot * r3_dot);
  }
};

TEST(ArticlePendulum, HasTheReducedDynamics40) {
  Pendulum s;
  const ex derived =
      s.output("reduced_dynamics", "M_r")(0, 0) * s.r3_ddot - s.output("reduced_dynamics", "f_r")(0, 0);
  EXPECT_TRUE(s.vanishes(derived - s.equation_40()));
  const ex shown = s.shown("M_r")[0][0] * s.r3_ddot - s.shown("f_r")[0][0];
  EXPECT_TRUE(s.vanishes(shown - s.equation_40()));
}

TEST(ArticlePendulum, IsReconstructedBy41AndHasTheKinematicModel38) {
  Pendulum s;
  EXPECT_TRUE(s.vanishes(s.output("kinematics", "eta")(0, 0) - s.R * s.r1_dot));
  const auto J = s.shown("J"), H = s.shown("H");
  const ex expected_J[2][2] = {{s.R, 0}, {0, 0}}, expected_H[2] = {0, 1};
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(s.vanishes(H[i][0] - expected_H[i])) << i;
    for (std::size_t j = 0; j < 2; ++j) EXPECT_TRUE(s.vanishes(J[i][j] - expected_J[i][j])) << i << ' ' << j;
  }
}

TEST(ArticlePendulum, TakesTheTorques44) {
  Pendulum s;
  const ex lambda_stat = s.input("lambda_stat").at(0);
  const Matrix<ex> N = s.output("constraints", "lambda_stat_basis");
  EXPECT_TRUE(s.vanishes(N(0, 0) + N(1, 0)));  // (43)
  const auto expected = s.equation_44(N(0, 0) * lambda_stat);
  const Matrix<ex> tau = s.output("inverse_torques", "tau_a");
  const auto shown = s.shown("\\tau_a");
  for (int i = 0; i < 2; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_TRUE(s.vanishes(tau(i, 0) - expected[at])) << i;
    EXPECT_TRUE(s.vanishes(shown[at][0] - expected[at])) << i;
  }
}

/// The text below (44): the choices of T, where both wheels turn alike.
TEST(ArticlePendulum, SharesTheLoadAsTheChoicesOfTSay) {
  struct Choice {
    Inverse inverse;
    std::vector<int> rows;
    GiNaC::numeric share;  // of X that goes to the rear wheel
  };
  for (const Choice& choice : {Choice{Inverse::leading, {0}, 0}, Choice{Inverse::leading, {1}, 1},
                               Choice{Inverse::pseudo, {}, GiNaC::numeric(1, 2)}}) {
    Pendulum s(choice.inverse, choice.rows);
    const auto expected = s.equation_44(-choice.share * s.required_force() / s.R);
    const auto shown = s.shown("\\tau_a");
    for (std::size_t i = 0; i < 2; ++i) {
      const ex difference =
          (shown[i][0] - expected[i]).subs(s.r2_ddot == s.r1_ddot).subs(s.input("lambda_stat")[0] == 0);
      EXPECT_TRUE(s.vanishes(difference)) << choice.share << ' ' << i;
    }
  }
}

/// What the comparison must find: a sign, a lost term, cosine for sine.
TEST(ArticlePendulum, DiffersFromWrongEquations) {
  Pendulum s;
  const ex derived = s.shown("M_r")[0][0] * s.r3_ddot - s.shown("f_r")[0][0];
  EXPECT_FALSE(s.vanishes(derived - s.equation_40() + 2 * s.m * s.l * s.gamma * sin(s.r3)));
  EXPECT_FALSE(s.vanishes(derived - s.equation_40().subs(cos(s.r3) == sin(s.r3))));
  const auto wrong_sign =
      s.equation_44(-s.output("constraints", "lambda_stat_basis")(0, 0) * s.input("lambda_stat")[0]);
  EXPECT_FALSE(s.vanishes(s.shown("\\tau_a")[0][0] - wrong_sign[0]));  // the printed sign of (27), erratum 1
  const ex cart_alone = s.M - 2 * s.parameter("m_w");
  EXPECT_FALSE(s.vanishes(s.shown("\\tau_a")[0][0] - s.equation_44(0)[0].subs(s.M == cart_alone)));
}

TEST(ArticlePendulum, IsExplainedInCompactForm) {
  const std::string page = Pendulum().page();
  for (const char* line : {
           "\\begin{bmatrix} V_{X} \\\\ \\dot{r}_{3} \\end{bmatrix} = J \\begin{bmatrix} \\dot{r}_{1} \\\\ "
           "\\dot{r}_{2} \\end{bmatrix} + H \\begin{bmatrix} \\dot{r}_{3} \\end{bmatrix}",
           "H = \\begin{bmatrix} 0 \\\\ 1 \\end{bmatrix}",
           "J = \\begin{bmatrix} R & 0 \\\\ 0 & 0 \\end{bmatrix}",
           "M_r = l^{2} m",
           "f_r = -l m \\left(R \\ddot{r}_{1} \\cos r_{3} + 9.81 \\sin r_{3}\\right)",
           "\\tau_a = \\begin{bmatrix} J_{w} \\ddot{r}_{1} + R \\left(R \\ddot{r}_{1} \\left(m_{c} + 2 m_{w} "
           "+ "
           "m\\right) - l m \\left(\\dot{r}_{3}^{2} \\sin r_{3} - \\ddot{r}_{3} \\cos r_{3}\\right) - "
           "s_{1}\\right) \\\\ J_{w} \\ddot{r}_{2} + R s_{1} \\end{bmatrix}",
       })
    EXPECT_NE(page.find(std::string("```math\n") + line + "\n```\n"), std::string::npos) << line << "\n"
                                                                                         << page;
}

// ---- bicycle
// -------------------------------------------------------------------------------------------------------

class Bicycle : public ExplainedModel {
 public:
  Bicycle() : ExplainedModel("bicycle", Inverse::pseudo, {}) {
    name_reduced_velocity("\\Omega_{Y}", "\\dot{\\Omega}_{Y}");
  }
  ex h = parameter("h"), l2 = parameter("l2"), l3 = parameter("l3"), alpha = parameter("alpha");
  ex r1 = input("r_a").at(0);
  ex r1_dot = input("r_a_dot").at(0), r3_dot = input("r_a_dot").at(1), Omega_Y = input("nu").at(0);
  ex psi = h * cos(alpha) * tan(r1) / (l2 + l3);  // (52)

  [[nodiscard]] Expressions equation_51() const {
    return {0, h * r3_dot, psi * l3 * r3_dot, psi * r3_dot, Omega_Y, 0};
  }
  [[nodiscard]] ex equation_53() const {
    return (cos(r1) + pow(cos(alpha), 2) * sin(r1) * tan(r1)) * r3_dot -
           sin(alpha) * cos(alpha) * sin(r1) * r1_dot;
  }
  /// J_ext above J_int, (54).
  [[nodiscard]] std::array<std::array<ex, 2>, 7> J_54() const {
    return {{{0, 0},
             {0, h},
             {0, psi * l3},
             {0, psi},
             {0, 0},
             {0, 0},
             {-sin(alpha) * cos(alpha) * sin(r1), cos(r1) + pow(cos(alpha), 2) * sin(r1) * tan(r1)}}};
  }
};

TEST(ArticleBicycle, HasTheNetVelocities51With52) {
  Bicycle s;
  const Matrix<ex> eta = s.output("kinematics", "eta");
  for (int i = 0; i < 6; ++i)
    EXPECT_TRUE(s.vanishes(eta(i, 0) - s.equation_51()[static_cast<std::size_t>(i)])) << i;
}

TEST(ArticleBicycle, TurnsItsFrontWheelBy53) {
  Bicycle s;
  EXPECT_TRUE(s.vanishes(s.output("kinematics", "r_p_dot")(0, 0) - s.equation_53()));
}

TEST(ArticleBicycle, HasTheKinematicModel54) {
  Bicycle s;
  const auto expected = s.J_54();
  const auto J = s.shown("J"), H = s.shown("H");
  const Matrix<ex> derived = s.output("kinematics", "J");
  ASSERT_EQ(J.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_TRUE(s.vanishes(H[i][0] - (i == 4 ? 1 : 0))) << i;
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_TRUE(s.vanishes(J[i][j] - expected[i][j])) << i << ' ' << j;
      EXPECT_TRUE(s.vanishes(derived(static_cast<int>(i), static_cast<int>(j)) - expected[i][j]))
          << i << ' ' << j;
    }
  }
}

TEST(ArticleBicycle, DiffersFromWrongEquations) {
  Bicycle s;
  const auto J = s.shown("J");
  EXPECT_FALSE(s.vanishes(J[3][1] - s.h * cos(s.alpha) * tan(s.r1) / (s.l2 - s.l3)));
  EXPECT_FALSE(s.vanishes(J[6][1] - (cos(s.r1) + cos(s.alpha) * sin(s.r1) * tan(s.r1))));  // c for c^2
  EXPECT_FALSE(s.vanishes(J[6][0] - s.J_54()[6][0] * 2));
}

TEST(ArticleBicycle, IsExplainedInCompactForm) {
  const std::string page = Bicycle().page();
  for (const char* line : {
           "H = \\begin{bmatrix} 0 \\\\ 0 \\\\ 0 \\\\ 0 \\\\ 1 \\\\ 0 \\\\ 0 \\end{bmatrix}",
       })
    EXPECT_NE(page.find(std::string("```math\n") + line + "\n```\n"), std::string::npos) << line << "\n"
                                                                                         << page;
}

}  // namespace
}  // namespace anholon::article_test
