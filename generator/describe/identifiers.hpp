// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Names of robot files, which may hold anything, as names of generated code.

#include <set>
#include <string>
#include <vector>

namespace anholon {

/// Makes safe, unique identifiers of names of a kind: other characters become underscores, keywords get one
/// behind them, and so do words that expressions know a number.
class NameGiver {
 public:
  /// @param kind  "link", "joint", ...; @param notes  takes what was renamed
  NameGiver(std::string kind, std::vector<std::string>& notes);
  std::string operator()(const std::string& text);

 private:
  std::string kind_;
  std::vector<std::string>& notes_;
  std::vector<std::string> reserved_;
  std::set<std::string> taken_;
};

}  // namespace anholon
