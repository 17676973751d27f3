// SPDX-License-Identifier: GPL-2.0-or-later
#include "emit/equations.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>
#include <vector>

#include "algebra/latex.hpp"

namespace anholon {
namespace {

/// LaTeX of every input of the program: coordinates by their names in the description.
class InputNames {
 public:
  InputNames(const Model& model, const Derivation& derivation)
      : model_(model),
        program_(derivation.program),
        partition_(partition_of(model)),
        reduction_(derivation.reduction) {
    const Program& program = program_;
    const std::vector<int>& moved = reduction_.partition.active;  // by an imposed motion
    names_.inputs.resize(program.tape.inputs().size());
    const std::vector<int> r_p(partition_.passive.begin() + partition_.n, partition_.passive.end());
    const std::vector<int>& r_a = partition_.active;
    const auto components = free_components(model.group);
    for (const InputBlock& b : program.inputs) {
      if (b.name == "r_p") each(b, [&](std::size_t i) { return coordinate(r_p[i], ""); });
      if (b.name == "r_a") each(b, [&](std::size_t i) { return coordinate(r_a[i], ""); });
      if (b.name == "r_p_dot") each(b, [&](std::size_t i) { return coordinate(r_p[i], "\\dot"); });
      if (b.name == "r_a_dot") each(b, [&](std::size_t i) { return coordinate(moved[i], "\\dot"); });
      if (b.name == "r_a_ddot") each(b, [&](std::size_t i) { return coordinate(moved[i], "\\ddot"); });
      if (b.name == "eta") each(b, [&](std::size_t i) { return component(components[i]); });
      if (b.name == "nu") each(b, [&](std::size_t i) { return reduced_velocity(i, ""); });
      if (b.name == "nu_dot") each(b, [&](std::size_t i) { return reduced_velocity(i, "_dot"); });
      if (b.name == "lambda_stat") each(b, [](std::size_t i) { return fmt::format("s_{{{}}}", i + 1); });
      if (b.name == "g") each(b, [](std::size_t i) { return std::vector{"x", "y", "\\theta"}[i]; });
      if (b.name == "R")
        each(b, [](std::size_t i) { return fmt::format("R_{{{}{}}}", "XYZ"[i / 3], "XYZ"[i % 3]); });
    }
  }

  [[nodiscard]] const LatexNames& names() const { return names_; }

  /// Velocities of the partition's index as LaTeX: V_{X}, \dot{r}_{1}.
  [[nodiscard]] std::string velocity(int index) const {
    return index < partition_.n ? component(free_components(model_.group)[static_cast<std::size_t>(index)])
                                : coordinate(index, "\\dot");
  }

  /// Entry of nu, or of its derivative (suffix "_dot"): the velocity that it is, where it is one.
  [[nodiscard]] std::string reduced_velocity(std::size_t i, const std::string& suffix) const {
    if (reduction_.kernel.content_divided)
      return fmt::format("{}_{{{}}}", suffix.empty() ? "\\nu" : "\\dot{\\nu}", i + 1);
    const int index = reduction_.partition.passive[static_cast<std::size_t>(reduction_.kernel.free[i])];
    const std::string name = velocity_names(model_)[static_cast<std::size_t>(index)];
    return latex_name(name + (index < partition_.n ? suffix : suffix.empty() ? "_dot" : "_ddot"));
  }

 private:
  template <class Text>
  void each(const InputBlock& block, const Text& text) {
    for (std::size_t i = 0; i < block.nodes.size(); ++i)
      names_.inputs[program_.tape.node(block.nodes[i]).a] = text(i);
  }
  [[nodiscard]] static std::string component(int index) {
    return latex_name(twist_component_names[static_cast<std::size_t>(index)]);
  }
  [[nodiscard]] std::string coordinate(int velocity, const std::string& accent) const {
    const std::string& name = model_.coordinates[static_cast<std::size_t>(velocity - partition_.n)].name;
    if (accent.empty()) return latex_name(name);
    return latex_name(name + (accent == "\\dot" ? "_dot" : "_ddot"));
  }

  const Model& model_;
  const Program& program_;
  Partition partition_;  // of the description
  const ReductionReport& reduction_;
  LatexNames names_;
};

class Page {
 public:
  Page(const Model& model, const Derivation& derivation, const EquationStyle& style)
      : program_(derivation.program), inputs_(model, derivation), style_(style) {}

  void text(const std::string& line) { text_ += line + "\n\n"; }
  void math(const std::string& formula) { text_ += fmt::format("```math\n{}\n```\n\n", formula); }

  /// A section with the equations `left = block` of a function, if the program has it.
  void section(const std::string& title, const std::string& function,
               const std::vector<std::pair<std::string, std::string>>& blocks,
               const std::string& first = "") {
    for (const Function& f : program_.functions) {
      if (f.name != function) continue;
      text(style_.heading + " " + title);
      if (!first.empty()) math(first);
      std::vector<std::string> sizes;
      for (const auto& [name, left] : blocks) {
        for (const OutputBlock& b : f.outputs) {
          if (b.name == name && !equation(left, b)) sizes.push_back(size_of(left, b));
        }
      }
      if (!sizes.empty()) text(fmt::format("Too long for this page: {}.", fmt::join(sizes, ", ")));
    }
  }

  /// Column of velocities: "\begin{bmatrix} V_{X} \\ \dot{r}_{3} \end{bmatrix}".
  [[nodiscard]] std::string column(const std::vector<int>& velocities) const {
    std::vector<std::string> rows;
    for (const int i : velocities) rows.push_back(inputs_.velocity(i));
    return fmt::format("\\begin{{bmatrix}} {} \\end{{bmatrix}}", fmt::join(rows, " \\\\ "));
  }

  /// nu as a column; just \nu where its entries have no names of their own.
  [[nodiscard]] std::string reduced_velocities(const Kernel& kernel) const {
    if (kernel.content_divided) return "\\nu";
    std::vector<std::string> rows;
    for (std::size_t i = 0; i < kernel.free.size(); ++i) rows.push_back(inputs_.reduced_velocity(i, ""));
    return fmt::format("\\begin{{bmatrix}} {} \\end{{bmatrix}}", fmt::join(rows, " \\\\ "));
  }
  [[nodiscard]] std::string take() {
    text_.pop_back();  // one line end is enough
    return std::move(text_);
  }

 private:
  /// Writes an equation with its definitions; in a brief page only if it is short.
  bool equation(const std::string& left, const OutputBlock& block) {
    std::vector<std::vector<NodeId>> rows;
    for (int i = 0; i < block.rows; ++i) {
      rows.emplace_back(block.nodes.begin() + static_cast<std::ptrdiff_t>(i) * block.cols,
                        block.nodes.begin() + static_cast<std::ptrdiff_t>(i + 1) * block.cols);
    }
    const LatexText latex = latex_text(program_.tape, rows, inputs_.names());
    if (style_.brief && (!latex.definitions.empty() || latex.formula.size() > style_.brief_length))
      return false;
    math(left + " = " + latex.formula);
    if (latex.definitions.empty()) return true;
    text("with");
    for (const std::string& d : latex.definitions) math(d);
    return true;
  }
  static std::string size_of(const std::string& left, const OutputBlock& block) {
    return fmt::format("$`{}`$ ({} × {})", left, block.rows, block.cols);
  }

  const Program& program_;
  InputNames inputs_;
  EquationStyle style_;
  std::string text_;
};

}  // namespace

std::vector<std::string> equation_functions() {
  return {"kinematics",       "constraints",     "free_dynamics",
          "reduced_dynamics", "inverse_torques", "compatibility"};
}

std::string equations(const Model& model, const Derivation& derivation, const EquationStyle& style) {
  const ReductionReport& r = derivation.reduction;
  const Partition& p = r.partition;
  const int k = r.kernel.H.cols();
  Page page(model, derivation, style);

  page.text(
      fmt::format("Group {}, $`n = {}`$, $`s_p = {}`$, $`s_a = {}`$; {} constraint rows, $`m = {}`$, "
                  "$`m^\\circ = {}`$. Table I: {}.",
                  name(model.group), p.n, p.s_p(), p.s_a(), r.ranks.rows, r.ranks.m, r.ranks.m_locked,
                  r.ranks.table_I_class(p)));
  const auto sum = [](const std::string& a, const std::string& b) {
    return a.empty() ? b : b.empty() ? a : a + " + " + b;
  };
  const std::string passive = p.passive.empty() ? "" : page.column(p.passive);
  const std::string active = p.active.empty() ? "" : page.column(p.active);
  if (r.ranks.rows > 0) {
    std::vector<int> eta(p.passive.begin(), p.passive.begin() + p.n),
        r_p(p.passive.begin() + p.n, p.passive.end());
    page.section(
        "Constraints, eq. (2)", "constraints",
        {{"A", "A"}, {"B_p", "B_p"}, {"B_a", "B_a"}, {"lambda_stat_basis", "N"}},
        sum(sum(eta.empty() ? "" : "A " + page.column(eta), r_p.empty() ? "" : "B_p " + page.column(r_p)),
            active.empty() ? "" : "B_a " + active) +
            " = 0");
  }
  const std::string motion = sum(active.empty() || r.ranks.rows == 0 ? "" : "J " + active,
                                 k == 0 ? "" : "H " + page.reduced_velocities(r.kernel));
  page.section("Kinematic model, eq. (11)", "kinematics", {{"H", "H"}, {"J", "J"}},
               passive + " = " + (motion.empty() ? "0" : motion));
  page.text("Kernel: " + r.kernel.description + ".");
  if (r.charts.size() > 1) {
    std::string others;
    for (std::size_t c = 1; c < r.charts.size(); ++c)
      others += fmt::format("{}chart {}: {}", c > 1 ? "; " : "", c + 1, r.charts[c].description);
    page.text("No basis serves everywhere: this is chart 1 of " + std::to_string(r.charts.size()) + "; " +
              others + ".");
  }
  page.section("Compatibility of the imposed motion", "compatibility",
               {{"velocity_residual", "0 = N^T B_a \\dot{r}_a"}});
  page.section("Free dynamics, eq. (1)", "free_dynamics",
               {{"M_eta_eta", "\\mathcal{M}"},
                {"M_p", "M_p"},
                {"M_a", "M_a"},
                {"m_pp", "m_{pp}"},
                {"m_pa", "m_{pa}"},
                {"m_aa", "m_{aa}"},
                {"f", "f"},
                {"Q_p", "Q_p"},
                {"Q_a", "Q_a"}});
  page.section("Reduced dynamics $`M_r \\dot\\nu = f_r`$, eq. (23)", "reduced_dynamics",
               {{"M_r", "M_r"}, {"f_r", "f_r"}});
  page.section("Torques, eq. (27)", "inverse_torques", {{"tau_a", "\\tau_a"}});
  return page.take();
}

}  // namespace anholon
