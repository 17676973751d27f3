// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/repetition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <stdexcept>

#include "describe/names.hpp"
#include "describe/table_reader.hpp"

namespace anholon {
namespace {

constexpr int largest_integer = 1'000'000;
constexpr int most_copies = 1000;         // of one repetition
constexpr int most_copies_made = 20'000;  // of all

using Numbers = std::map<std::string, int, std::less<>>;

/// Whole-number expressions with + - * and parentheses.
class Arithmetic {
 public:
  Arithmetic(std::string_view text, const Numbers& names) : text_(text), names_(names) {}

  /// @throws std::invalid_argument with the fact
  int value() {
    const int result = sum();
    if (peek() != '\0') throw std::invalid_argument(fmt::format("'{}' is not a whole number", text_));
    return result;
  }

 private:
  char peek() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  static int checked(long x) {
    if (x > largest_integer || x < -largest_integer)
      throw std::invalid_argument(fmt::format("the number {} is too large", x));
    return static_cast<int>(x);
  }
  int sum() {
    int result = product();
    for (char c = peek(); c == '+' || c == '-'; c = peek()) {
      ++at_;
      const int term = product();
      result = checked(c == '+' ? long{result} + term : long{result} - term);
    }
    return result;
  }
  int product() {
    int result = factor();
    while (peek() == '*') {
      ++at_;
      result = checked(long{result} * factor());
    }
    return result;
  }
  int factor() {
    const char c = peek();
    if (c == '-' || c == '(') {
      constexpr int deepest = 50;
      if (++depth_ > deepest)
        throw std::invalid_argument(fmt::format("a number is nested deeper than {}", deepest));
      ++at_;
      const int result = c == '-' ? -factor() : sum();
      if (c == '(' && peek() != ')')
        throw std::invalid_argument(fmt::format("'{}' has an open parenthesis", text_));
      if (c == '(') ++at_;
      --depth_;
      return result;
    }
    const std::size_t begin = at_;
    const auto is_word = [&](char x) { return std::isalnum(static_cast<unsigned char>(x)) != 0 || x == '_'; };
    while (at_ < text_.size() && is_word(text_[at_])) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    if (word.empty()) throw std::invalid_argument(fmt::format("'{}' is not a whole number", text_));
    if (std::isdigit(static_cast<unsigned char>(word[0])) != 0) {
      const bool is_number = std::ranges::all_of(word, [](unsigned char x) { return std::isdigit(x) != 0; });
      if (!is_number) throw std::invalid_argument(fmt::format("'{}' is not a whole number", word));
      if (word.size() > 9) throw std::invalid_argument(fmt::format("the number {} is too large", word));
      return checked(std::stol(std::string(word)));
    }
    const auto found = names_.find(word);
    if (found == names_.end()) throw std::invalid_argument(fmt::format("'{}' is not a count", word));
    return found->second;
  }

  std::string_view text_;
  const Numbers& names_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

/// repeat = "i = 2..N"
struct Range {
  std::string name;
  int first = 0, last = 0;
};

class CopyWriter {
 public:
  CopyWriter(const std::vector<Count>& counts, Findings& findings) : findings_(findings) {
    for (const Count& count : counts) numbers_[count.name] = count.value;
  }

  /// Repetitions inside first, so that a copy is final when it is made: names of an outer one are known then.
  void write_out(Value& value) {
    if (value.kind == Value::Kind::string) replace(value.text, value);
    if (value.kind == Value::Kind::array) repeat_items(value);
    if (value.kind == Value::Kind::table) repeat_entries(value);
  }

 private:
  void error(const Location& where, const std::string& fact) {
    findings_.error(where, fact,
                    fmt::format("use the numbers of [counts] and of repeat = \"i = 1..N\"{}",
                                numbers_.empty() ? "" : fmt::format(": {}", listed(names()))));
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& [name, number] : numbers_) names.push_back(name);
    return names;
  }
  int number(std::string_view text, const Location& where) {
    try {
      return Arithmetic(text, numbers_).value();
    } catch (const std::invalid_argument& objection) {
      error(where, objection.what());
      return 0;
    }
  }

  /// Every {...} of a text by its number.
  void replace(std::string& text, Value& of) {
    if (text.find('{') == std::string::npos) return;
    std::string result;
    std::size_t at = 0;
    for (std::size_t open = text.find('{'); open != std::string::npos; open = text.find('{', at)) {
      const std::size_t close = text.find('}', open);
      if (close == std::string::npos) {
        error(of.where, fmt::format("'{}' has an open brace", text));
        return;
      }
      result += text.substr(at, open - at);
      result += std::to_string(number(std::string_view(text).substr(open + 1, close - open - 1), of.where));
      at = close + 1;
    }
    text = result + text.substr(at);
    of.is_verbatim = false;  // places in it are no longer those of the file
  }

  std::optional<Range> range_of(const Value& repeat) {
    const std::size_t equals = repeat.text.find('='), dots = repeat.text.find("..");
    if (repeat.kind != Value::Kind::string || equals == std::string::npos || dots == std::string::npos ||
        dots < equals) {
      findings_.error(repeat.where, "the repetition does not say what runs", "write repeat = \"i = 1..N\"");
      return std::nullopt;
    }
    Range range;
    for (const char c : repeat.text.substr(0, equals)) {
      if (std::isspace(static_cast<unsigned char>(c)) == 0) range.name += c;
    }
    if (!objection_to_name(range.name).empty() || numbers_.contains(range.name)) {
      findings_.error(repeat.where, fmt::format("'{}' cannot run in a repetition", range.name),
                      "choose another letter: repeat = \"i = 1..N\"");
      return std::nullopt;
    }
    range.first = number(std::string_view(repeat.text).substr(equals + 1, dots - equals - 1), repeat.where);
    range.last = number(std::string_view(repeat.text).substr(dots + 2), repeat.where);
    if (long{range.last} - range.first >= most_copies) {
      findings_.error(repeat.where, fmt::format("the repetition makes more than {} copies", most_copies),
                      "take a smaller range");
      return std::nullopt;
    }
    return range;
  }

  /// Calls f once for each number of a range.
  template <class F>
  void each(const Value& repeat, const F& f) {
    const auto range = range_of(repeat);
    if (!range) return;
    for (int i = range->first; i <= range->last; ++i) {
      if (++copies_ > most_copies_made) {
        findings_.error(repeat.where,
                        fmt::format("the repetitions make more than {} copies", most_copies_made),
                        "take smaller ranges");
        break;
      }
      numbers_[range->name] = i;
      f();
    }
    numbers_.erase(range->name);
  }

  void repeat_items(Value& array) {
    std::vector<Value> items;
    for (Value& item : array.items) {
      const Value* repeat = item.kind == Value::Kind::table ? item.find("repeat") : nullptr;
      if (repeat == nullptr) {
        write_out(item);
        items.push_back(std::move(item));
        continue;
      }
      Value once = item;
      std::erase_if(once.entries, [](const Entry& e) { return e.key == "repeat"; });
      each(*repeat, [&] {
        items.push_back(once);
        write_out(items.back());
      });
    }
    array.items = std::move(items);
  }

  void repeat_entries(Value& table) {
    const Value* found = table.find("repeat");
    if (found == nullptr) {
      for (Entry& entry : table.entries) write_out(entry.value);
      return;
    }
    const Value repeat = *found;
    std::vector<Entry> entries;
    for (Entry& entry : table.entries) {
      if (entry.key == "repeat") continue;
      if (entry.key.find('{') == std::string::npos) {
        write_out(entry.value);
        entries.push_back(std::move(entry));
        continue;
      }
      each(repeat, [&] {
        Entry copy = entry;
        replace(copy.key, copy.value);
        write_out(copy.value);
        entries.push_back(std::move(copy));
      });
    }
    table.entries = std::move(entries);
  }

  Findings& findings_;
  Numbers numbers_;
  int copies_ = 0;
};

bool repeats(const Value& value) {
  if (value.find("repeat") != nullptr) return true;
  return std::ranges::any_of(value.items, repeats) ||
         std::ranges::any_of(value.entries, [](const Entry& e) { return repeats(e.value); });
}

std::optional<int> whole_number(const Value& value) {
  if (value.kind != Value::Kind::number) return std::nullopt;
  try {
    return Arithmetic(value.text, {}).value();
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// [counts] of a document, or nothing.
const Value* counts_of(const Value& document, Findings& findings) {
  const Value* table = document.find("counts");
  if (table == nullptr || table->kind == Value::Kind::table) return table;
  findings.error(table->where, fmt::format("counts is {}", table->kind_name()),
                 "write a table [counts] with an entry for each");
  return nullptr;
}

}  // namespace

std::vector<Count> take_counts(Value& document, const CountValues& overrides, Findings& findings) {
  std::vector<Count> counts;
  const Value* table = counts_of(document, findings);
  for (const Entry& entry : table == nullptr ? std::vector<Entry>{} : table->entries) {
    const std::string what = fmt::format("the count '{}'", entry.key);
    if (const std::string objection = objection_to_name(entry.key); !objection.empty())
      findings.error(entry.where, fmt::format("the name '{}' {}", entry.key, objection), "choose another");
    if (entry.value.kind != Value::Kind::table) {
      findings.error(entry.value.where, fmt::format("{} is {}", what, entry.value.kind_name()),
                     "write { value = 8, range = [3, 30], meaning = \"...\" }");
      continue;
    }
    TableReader reader(entry.value, what, findings);
    Count count;
    count.name = entry.key;
    count.meaning = reader.optional_string("meaning").value_or("");
    const Value* value = reader.required("value", "give it a whole number");
    const Value* range =
        reader.required("range", Value::Kind::array, "write the least and the most: [3, 30]");
    reader.report_unknown_keys();
    if (value == nullptr || range == nullptr) continue;
    const auto number = whole_number(*value);
    const bool is_pair = range->items.size() == 2;  // anything else counts as a range without numbers
    const int least = is_pair ? whole_number(range->items[0]).value_or(1) : 1;
    const int most = is_pair ? whole_number(range->items[1]).value_or(0) : 0;
    if (!number || least > most) {
      findings.error(entry.value.where, fmt::format("{} has no whole number or no range", what),
                     "write { value = 8, range = [3, 30] }");
      continue;
    }
    count.value = *number, count.least = least, count.most = most;
    const auto replaced = overrides.find(count.name);
    if (replaced != overrides.end()) count.value = replaced->second;
    if (count.value < count.least || count.value > count.most)
      findings.error(value->where, fmt::format("{} is {}", what, count.value),
                     fmt::format("take a number from {} to {}", count.least, count.most));
    counts.push_back(count);
  }
  for (const auto& [name, value] : overrides) {
    if (std::ranges::find(counts, name, &Count::name) != counts.end()) continue;
    std::vector<std::string> known;
    for (const Count& count : counts) known.push_back(count.name);
    findings.error(table == nullptr ? document.where : table->where,
                   fmt::format("the description has no count '{}'", name),
                   known.empty() ? "leave it out" : fmt::format("there are {}", listed(known)));
  }
  std::erase_if(document.entries, [](const Entry& e) { return e.key == "counts"; });
  return counts;
}

void write_out(Value& document, const std::vector<Count>& counts, Findings& findings) {
  if (counts.empty() && !repeats(document)) return;
  CopyWriter(counts, findings).write_out(document);
}

CountValues read_count_values(const Value& document, Findings& findings) {
  CountValues values;
  const Value* table = counts_of(document, findings);
  if (table == nullptr) return values;
  for (const Entry& entry : table->entries) {
    if (const auto number = whole_number(entry.value)) {
      values[entry.key] = *number;
    } else {
      findings.error(entry.value.where, fmt::format("the count '{}' is not a whole number", entry.key),
                     "write for example 12");
    }
  }
  return values;
}

}  // namespace anholon
