// SPDX-License-Identifier: GPL-2.0-or-later
//
// What `explain` prints, read back: every equation of the page has the values of the program at random
// inputs.
#include "emit/equations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "algebra/latex.hpp"
#include "describe/read_model.hpp"
#include "emit/latex_reader.hpp"
#include "tape/interpret.hpp"

namespace anholon::equations_test {
namespace {

struct Page {
  Model model;
  std::unique_ptr<Derivation> derivation;
  std::string text;
};

Page page_of(const std::string& name, const EquationStyle& style = {}) {
  Page page;
  page.model = read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + name + "/" + name + ".toml");
  DeriveRequest request;
  request.functions = equation_functions();
  page.derivation = derive(page.model, request);
  page.text = equations(page.model, *page.derivation, style);
  return page;
}

/// Random values of all inputs, and the same by their LaTeX.
struct Values {
  std::vector<double> inputs;
  test::LatexSymbols<double> symbols;
};

Values random_values(const Page& page, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(0.2, 1.2);  // away from the singular shapes of these models
  const Program& program = page.derivation->program;
  const Partition p = partition_of(page.model);
  const auto components = free_components(page.model.group);
  const auto name_of = [&](int velocity) {
    return page.model.coordinates[static_cast<std::size_t>(velocity - p.n)].name;
  };
  const Kernel& kernel = page.derivation->reduction.kernel;
  const auto free_velocity = [&](std::size_t i, const std::string& suffix) {
    const int velocity = p.passive[static_cast<std::size_t>(kernel.free[i])];
    if (velocity >= p.n) return latex_name(name_of(velocity) + (suffix.empty() ? "_dot" : "_ddot"));
    const int component = components[static_cast<std::size_t>(velocity)];
    return latex_name(std::string(twist_component_names[static_cast<std::size_t>(component)]) + suffix);
  };
  Values values;
  values.inputs.resize(program.tape.inputs().size());
  const auto set = [&](NodeId node, const std::string& latex) {  // what has one name has one value
    const double x = values.symbols.contains(latex) ? values.symbols.at(latex) : uniform(rng);
    values.inputs[program.tape.node(node).a] = x;
    values.symbols[latex] = x;
  };
  for (const ParameterInfo& q : program.parameters) set(q.node, latex_name(q.name));
  for (const InputBlock& b : program.inputs) {
    for (std::size_t i = 0; i < b.nodes.size(); ++i) {
      const std::string number = "_{" + std::to_string(i + 1) + "}";
      const auto passive = [&] { return name_of(p.passive[i + static_cast<std::size_t>(p.n)]); };
      const auto active = [&] { return name_of(p.active[i]); };
      std::string latex = b.name + number;  // blocks that no equation uses
      if (b.name == "r_p") latex = latex_name(passive());
      if (b.name == "r_a") latex = latex_name(active());
      if (b.name == "r_p_dot") latex = latex_name(passive() + "_dot");
      if (b.name == "r_a_dot") latex = latex_name(active() + "_dot");
      if (b.name == "r_a_ddot") latex = latex_name(active() + "_ddot");
      if (b.name == "eta") latex = latex_name(twist_component_names[static_cast<std::size_t>(components[i])]);
      if (b.name == "nu") latex = kernel.content_divided ? "\\nu" + number : free_velocity(i, "");
      if (b.name == "nu_dot")
        latex = kernel.content_divided ? "\\dot{\\nu}" + number : free_velocity(i, "_dot");
      if (b.name == "lambda_stat") latex = "s" + number;
      if (b.name == "g") latex = std::vector{"x", "y", "\\theta"}[i];
      if (b.name == "R") latex = std::string("R_{") + "XYZ"[i / 3] + "XYZ"[i % 3] + "}";
      set(b.nodes[i], latex);
    }
  }
  return values;
}

struct Shown {
  const char* left;
  const char* function;
  const char* block;
};
constexpr Shown all_shown[] = {{"A", "constraints", "A"},
                               {"B_p", "constraints", "B_p"},
                               {"B_a", "constraints", "B_a"},
                               {"N", "constraints", "lambda_stat_basis"},
                               {"H", "kinematics", "H"},
                               {"J", "kinematics", "J"},
                               {"\\mathcal{M}", "free_dynamics", "M_eta_eta"},
                               {"M_p", "free_dynamics", "M_p"},
                               {"M_a", "free_dynamics", "M_a"},
                               {"m_{pp}", "free_dynamics", "m_pp"},
                               {"m_{pa}", "free_dynamics", "m_pa"},
                               {"m_{aa}", "free_dynamics", "m_aa"},
                               {"f", "free_dynamics", "f"},
                               {"Q_p", "free_dynamics", "Q_p"},
                               {"Q_a", "free_dynamics", "Q_a"},
                               {"M_r", "reduced_dynamics", "M_r"},
                               {"f_r", "reduced_dynamics", "f_r"},
                               {"\\tau_a", "inverse_torques", "tau_a"}};

class EquationsOf : public ::testing::TestWithParam<const char*> {};

TEST_P(EquationsOf, ReadBackAsTheProgram) {
  const Page page = page_of(GetParam());
  const Program& program = page.derivation->program;
  std::mt19937_64 rng(40);
  const auto equations = test::equations_of_page(page.text);
  for (int sample = 0; sample < 3; ++sample) {
    Values values = random_values(page, rng);
    int compared = 0;
    for (std::size_t e = 0; e < equations.size(); ++e) {
      const auto* shown = std::ranges::find(all_shown, equations[e].first, &Shown::left);
      if (shown == std::end(all_shown)) continue;
      test::LatexSymbols<double> symbols = values.symbols;
      for (std::size_t k = e + 1; k < equations.size() && equations[k].first.starts_with("k_{"); ++k)
        symbols[equations[k].first] = test::LatexReader<double>(symbols, equations[k].second).read();
      const auto read = test::read_latex_matrix<double>(symbols, equations[e].second);
      for (const Function& f : program.functions) {
        for (const OutputBlock& b : f.outputs) {
          if (f.name != shown->function || b.name != shown->block) continue;
          const std::vector<double> want = interpret<double>(program.tape, b.nodes, values.inputs);
          ASSERT_EQ(read.size(), static_cast<std::size_t>(b.rows)) << equations[e].first;
          double scale = 1e-3;
          for (const double x : want) scale = std::max(scale, std::abs(x));
          for (std::size_t i = 0; i < want.size(); ++i, ++compared)
            // a few hundred operations on each side, in another order
            EXPECT_NEAR(read[i / static_cast<std::size_t>(b.cols)][i % static_cast<std::size_t>(b.cols)],
                        want[i], 1e-11 * scale)
                << equations[e].first << ' ' << i;
        }
      }
    }
    EXPECT_GT(compared, 5);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, EquationsOf,
                         ::testing::Values("mobile_pendulum", "bicycle", "rigid_snakeboard",
                                           "soft_snakeboard", "trailer", "double_pendulum", "wheeled_snake3"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Equations, AreBriefWhereAsked) {
  EquationStyle brief;
  brief.brief = true;
  const std::string text = page_of("bicycle", brief).text;
  for (const auto& [left, right] : test::equations_of_page(text)) {
    EXPECT_LE(right.size(), brief.brief_length) << left;
    EXPECT_FALSE(left.starts_with("k_{"));
  }
  EXPECT_NE(text.find("Too long for this page: $`\\mathcal{M}`$ (6 × 6)"), std::string::npos) << text;
  EXPECT_NE(text.find("\nJ = "), std::string::npos);
}

TEST(Equations, DoNotDependOnTheRun) {
  EXPECT_EQ(page_of("rigid_snakeboard").text, page_of("rigid_snakeboard").text);
}

}  // namespace
}  // namespace anholon::equations_test
