// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What a motion was, and what its accuracy cost, as JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "describe/scene.hpp"
#include "simulate/simulation.hpp"
#include "simulate/stiffness_cost.hpp"
#include "simulate/work_precision.hpp"

namespace anholon {

/// A number that JSON can hold; null where there is none.
nlohmann::ordered_json finite_or_null(double x);

/// @param method  the one that ran
std::string integrator_text(const Integrator& integrator, Integrator::Method method);

/// Schema anholon.simulation/1.
nlohmann::ordered_json to_json(const Scene& scene, const SimulationResult& result);

/// Schema anholon.work_precision/1.
nlohmann::ordered_json to_json(const Scene& scene, const WorkPrecision& result);

/// Schema anholon.stiffness_cost/1.
nlohmann::ordered_json to_json(const Scene& scene, const StiffnessCost& result);

}  // namespace anholon
