// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What is measured of one model, and of one motion, as JSON: the report's page and the figures of the
// documentation are made from these records alone.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "derive/derive.hpp"
#include "derive/tree_functions.hpp"
#include "describe/scene.hpp"

namespace anholon {

/// Told what is being done.
using Stage = std::function<void(const std::string& what)>;

/// The programs that are kept for one aim, with their rounding errors.
struct ModeResult {
  OptimiseFor mode = OptimiseFor::balanced;
  std::vector<CandidateReport> kept;  // one a function
};

/// A model with what the generator made of it: functions of the reduction, or of a tree.
struct GeneratedModel {
  const Model& model;
  const Derivation* reduction = nullptr;
  const TreeDerivation* tree = nullptr;
  double seconds = 0;  // of the derivation
  std::vector<ModeResult> modes = {};

  [[nodiscard]] const Program& program() const {
    return tree != nullptr ? tree->program : reduction->program;
  }
  [[nodiscard]] const std::vector<CandidateReport>& candidates() const {
    return tree != nullptr ? tree->candidates : reduction->candidates;
  }
  [[nodiscard]] const std::vector<PassReport>& trace() const {
    return tree != nullptr ? tree->trace : reduction->trace;
  }
};

struct MeasureOptions {
  int samples = 1000;  // random states at which errors are measured
  int states = 1024;   // random states that a timing goes through
  int rounds = 25;     // of timings
};

/// Sizes, class, operations and rounding by route, pass and aim of the optimiser, generation and compilation,
/// time of each function in double and float, and its error against exact evaluation. Schema
/// anholon.report.model/1.
nlohmann::ordered_json model_record(const GeneratedModel& generated, const MeasureOptions& options,
                                    const Stage& stage);

/// Additions, multiplications, divisions, their sum; sines and cosines.
nlohmann::ordered_json operations_record(const OperationCount& count);

/// One motion as its scene has it, and error against cost along the ladder of tolerances. A motion that has
/// no such ladder says why in "left_out". Schema anholon.report.motion/1.
nlohmann::ordered_json motion_record(const Scene& scene, const Stage& stage);

/// Processor, compiler and flags that all figures belong to.
nlohmann::ordered_json machine_record();

}  // namespace anholon
