// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/document.hpp"

// toml++ 3.3 trusts some bytes that users can write, such as "[=": it asserts, or without assertions goes on
// wrongly. Here its assertions stay on, and throw.
#undef NDEBUG
namespace {
struct TomlAssertion {};
[[noreturn]] void give_up_on_toml() { throw TomlAssertion(); }
}  // namespace
#define TOML_ASSERT(expr) ((expr) ? void() : give_up_on_toml())
#define TOML_EXCEPTIONS 1
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <tuple>

namespace anholon {
namespace {

constexpr std::size_t longest_line = 8192;  // characters; with the next, bounds how deep a document can nest
constexpr std::size_t most_dots = 512;      // in one line

bool is_continuation_byte(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// The source text, with the byte at which each line begins.
class Source {
 public:
  Source(std::string_view text, const std::string& file) : text_(text), file_(file) {
    line_begin_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') line_begin_.push_back(i + 1);
    }
  }

  /// @throws ModelError where a line could nest so deep that reading it would exhaust the stack
  void check_lines() const {
    for (std::size_t line = 0; line < line_begin_.size(); ++line) {
      const std::size_t end = line + 1 < line_begin_.size() ? line_begin_[line + 1] : text_.size();
      const std::string_view row = text_.substr(line_begin_[line], end - line_begin_[line]);
      if (row.size() > longest_line || std::count(row.begin(), row.end(), '.') > std::ptrdiff_t{most_dots}) {
        throw ModelError(
            {file_, static_cast<int>(line) + 1, 1},
            fmt::format("the line has more than {} characters or {} dots", longest_line, most_dots),
            "break it into shorter ones");
      }
    }
  }

  /// Place of the line at which toml++ gives up on an assertion: the last of the shortest part that makes it
  /// do so.
  [[nodiscard]] Location location_of_assertion() const {
    std::size_t below = 0, lines = line_begin_.size();
    while (below + 1 < lines) {
      const std::size_t middle = (below + lines) / 2;
      (gives_up(text_.substr(0, line_begin_[middle])) ? lines : below) = middle;
    }
    return {file_, static_cast<int>(lines), 1};
  }

  [[nodiscard]] Location location(const toml::source_position& at) const {
    return {file_, static_cast<int>(at.line), static_cast<int>(at.column)};
  }

  /// Byte at a place; columns count characters, not bytes.
  [[nodiscard]] std::size_t offset(const toml::source_position& at) const {
    if (at.line < 1 || at.line > line_begin_.size()) return text_.size();
    std::size_t i = line_begin_[at.line - 1];
    for (toml::source_index column = 1; column < at.column && i < text_.size(); ++column) {
      ++i;
      while (i < text_.size() && is_continuation_byte(text_[i])) ++i;
    }
    return i;
  }

  /// A number, boolean or date as it is written, from its first character on.
  [[nodiscard]] std::string word(const toml::source_position& at) const {
    const std::size_t begin = offset(at);
    const std::size_t end = text_.find_first_of(" \t\r\n,]}#", begin);
    return std::string(text_.substr(begin, end == std::string_view::npos ? end : end - begin));
  }

  /// Finds the contents of a string behind its opening quotes.
  void place_text(Value& value, const toml::source_position& at) const {
    std::size_t begin = offset(at);
    toml::source_position place = at;
    const std::string_view rest = text_.substr(begin);
    const bool is_long = rest.starts_with("\"\"\"") || rest.starts_with("'''");
    begin += is_long ? 3 : 1;
    place.column += is_long ? 3 : 1;
    if (is_long && text_.substr(begin).starts_with("\n")) {
      ++begin;
      ++place.line;
      place.column = 1;
    }
    value.text_begin = location(place);
    value.is_verbatim = begin <= text_.size() && text_.substr(begin).starts_with(value.text);
  }

 private:
  static bool gives_up(std::string_view part) {
    try {
      (void)toml::parse(part);
      return false;
    } catch (const toml::parse_error&) {
      return false;
    } catch (const TomlAssertion&) {
      return true;
    }
  }

  std::string_view text_;
  std::string file_;
  std::vector<std::size_t> line_begin_;
};

Value converted(const toml::node& node, const Source& source) {
  Value value;
  value.where = source.location(node.source().begin);
  if (const auto* table = node.as_table()) {
    value.kind = Value::Kind::table;
    for (const auto& [key, child] : *table) {
      value.entries.push_back(
          {std::string(key.str()), source.location(key.source().begin), converted(child, source)});
    }
    std::stable_sort(value.entries.begin(), value.entries.end(), [](const Entry& a, const Entry& b) {
      return std::tie(a.where.line, a.where.column) < std::tie(b.where.line, b.where.column);
    });
  } else if (const auto* array = node.as_array()) {
    value.kind = Value::Kind::array;
    for (const toml::node& child : *array) value.items.push_back(converted(child, source));
  } else if (const auto* string = node.as_string()) {
    value.kind = Value::Kind::string;
    value.text = string->get();
    source.place_text(value, node.source().begin);
  } else {
    value.kind = node.is_number()    ? Value::Kind::number
                 : node.is_boolean() ? Value::Kind::boolean
                                     : Value::Kind::date;
    value.text = source.word(node.source().begin);
    value.text_begin = value.where;
    value.is_verbatim = true;
  }
  return value;
}

}  // namespace

const Value* Value::find(std::string_view key) const {
  for (const Entry& entry : entries) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

Location Value::at(std::size_t offset) const {
  if (!is_verbatim) return where;
  Location place = text_begin;
  for (std::size_t i = 0; i < offset && i < text.size(); ++i) {
    if (text[i] == '\n') {
      ++place.line;
      place.column = 1;
    } else if (!is_continuation_byte(text[i])) {
      ++place.column;
    }
  }
  return place;
}

std::string_view Value::kind_name() const {
  switch (kind) {
    case Kind::string:
      return "a string";
    case Kind::number:
      return "a number";
    case Kind::boolean:
      return "a boolean";
    case Kind::array:
      return "an array";
    case Kind::table:
      return "a table";
    case Kind::date:
      break;
  }
  return "a date or time";
}

Value read_document(std::string_view text, const std::string& file_name) {
  if (text.size() > largest_file) {
    throw ModelError({file_name, 0, 0}, fmt::format("the file is larger than {} bytes", largest_file),
                     "describe one robot a file");
  }
  const Source source(text, file_name);
  source.check_lines();
  try {
    return converted(toml::parse(text), source);
  } catch (const toml::parse_error& error) {
    throw ModelError(source.location(error.source().begin), fmt::format("not TOML: {}", error.description()),
                     "see toml.io for the syntax");
  } catch (const TomlAssertion&) {
    throw ModelError(source.location_of_assertion(), "not TOML: something here is neither a key nor a value",
                     "see toml.io for the syntax");
  }
}

std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(largest_file + 1, '\0');
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(path, ignored) ||
      (stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size())), stream.bad())) {
    throw ModelError({path.string(), 0, 0}, "the file cannot be read", "check its path and permissions");
  }
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;  // one byte too many is found by read_document
}

}  // namespace anholon
