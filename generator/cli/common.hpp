// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the verbs share: reading a model with its scene, the choice of inverse, files and progress.

#include <chrono>
#include <string>

#include "cli/commands.hpp"
#include "derive/derive.hpp"
#include "describe/model.hpp"

namespace anholon::cli {

/// The model, specialised to the scene if one is named.
Model load_model(const ModelOptions& options);
/// Functions, inverse and scene name as a request.
DeriveRequest derive_request(const ModelOptions& options, const Model& model);

/// Writes to the file by renaming a finished temporary, or to standard output if the name is empty.
void write_output(const std::string& path, const std::string& text);

/// Wall-clock seconds since construction.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace anholon::cli
