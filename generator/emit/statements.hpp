// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The body of a generated function: one operation per line, section titles as comments, results at the end.

#include <string>
#include <unordered_map>
#include <vector>

#include "emit/names.hpp"
#include "optimise/tape/order.hpp"
#include "tape/tape.hpp"

namespace anholon {

/// A value that the function is handed: how it is written, and in which of its arguments it comes.
struct GivenValue {
  std::string text;
  std::size_t argument = 0;
};
using GivenValues = std::unordered_map<NodeId, GivenValue>;

/// target = node or target[entry] = node, the last lines of a function.
struct Assignment {
  static constexpr auto none = static_cast<std::size_t>(-1);
  std::string target;
  NodeId node = 0;
  std::size_t entry = none;
  std::size_t argument = none;  // which of the function's arguments the target is; none: a value of its own
};

/// How sines and cosines are computed.
enum class SinCos {
  cmath,  // std::sin and std::cos, one by one
  batch,  // those of all angles by one loop that compilers vectorise (templates/sines_cosines.inl)
};

struct StatementStyle {
  NodeOrder order = NodeOrder::by_length;
  std::size_t split_above = 4000;  // lines, results too; compilers are slow on longer functions
  std::size_t block_size = 300;    // lines of a part
  SinCos sincos = SinCos::cmath;
};

/// A function of its own that holds a part of a long one: operations, or results.
struct StatementBlock {
  std::vector<std::size_t> arguments;  // of the whole function that it reads or writes, ascending
  bool uses_carried = false;
  std::string text;
};

struct Statements {
  std::vector<StatementBlock> blocks;  // empty where the function is not split
  std::string text;  // of the function itself; results that are no argument where it is split
  std::vector<std::size_t> arguments;  // that `text` and the blocks use, ascending
  std::string carried;                 // name of the array of values that cross blocks
  std::size_t carried_size = 0;
  bool uses_batch = false;  // of sines and cosines
};

/// @param names  names that are taken already; temporaries keep clear of them
/// @throws std::logic_error if a root needs an input that is not given
Statements write_statements(const Tape& tape, const std::vector<Assignment>& results,
                            const GivenValues& given, NameScope names, const StatementStyle& style = {});

/// A constant of generated code with 21 significant digits, which round to nearest in every format up to the
/// 64 bit mantissa of a long double: "constant<Real>(0.5L)".
std::string constant_text(const Exact& value);

/// The text as lines of at most `width` columns that all begin with `prefix` and may stand in a // comment:
/// no control characters, no line that ends in a backslash.
/// @param hang  spaces behind the prefix from the second line on
std::string comment(std::string_view text, std::string_view prefix, std::size_t hang = 0,
                    std::size_t width = 110);

/// The text on one line, fit for a // comment.
std::string one_line(std::string_view text);

/// The same of what a file comes from; "none" where that is not known.
std::string origin(std::string_view text);

}  // namespace anholon
