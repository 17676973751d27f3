// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/table_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "describe/names.hpp"

namespace anholon {
namespace {

std::string one_of(const std::vector<std::string>& choices) {
  return choices.size() == 1 ? fmt::format("write \"{}\"", choices[0])
                             : fmt::format("write one of {}", listed(choices));
}

}  // namespace

const Value* TableReader::optional(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  return table_->find(key);
}

const Value* TableReader::optional(std::string_view key, Value::Kind kind) {
  const Value* value = optional(key);
  if (value == nullptr || value->kind == kind) return value;
  findings_->error(value->where, fmt::format("'{}' of {} is {}", key, what_, value->kind_name()),
                   fmt::format("it needs to be {}", name_of_kind(kind)));
  return nullptr;
}

const Value* TableReader::required(std::string_view key, std::string_view mend) {
  const Value* value = optional(key);
  if (value == nullptr)
    findings_->error(table_->where, fmt::format("{} has no '{}'", what_, key), std::string(mend));
  return value;
}

const Value* TableReader::required(std::string_view key, Value::Kind kind, std::string_view mend) {
  return required(key, mend) == nullptr ? nullptr : optional(key, kind);
}

std::optional<std::string> TableReader::optional_string(std::string_view key) {
  const Value* value = optional(key, Value::Kind::string);
  return value == nullptr ? std::nullopt : std::optional(value->text);
}

std::optional<std::string> TableReader::required_string(std::string_view key, std::string_view mend) {
  const Value* value = required(key, Value::Kind::string, mend);
  return value == nullptr ? std::nullopt : std::optional(value->text);
}

std::optional<std::size_t> TableReader::choice(const Value* value, std::string_view key,
                                               const std::vector<std::string>& choices) {
  if (value == nullptr) return std::nullopt;
  const auto found = std::find(choices.begin(), choices.end(), value->text);
  if (found != choices.end()) return static_cast<std::size_t>(found - choices.begin());
  findings_->error(value->where, fmt::format("'{}' of {} is '{}'", key, what_, value->text),
                   did_you_mean(value->text, choices, one_of(choices)));
  return std::nullopt;
}

std::optional<std::size_t> TableReader::optional_choice(std::string_view key,
                                                        const std::vector<std::string>& choices) {
  return choice(optional(key, Value::Kind::string), key, choices);
}

std::optional<std::size_t> TableReader::required_choice(std::string_view key,
                                                        const std::vector<std::string>& choices) {
  return choice(required(key, Value::Kind::string, one_of(choices)), key, choices);
}

std::optional<int> TableReader::optional_integer(std::string_view key, int least, int most) {
  const Value* value = optional(key, Value::Kind::number);
  if (value == nullptr) return std::nullopt;
  int number = 0;
  const char* end = value->text.data() + value->text.size();
  const auto [stop, problem] = std::from_chars(value->text.data(), end, number);
  if (problem == std::errc() && stop == end && number >= least && number <= most) return number;
  findings_->error(value->where, fmt::format("'{}' of {} is {}", key, what_, value->text),
                   least == most ? fmt::format("it needs to be {}", least)
                                 : fmt::format("it needs to be an integer from {} to {}", least, most));
  return std::nullopt;
}

void TableReader::report_unknown_keys() {
  if (accepts_all_keys_) return;
  for (const Entry& entry : table_->entries) {
    if (std::find(known_.begin(), known_.end(), entry.key) != known_.end()) continue;
    std::vector<std::string> unused;
    for (const std::string& key : known_) {
      if (table_->find(key) == nullptr) unused.push_back(key);
    }
    const std::string closest = closest_name(entry.key, unused);
    findings_->error(entry.where, fmt::format("unknown key '{}' in {}", entry.key, what_),
                     closest.empty() ? fmt::format("keys here are {}", listed(known_))
                                     : fmt::format("did you mean '{}'?", closest));
  }
}

std::string_view name_of_kind(Value::Kind kind) {
  Value example;
  example.kind = kind;
  return example.kind_name();
}

}  // namespace anholon
