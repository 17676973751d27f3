// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/findings.hpp"

#include <algorithm>
#include <tuple>

namespace anholon {

void Findings::error(Location where, std::string fact, std::string mend) {
  for (const Diagnostic& d : diagnostics_) {
    if (std::tie(d.where.file, d.where.line, d.where.column) ==
        std::tie(where.file, where.line, where.column))
      return;
  }
  diagnostics_.push_back({std::move(where), std::move(fact), std::move(mend)});
  if (diagnostics_.size() >= most) throw_if_any();
}

void Findings::throw_if_any() {
  if (diagnostics_.empty()) return;
  std::stable_sort(diagnostics_.begin(), diagnostics_.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::tie(a.where.file, a.where.line, a.where.column) <
           std::tie(b.where.file, b.where.line, b.where.column);
  });
  throw ModelError(std::move(diagnostics_));
}

}  // namespace anholon
