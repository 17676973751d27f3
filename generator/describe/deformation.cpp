// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/deformation.hpp"

#include <fmt/format.h>

#include "describe/names.hpp"

namespace anholon {

const std::vector<std::string>& deformation_names() {
  static const std::vector<std::string> names = {"linear", "quadratic", "stiffened"};
  return names;
}

std::vector<std::string> kept_terms(const Model& model) {
  static const std::vector<std::string> terms = {
      "T without terms of second order in the modes", "all terms of T of the linear displacement field",
      "all terms of T of the linear displacement field, and those of the foreshortening up to second order"};
  std::vector<std::string> lines;
  for (std::size_t order = 0; order < terms.size(); ++order) {
    std::vector<std::string> bodies;
    bool without = false;
    for (const BodyDescription& body : model.bodies) {
      if (body.modes.empty() || static_cast<std::size_t>(body.deformation) != order) continue;
      bodies.push_back(body.name);
      without = without || body.modes.front().psi.empty();
    }
    if (bodies.empty()) continue;
    lines.push_back(fmt::format("{}: {}: {}", listed(bodies), deformation_names()[order], terms[order]));
    if (without && order == 2) lines.back() += ", where the table of modes has them";
  }
  return lines;
}

}  // namespace anholon
