// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// From a description to a program: the wanted functions, derived on one tape. Each comes from the routes that
// exist for it; the shortest of those that keep enough digits is taken.

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "derive/state_jacobian.hpp"
#include "describe/model.hpp"
#include "optimise/accuracy/choice.hpp"
#include "optimise/tape/count.hpp"
#include "reduce/kernel.hpp"
#include "tape/interface.hpp"

namespace anholon {

struct DeriveRequest {
  std::string scene = "standard";
  std::vector<std::string> functions;   // wanted; empty: every one that the model has
  std::set<std::string> torque_driven;  // active coordinates whose torque is given in the reduced dynamics
  Inverse inverse = Inverse::pseudo;
  std::vector<int> leading_rows;  // for Inverse::leading; row indices
  bool closed_forms = true;       // also try the simplified closed form of each function
  bool rates = false;             // fill Derivation::rates
  bool state_jacobian = false;    // also that function, which no empty list of functions stands for
  OptimiseFor optimise = OptimiseFor::balanced;
  bool trace = false;  // fill Derivation::trace, and the errors of all candidates
};

/// What a route to a function costs.
struct CandidateReport {
  std::string function;
  std::string route;
  int operations = 0;
  bool chosen = false;
  RoundingError error{};  // where it was measured
};

/// Operations of one call of a function after a pass, and what rounding costs then; the algorithm is the one
/// that was kept.
struct PassReport {
  std::string function;
  std::string pass;
  int operations = 0;
  RoundingError error{};
};

/// Reduction of one partition, for reports.
struct ReductionReport {
  Partition partition;
  RankAnalysis ranks;
  Kernel kernel;  // on the program's tape; of the first chart
  Inverse inverse = Inverse::pseudo;
  std::vector<Kernel> charts;                  // more than one where no basis serves the whole range
  std::optional<std::string> why_charts = {};  // a configuration where the best single basis is singular
  std::optional<std::string> unserved = {};    // one that no chart serves, if a search found it
};

/// What stands before the names of a chart's functions: nothing for the first, "chart2::" for the second.
std::string chart_prefix(std::size_t chart);

struct Derivation {
  Program program;
  ReductionReport reduction;                     // motion-driven
  std::optional<ReductionReport> torque_driven;  // all active coordinates by torque, where it was wanted
  std::vector<CandidateReport> candidates;
  std::vector<PassReport> trace;  // in the order in which the passes run, function by function
  /// For each chart: (input, its time derivative at the velocities that nu and r_a_dot mean) of pose, shape
  /// and t.
  std::vector<std::vector<std::pair<NodeId, NodeId>>> rates;
  StateDirections directions;  // where state_jacobian was wanted
};

/// Operations of one call: what depends on parameters alone is computed by `prepare` and costs nothing here.
OperationCount operations_per_call(const Program& program, const std::vector<NodeId>& roots);

/// What a program is of, and its name space.
/// @param functions  wanted of it
/// @param known  those that there are
/// @throws std::invalid_argument for one that there is not
void begin_program(Program& program, const Model& model, const std::string& scene,
                   const std::vector<std::string>& functions, const std::vector<std::string>& known);

/// @throws UnsupportedError, std::invalid_argument for a function name that does not exist
std::unique_ptr<Derivation> derive(const Model& model, const DeriveRequest& request = {});

}  // namespace anholon
