// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Robots that repeat a part: [counts] are whole numbers of a description, `repeat = "i = 2..N"` writes a
// table once for each i, and {i - 1} in a string stands for the number. All of it happens on the document,
// before anything else is read.

#include <map>
#include <string>
#include <vector>

#include "describe/document.hpp"
#include "describe/findings.hpp"

namespace anholon {

/// A whole number that says how often parts of a description come.
struct Count {
  std::string name;
  int value = 0;
  int least = 0, most = 0;
  std::string meaning;
};

/// Values that replace those of a description's counts, by name.
using CountValues = std::map<std::string, int, std::less<>>;

/// Reads and removes [counts]. @param overrides  each has to be the name of a count, and in its range
std::vector<Count> take_counts(Value& document, const CountValues& overrides, Findings& findings);

/// Writes out every `repeat` and every {...}. A document without counts and repetitions stays as it is.
void write_out(Value& document, const std::vector<Count>& counts, Findings& findings);

/// counts = { N = 12 } of a scene.
CountValues read_count_values(const Value& document, Findings& findings);

}  // namespace anholon
