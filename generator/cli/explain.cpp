// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "algebra/latex.hpp"
#include "cli/common.hpp"

namespace anholon::cli {
namespace {

/// Markdown with one displayed equation a block; long parts get names, defined below the equation.
class Page {
 public:
  Page(const Tape& tape, const LatexNames& names) : tape_(tape), names_(names) {}

  void text(const std::string& line) { page_ += line + "\n\n"; }
  void equation(const std::string& left, const OutputBlock& block) {
    std::vector<std::vector<NodeId>> rows;
    for (int i = 0; i < block.rows; ++i) {
      rows.emplace_back(block.nodes.begin() + static_cast<std::ptrdiff_t>(i) * block.cols,
                        block.nodes.begin() + static_cast<std::ptrdiff_t>(i + 1) * block.cols);
    }
    const LatexText latex = latex_text(tape_, rows, names_);
    page_ += fmt::format("$$ {} = {} $$\n\n", left, latex.formula);
    if (latex.definitions.empty()) return;
    page_ += "with\n\n";
    for (const std::string& d : latex.definitions) page_ += fmt::format("$$ {} $$\n\n", d);
  }
  [[nodiscard]] const std::string& str() const { return page_; }

 private:
  const Tape& tape_;
  const LatexNames& names_;
  std::string page_;
};

/// LaTeX of every input of the program: coordinates by their names in the description.
LatexNames latex_names(const Model& model, const Derivation& derivation) {
  const Program& program = derivation.program;
  LatexNames names;
  names.inputs.resize(program.tape.inputs().size());
  const auto set = [&](NodeId node, const std::string& text) {
    names.inputs[program.tape.node(node).a] = text;
  };
  const Partition p = partition_of(model);
  const auto coordinate = [&](int velocity) {
    return latex_name(model.coordinates[static_cast<std::size_t>(velocity - p.n)].name);
  };
  const std::vector<int> r_p(p.passive.begin() + p.n, p.passive.end());
  for (const InputBlock& b : program.inputs) {
    const auto each = [&](const auto& text) {
      for (std::size_t i = 0; i < b.nodes.size(); ++i) set(b.nodes[i], text(i));
    };
    const auto indexed = [&](const std::string& letter) {
      each([&](std::size_t i) { return fmt::format("{}_{{{}}}", letter, i + 1); });
    };
    if (b.name == "r_p") each([&](std::size_t i) { return coordinate(r_p[i]); });
    if (b.name == "r_a") each([&](std::size_t i) { return coordinate(p.active[i]); });
    if (b.name == "r_p_dot") each([&](std::size_t i) { return "\\dot{" + coordinate(r_p[i]) + "}"; });
    if (b.name == "r_a_dot") each([&](std::size_t i) { return "\\dot{" + coordinate(p.active[i]) + "}"; });
    if (b.name == "r_a_ddot") each([&](std::size_t i) { return "\\ddot{" + coordinate(p.active[i]) + "}"; });
    if (b.name == "eta") {
      const auto components = free_components(model.group);
      each([&](std::size_t i) {
        return latex_name(twist_component_names[static_cast<std::size_t>(components[i])]);
      });
    }
    if (b.name == "R") {
      each([](std::size_t i) { return fmt::format("R_{{{}{}}}", "XYZ"[i / 3], "XYZ"[i % 3]); });
    }
    if (b.name == "nu") indexed("\\nu");
    if (b.name == "nu_dot") indexed("\\dot{\\nu}");
    if (b.name == "lambda_stat") indexed("s");
    if (b.name == "g") each([](std::size_t i) { return std::vector<std::string>{"x", "y", "\\theta"}[i]; });
  }
  return names;
}

}  // namespace

int explain(const ExplainOptions& options) {
  const Model model = load_model(options);
  DeriveRequest request = derive_request(options, model);
  request.functions = {"kinematics",       "constraints",     "free_dynamics",
                       "reduced_dynamics", "inverse_torques", "compatibility"};
  const auto derivation = derive(model, request);
  const LatexNames names = latex_names(model, *derivation);
  const ReductionReport& r = derivation->reduction;
  Page page(derivation->program.tape, names);

  page.text(fmt::format("# {}: equations", model.title.empty() ? model.name : model.title));
  std::vector<std::string> passive, active;
  for (const int i : r.partition.passive)
    passive.push_back("$" + latex_name(velocity_names(model)[static_cast<std::size_t>(i)]) + "$");
  for (const int i : r.partition.active)
    active.push_back("$" + latex_name(velocity_names(model)[static_cast<std::size_t>(i)]) + "$");
  page.text(
      fmt::format("Group {}, $n = {}$, $s_p = {}$, $s_a = {}$; {} constraint rows, $m = {}$, $m^\\circ = "
                  "{}$. Table I: {}.",
                  name(model.group), r.partition.n, r.partition.s_p(), r.partition.s_a(), r.ranks.rows,
                  r.ranks.m, r.ranks.m_locked, r.ranks.table_I_class(r.partition)));
  page.text(fmt::format("Passive velocities $(\\eta, \\dot r_p)$ in the order {}; active coordinates {}.",
                        fmt::join(passive, ", "), fmt::join(active, ", ")));
  page.text("Kernel: " + r.kernel.description + ".");

  const auto show = [&](const std::string& function, const std::string& title,
                        const std::vector<std::pair<std::string, std::string>>& blocks) {
    for (const Function& f : derivation->program.functions) {
      if (f.name != function) continue;
      page.text("## " + title);
      for (const auto& [block, left] : blocks) {
        for (const OutputBlock& b : f.outputs) {
          if (b.name == block) page.equation(left, b);
        }
      }
    }
  };
  show("constraints", "Constraints, eq. (2)",
       {{"A", "A"}, {"B_p", "B_p"}, {"B_a", "B_a"}, {"lambda_stat_basis", "N"}});
  show("kinematics", "Kinematic model, eq. (11)",
       {{"H", "H"}, {"J", "J"}, {"eta", "\\eta"}, {"r_p_dot", "\\dot{r}_p"}});
  show("compatibility", "Compatibility of the imposed motion", {{"velocity_residual", "N^T B_a \\dot{r}_a"}});
  show("free_dynamics", "Free dynamics, eq. (1)",
       {{"M_eta_eta", "\\mathcal{M}"},
        {"M_p", "M_p"},
        {"M_a", "M_a"},
        {"m_pp", "m_{pp}"},
        {"m_pa", "m_{pa}"},
        {"m_aa", "m_{aa}"},
        {"f", "f"},
        {"Q_p", "Q_p"},
        {"Q_a", "Q_a"}});
  show("reduced_dynamics", "Reduced dynamics $M_r \\dot\\nu = f_r$, eq. (23)",
       {{"M_r", "M_r"}, {"f_r", "f_r"}});
  show("inverse_torques", "Torques, eq. (27)", {{"tau_a", "\\tau_a"}});
  write_output(options.output, page.str());
  return ok;
}

}  // namespace anholon::cli
