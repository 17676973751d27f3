// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/identifiers.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/outline.hpp"

namespace anholon {
namespace {

/// A name of the file as an identifier: other characters become underscores, keywords get one behind them.
std::string identifier_from(std::string_view text, std::string_view prefix) {
  constexpr std::size_t longest = 48;  // leaves room for what is put behind
  std::string name;
  for (const char c : text) {
    const bool fits = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    const char kept = fits ? c : '_';
    if (kept == '_' && (name.empty() || name.back() == '_')) continue;
    name += kept;
  }
  name = name.substr(0, longest);
  while (!name.empty() && name.back() == '_') name.pop_back();
  if (name.empty() || (name[0] >= '0' && name[0] <= '9'))
    name = fmt::format("{}{}{}", prefix, name.empty() ? "" : "_", name);
  if (!objection_to_name(name).empty()) name += "_";
  return name;
}

}  // namespace

NameGiver::NameGiver(std::string kind, std::vector<std::string>& notes)
    : kind_(std::move(kind)), notes_(notes), reserved_(reserved_names()) {}

std::string NameGiver::operator()(const std::string& text) {
  const std::string base = identifier_from(text, kind_);
  std::string name = base;
  for (int i = 2; std::ranges::find(reserved_, name) != reserved_.end() || !taken_.insert(name).second; ++i)
    name = fmt::format("{}{}{}", base, base.back() == '_' ? "" : "_", i);
  if (name != text) notes_.push_back(fmt::format("renamed: {} '{}' is called {}", kind_, text, name));
  return name;
}

}  // namespace anholon
