// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The kinematic reduction of a program: one kernel basis where one serves the whole working range, else an
// atlas of pivoted charts. Whether a basis serves is not left to samples: a search looks for configurations
// where it is singular although (A, B_p) keeps its rank, and what it finds takes part in the next choice.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "derive/symbols.hpp"
#include "reduce/kernel.hpp"

namespace anholon {

struct KernelAtlas {
  std::vector<std::unique_ptr<KinematicReduction>> charts;  // one where it is regular everywhere
  std::vector<Expr> quality;                                // of each chart; empty where there is one
  std::optional<std::string> first_basis_singular_at;       // why one basis was not enough
  std::optional<std::string> singular_at;                   // what no chart serves, if the search found it
};

struct AtlasRequest {
  const Model* model = nullptr;
  ConstraintRows rows;
  const RankAnalysis* ranks = nullptr;
  Inverse inverse = Inverse::pseudo;
  std::vector<int> preferred_free;  // the description's choice: one basis that has them
  std::vector<std::string> passive_names;
  std::vector<SampleState> samples;
};

KernelAtlas choose_atlas(Tape& tape, const ProgramSymbols& symbols, const AtlasRequest& request);

}  // namespace anholon
