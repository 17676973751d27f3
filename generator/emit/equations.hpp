// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The equations of a model as Markdown that a person reads, with LaTeX in fenced `math` blocks: GitHub and
// GitLab hand these to the renderer as they stand, while a backslash between dollars passes through Markdown
// first.

#include <string>

#include "derive/derive.hpp"
#include "describe/model.hpp"

namespace anholon {

struct EquationStyle {
  /// Equations that are long, or whose parts need names of their own, are shown by their size alone.
  bool brief = false;
  std::size_t brief_length = 420;  // characters of LaTeX that one brief equation may have
  std::string heading = "##";      // of a section
};

/// The functions that the page shows.
std::vector<std::string> equation_functions();

/// The page below its title. Depends on structure and names only: equal programs give equal bytes.
/// @param derivation  of this model, with the functions above
std::string equations(const Model& model, const Derivation& derivation, const EquationStyle& style = {});

}  // namespace anholon
