// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The expressions that users write, read onto a tape: + - * / ^, parentheses, a fixed list of functions, pi,
// names, dot(name) for a velocity. Decimals stay exact. Whatever the text, reading ends soon and either gives
// an expression or says at which character it went wrong.

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "describe/scope.hpp"

namespace anholon {

/// Text that is not an expression.
struct ExpressionError : std::runtime_error {
  ExpressionError(std::size_t at, std::string what_is_wrong, std::string way_out)
      : std::runtime_error(what_is_wrong),
        offset(at),
        fact(std::move(what_is_wrong)),
        mend(std::move(way_out)) {}
  std::size_t offset;  // of the character in the text
  std::string fact, mend;
};

/// Reads an expression onto the tape of the scope's symbols. @throws ExpressionError
Quantity read_expression(Tape& tape, std::string_view text, const Scope& scope, Allowed allowed);

/// Names of functions and constants, which nothing else may be called.
const std::vector<std::string>& expression_words();

}  // namespace anholon
