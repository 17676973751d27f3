// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The files of `evaluate`: states in, outputs out, both in the layout of the reference files.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "check/evaluated.hpp"
#include "describe/model.hpp"
#include "reduce/partition.hpp"

namespace anholon {

struct StatesFile {
  std::string file;                   // base name, for messages
  std::vector<std::string> r_p, r_a;  // names, in the file's order
  std::vector<Exact> parameters;      // in the model's order; the file's values override the model's
  struct Entry {
    std::string label;
    EvaluationInput<Exact> input;
    Spatial<Exact> eta_dot;  // for inverse dynamics of a tree; zero where it is not given
  };
  std::vector<Entry> states;
};

/// Extra keys are ignored; numbers may be JSON numbers or decimal strings.
/// @throws ModelError naming the file and the key
StatesFile read_states(const std::filesystem::path& path, const Model& model);

/// One state's outputs in the file's coordinate order. Doubles become JSON numbers, exact values decimal
/// strings.
template <class S>
nlohmann::ordered_json answer(const Model& model, const StatesFile& file, const Evaluated<S>& e,
                              const EvaluationInput<S>& input, unsigned digits);

/// A list of numbers, as in answer().
template <class S>
nlohmann::ordered_json number_list(const std::vector<S>& values, unsigned digits);

/// The inputs of a state rounded to S.
template <class S>
EvaluationInput<S> rounded_input(const EvaluationInput<Exact>& input);

}  // namespace anholon
