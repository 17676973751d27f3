// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What fast components cost: one scene, some of whose parameters grow, so that its compliant modes become
// faster; at each size the cost of one and the same accuracy, by the stiff and by the explicit method.

#include <functional>
#include <string>
#include <vector>

#include "describe/scene.hpp"

namespace anholon {

/// A parameter that grows with the factor to this power.
struct Growth {
  std::string parameter;
  double exponent = 1;
};

/// The cheapest integration of a ladder of tolerances whose final state is as good as wanted.
struct CostPoint {
  double tolerance = 0, error = 0, cpu_seconds = 0;
  long evaluations = 0, jacobians = 0;
};

struct StiffnessCostRow {
  double factor = 1;
  double fast = 0;  // mean spectral radius of the Jacobian along the motion, 1/s
  CostPoint stiff, explicit_method;
  double reference_error = 0;  // how far the reference moves when its steps are doubled
  double to_limit = 0;         // of the reference's final pose: from that at the largest factor
};

struct StiffnessCost {
  std::vector<StiffnessCostRow> rows;
  int operations = 0, jacobian_operations = 0;
  /// Largest number of evaluations of a row over that of a row before it; 1 where it never grows.
  [[nodiscard]] double growth(CostPoint StiffnessCostRow::*method) const;
};

/// Of the final state, relative to the sizes of the motion.
constexpr double cost_accuracy = 1e-6;

/// Factors are 1, 1e2, ..., 1e8: of a stiffness; frequencies then grow by ten from row to row.
/// @param fastest_explicit  rate [1/s] beyond which the explicit method is left out
/// @throws ModelError, CompileError, std::invalid_argument for a parameter that the model has not,
/// UnsupportedError where the kernel has several charts, or no reference converges at a factor
StiffnessCost stiffness_cost(const Scene& scene, const std::vector<Growth>& growths,
                             const std::function<void(const StiffnessCostRow&)>& on_row = {},
                             double fastest_explicit = 1e300);

/// Evaluations over frequency, as a picture.
std::string stiffness_cost_svg(const StiffnessCost& cost, const std::string& title);

}  // namespace anholon
