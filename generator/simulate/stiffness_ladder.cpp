// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/stiffness_ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "describe/specialise.hpp"
#include "simulate/simulation.hpp"

namespace anholon {
namespace {

/// Last values of the columns that begin with "lambda_" and the name of a row.
Eigen::VectorXd last_multipliers(const SimulationResult& result, const std::vector<std::string>& rows) {
  Eigen::VectorXd lambda = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(rows.size()), NAN);
  for (std::size_t i = 0; i < rows.size() && !result.rows.empty(); ++i) {
    const std::string name = "lambda_" + rows[i] + " ";
    const auto at =
        std::ranges::find_if(result.columns, [&](const std::string& c) { return c.starts_with(name); });
    if (at != result.columns.end())
      lambda(static_cast<Eigen::Index>(i)) =
          result.rows.back()[static_cast<std::size_t>(at - result.columns.begin())];
  }
  return lambda;
}

}  // namespace

StiffnessLadder stiffness_ladder(const Scene& scene, const std::vector<double>& factors) {
  require_duration(scene);
  if (!scene.elasticity)
    throw ModelError(scene.where, "the scene's contacts are not elastic",
                     "write contact_elasticity = { stiffness = 1e5, damping = 1e3 }");
  StiffnessLadder ladder;
  Scene rigid = scene;
  rigid.elasticity.reset();
  rigid.sharing = LoadSharing::least_norm;
  for (const RowDescription& row : specialise(scene.model, rigid).rows) ladder.rows.push_back(row.name);
  const SimulationResult result_of_rigid = simulate_scene(rigid);
  if (!result_of_rigid.finished)
    throw ModelError(
        scene.where,
        fmt::format("with rigid contacts the motion stops before its end: {}", result_of_rigid.status),
        "end the scene before that, or give it a motion that rigid contacts allow");
  ladder.rigid = last_multipliers(result_of_rigid, ladder.rows);
  for (const double factor : factors) {
    Scene elastic = scene;
    elastic.elasticity->stiffness = scene.elasticity->stiffness * Exact::from_double(factor);
    elastic.elasticity->damping = scene.elasticity->damping * Exact::from_double(std::sqrt(factor));
    const SimulationResult result = simulate_scene(elastic);
    StiffnessStep step;
    step.stiffness = elastic.elasticity->stiffness.to_double();
    step.lambda = last_multipliers(result, ladder.rows);
    step.distance = (step.lambda - ladder.rigid).cwiseAbs().maxCoeff() / ladder.rigid.cwiseAbs().maxCoeff();
    step.evaluations = result.evaluations;
    step.status = result.status;
    ladder.steps.push_back(std::move(step));
  }
  return ladder;
}

}  // namespace anholon
