// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What is wrong with an input, collected while reading goes on, so that one run shows all of it.

#include <string>
#include <vector>

#include "describe/location.hpp"

namespace anholon {

class Findings {
 public:
  /// Most findings that one run reports.
  static constexpr std::size_t most = 20;

  /// Keeps an error; one error a place is enough. @throws ModelError with all findings when there are `most`
  void error(Location where, std::string fact, std::string mend);
  [[nodiscard]] bool empty() const { return diagnostics_.empty(); }
  [[nodiscard]] std::size_t size() const { return diagnostics_.size(); }
  /// @throws ModelError with all findings, file by file in their order, if there are any
  void throw_if_any();

 private:
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace anholon
