// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the verbs share: reading a model with its scene, the choice of inverse, files and progress.

#include <chrono>
#include <memory>
#include <string>

#include "cli/commands.hpp"
#include "derive/derive.hpp"
#include "derive/tree_functions.hpp"
#include "describe/model.hpp"
#include "describe/scene.hpp"

namespace anholon::cli {

/// --scene, or MODEL where that is a scene; empty where there is none.
std::string scene_file(const ModelOptions& options);
/// The scene that the options name, with the contact set that they choose.
Scene load_scene(const ModelOptions& options);
/// The model, specialised to the scene if one is named.
Model load_model(const ModelOptions& options);
/// What the generator makes of a model: functions of the reduction, or those of a tree whose joints are all
/// driven. Exactly one of the two is there.
struct AnyDerivation {
  std::unique_ptr<Derivation> reduction;
  std::unique_ptr<TreeDerivation> tree;

  [[nodiscard]] const Program& program() const { return tree ? tree->program : reduction->program; }
  [[nodiscard]] const std::vector<CandidateReport>& candidates() const {
    return tree ? tree->candidates : reduction->candidates;
  }
  [[nodiscard]] const std::vector<PassReport>& trace() const { return tree ? tree->trace : reduction->trace; }
};

/// Whether the functions of a tree are wanted: of a robot file as it stands, without a scene, unless a
/// function is named that only the reduction has; of another model, where a function is named that only a
/// tree has.
bool wants_tree(const ModelOptions& options, const Model& model);
/// @param trace  also fill the traces and the errors of all candidates
AnyDerivation derive_any(const ModelOptions& options, const Model& model, bool trace = false);
TreeRequest tree_request(const ModelOptions& options);

/// Functions, inverse and scene name as a request.
DeriveRequest derive_request(const ModelOptions& options, const Model& model);

/// `check` for a robot from a robot file.
int check_tree(const CheckOptions& options, const Model& model);

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
