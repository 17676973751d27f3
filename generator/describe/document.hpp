// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// An input file as a tree of values that know where they stand. Numbers keep the text that the user wrote, so
// that decimals stay exact; strings map each of their characters to its place in the file.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "describe/location.hpp"

namespace anholon {

struct Entry;

/// A value of a TOML document.
struct Value {
  enum class Kind { string, number, boolean, array, table, date };

  Kind kind = Kind::table;
  Location where;              // first character of the value; of a [table], its header
  std::string text;            // contents of a string; otherwise the characters as written
  std::vector<Value> items;    // of an array
  std::vector<Entry> entries;  // of a table, in the order of the file

  Location text_begin;       // place of text[0]
  bool is_verbatim = false;  // text stands in the file as it is (no escapes), so places in it are known

  /// Entry of a table with this key, or null.
  [[nodiscard]] const Value* find(std::string_view key) const;
  /// Place in the file of a byte of the text; where the string has escapes, the place of the string.
  [[nodiscard]] Location at(std::size_t offset) const;
  /// "a string", "a table", ...
  [[nodiscard]] std::string_view kind_name() const;
};

struct Entry {
  std::string key;
  Location where;
  Value value;
};

/// Reads TOML text. @param file_name  stands in messages. @throws ModelError where the text is not valid TOML
Value read_document(std::string_view text, const std::string& file_name);

}  // namespace anholon
