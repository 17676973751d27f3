// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Strict access to one table of a document: each key is asked for by name, and whatever was not asked for is
// an error.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "describe/document.hpp"
#include "describe/findings.hpp"

namespace anholon {

class TableReader {
 public:
  /// @param what  the table as it stands in messages: "body 'wheel'"
  TableReader(const Value& table, std::string what, Findings& findings)
      : table_(&table), what_(std::move(what)), findings_(&findings) {}

  /// The value of a key, or null; the key is known from now on.
  const Value* optional(std::string_view key);
  /// The value of a key of the given kind, or null: an entry of another kind is an error.
  const Value* optional(std::string_view key, Value::Kind kind);
  /// Likewise; a missing key is an error, for which `mend` says what to write.
  const Value* required(std::string_view key, std::string_view mend);
  const Value* required(std::string_view key, Value::Kind kind, std::string_view mend);

  std::optional<std::string> optional_string(std::string_view key);
  std::optional<std::string> required_string(std::string_view key, std::string_view mend);
  /// The index of the key's text in `choices`; other texts are errors.
  std::optional<std::size_t> optional_choice(std::string_view key, const std::vector<std::string>& choices);
  std::optional<std::size_t> required_choice(std::string_view key, const std::vector<std::string>& choices);
  /// A decimal integer from `least` to `most`.
  std::optional<int> optional_integer(std::string_view key, int least, int most);

  /// For tables whose keys cannot be judged, because what they belong to is wrong.
  void accept_all_keys() { accepts_all_keys_ = true; }
  /// Reports every key that was not asked for.
  void report_unknown_keys();

  /// Place of the value of a key that is there; else of the table.
  [[nodiscard]] Location find_where(std::string_view key) const {
    const Value* value = table_->find(key);
    return value == nullptr ? table_->where : value->where;
  }
  [[nodiscard]] const Value& table() const { return *table_; }
  [[nodiscard]] const std::string& what() const { return what_; }
  [[nodiscard]] Findings& findings() const { return *findings_; }

 private:
  std::optional<std::size_t> choice(const Value* value, std::string_view key,
                                    const std::vector<std::string>& choices);

  const Value* table_;
  std::string what_;
  Findings* findings_;
  std::vector<std::string> known_;
  bool accepts_all_keys_ = false;
};

/// The kind as in "needs to be a table".
std::string_view name_of_kind(Value::Kind kind);

}  // namespace anholon
