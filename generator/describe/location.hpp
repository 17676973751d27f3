// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Places in input files and the one error type that says what to mend there.

#include <stdexcept>
#include <string>
#include <vector>

namespace anholon {

struct Location {
  std::string file;
  int line = 0;    // from 1; 0 where the whole file is meant
  int column = 0;  // from 1
};

/// One thing that is wrong with an input: where, what, and how to mend it.
struct Diagnostic {
  Location where;
  std::string fact;
  std::string mend;
  /// file:line:column: error: fact; mend
  [[nodiscard]] std::string text() const;
};

/// The user's input is wrong; carries everything that was found.
class ModelError : public std::runtime_error {
 public:
  explicit ModelError(std::vector<Diagnostic> diagnostics);
  ModelError(Location where, std::string fact, std::string mend);
  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// The input is right but asks for something that cannot be derived; names body, joint and step.
class UnsupportedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace anholon
