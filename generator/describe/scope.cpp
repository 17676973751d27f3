// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/scope.hpp"

#include "describe/names.hpp"

namespace anholon {
namespace {

template <class Map>
const Symbol* lookup(const Map& map, std::string_view name) {
  const auto at = map.find(name);
  return at == map.end() ? nullptr : &at->second;
}

}  // namespace

const Symbol* Scope::find(std::string_view name) const { return lookup(symbols_, name); }
const Symbol* Scope::find_rate(std::string_view name) const { return lookup(rates_, name); }

std::vector<std::string> Scope::names(Allowed allowed) const {
  std::vector<std::string> result;
  for (const auto& [name, symbol] : symbols_) {
    if (allowed.contains(symbol.kind) && symbol.objection.empty()) result.push_back(name);
  }
  return result;
}

std::vector<std::string> Scope::names_with_rate() const {
  std::vector<std::string> result;
  for (const auto& [name, symbol] : rates_) result.push_back(name);
  return result;
}

std::string_view description(SymbolKind kind) {
  switch (kind) {
    case SymbolKind::parameter:
      return "a parameter";
    case SymbolKind::coordinate:
      return "a coordinate";
    case SymbolKind::velocity:
      return "a velocity";
    case SymbolKind::pose:
      return "part of the pose of the reference body";
    case SymbolKind::time:
      break;
  }
  return "the time";
}

std::string description(Allowed allowed) {
  std::vector<std::string> kinds;
  if (allowed.contains(SymbolKind::parameter)) kinds.emplace_back("parameters");
  if (allowed.contains(SymbolKind::coordinate)) kinds.emplace_back("coordinates");
  if (allowed.contains(SymbolKind::velocity)) kinds.emplace_back("velocities");
  if (allowed.contains(SymbolKind::pose)) kinds.emplace_back("the pose");
  if (allowed.contains(SymbolKind::time)) kinds.emplace_back("t");
  return kinds.empty() ? "numbers" : listed(kinds);
}

}  // namespace anholon
