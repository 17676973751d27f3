// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/location.hpp"

#include <fmt/format.h>

namespace anholon {
namespace {

std::string joined(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& d : diagnostics) text += (text.empty() ? "" : "\n") + d.text();
  return text;
}

}  // namespace

std::string Diagnostic::text() const {
  const std::string end = mend.empty() ? "" : "; " + mend;
  if (where.line == 0) return fmt::format("{}: error: {}{}", where.file, fact, end);
  return fmt::format("{}:{}:{}: error: {}{}", where.file, where.line, where.column, fact, end);
}

ModelError::ModelError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(joined(diagnostics)), diagnostics_(std::move(diagnostics)) {}
ModelError::ModelError(Location where, std::string fact, std::string mend)
    : ModelError(std::vector{Diagnostic{std::move(where), std::move(fact), std::move(mend)}}) {}

}  // namespace anholon
