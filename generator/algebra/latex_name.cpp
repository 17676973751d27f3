// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "algebra/latex.hpp"
#include "describe/ascii.hpp"

namespace anholon {
namespace {

constexpr std::array<std::string_view, 35> greek = {
    "alpha",   "beta",   "gamma", "delta",   "epsilon", "zeta",  "eta",   "theta", "iota",
    "kappa",   "lambda", "mu",    "nu",      "xi",      "pi",    "rho",   "sigma", "tau",
    "upsilon", "phi",    "chi",   "psi",     "omega",   "Gamma", "Delta", "Theta", "Lambda",
    "Xi",      "Pi",     "Sigma", "Upsilon", "Phi",     "Psi",   "Omega", "ell"};

bool take_suffix(std::string_view& name, std::string_view suffix) {
  if (name.size() <= suffix.size() || !name.ends_with(suffix)) return false;
  name.remove_suffix(suffix.size());
  return true;
}

bool take_call(std::string_view& name, std::string_view call) {
  if (!name.starts_with(call) || !name.ends_with(")")) return false;
  name.remove_prefix(call.size());
  name.remove_suffix(1);
  return true;
}

std::string word(std::string_view text) {
  if (std::ranges::find(greek, text) != greek.end()) return fmt::format("\\{}", text);
  if (text.size() <= 1 || std::ranges::all_of(text, is_digit)) return std::string(text);
  return fmt::format("\\mathrm{{{}}}", text);
}

/// "mX0" -> {"mX", "0"}
std::pair<std::string_view, std::string_view> trailing_digits(std::string_view text) {
  std::size_t letters = text.size();
  while (letters > 0 && is_digit(text[letters - 1])) --letters;
  if (letters == 0) return {text, {}};
  return {text.substr(0, letters), text.substr(letters)};
}

}  // namespace

std::string latex_name(std::string_view name) {
  std::string_view entry;  // of "x[2]"
  const std::size_t bracket = name.find('[');
  if (bracket != std::string_view::npos && name.ends_with("]")) {
    entry = name.substr(bracket + 1, name.size() - bracket - 2);
    name = name.substr(0, bracket);
  }
  std::string accent;
  if (take_call(name, "ddot(") || take_suffix(name, "_ddot")) {
    accent = "\\ddot";
  } else if (take_call(name, "dot(") || take_suffix(name, "_dot")) {
    accent = "\\dot";
  }
  const std::size_t underscore = name.find('_');
  const auto [base, number] = trailing_digits(name.substr(0, underscore));
  std::string subscript(number);
  std::string_view rest =
      underscore == std::string_view::npos ? std::string_view() : name.substr(underscore + 1);
  while (!rest.empty()) {
    const std::size_t end = rest.find('_');
    const auto [letters, digits] = trailing_digits(rest.substr(0, end));
    if (!subscript.empty()) subscript += ",";
    subscript += word(letters);
    if (!digits.empty()) subscript += fmt::format("{}{}", letters.size() > 1 ? "\\," : "", digits);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  if (!entry.empty()) subscript += fmt::format("{}{}", subscript.empty() ? "" : ",", entry);
  const std::string letter = accent.empty() ? word(base) : fmt::format("{}{{{}}}", accent, word(base));
  return subscript.empty() ? letter : fmt::format("{}_{{{}}}", letter, subscript);
}

}  // namespace anholon
