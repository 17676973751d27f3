// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A tape's nodes as formulas that a person reads.

#include <string>
#include <string_view>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

/// A name of the model in LaTeX: m_c -> m_{c}, r1 -> r_{1}, alpha -> \alpha, Omega_Z -> \Omega_{Z},
/// m_wheel -> m_{\mathrm{wheel}}, dot(r1) and r1_dot -> \dot{r}_{1}, r1_ddot -> \ddot{r}_{1}, nu[0] ->
/// \nu_{0}.
std::string latex_name(std::string_view name);

struct LatexNames {
  /// LaTeX of each input of the tape by its number; where there is none, latex_name of the input's own name.
  std::vector<std::string> inputs;
  /// Letter of the intermediate symbols k_{1}, k_{2}, ...
  std::string intermediate = "k";
  /// Symbols and numbers that one entry may show before parts of it get a name.
  std::size_t entry_size = 40;
  /// Closed forms are tried up to these sizes.
  std::size_t nodes = 400;
  std::size_t terms = 60;
};

struct LatexText {
  std::string formula;
  std::vector<std::string> definitions;  // "k_{1} = ...", each using earlier ones only
};

/// Entries simplified one by one, as a bmatrix, or bare where there is one row of one. Depends on the
/// structure of the expressions alone: the same text on every run.
LatexText latex_text(const Tape& tape, const std::vector<std::vector<NodeId>>& rows,
                     const LatexNames& names = {});

}  // namespace anholon
