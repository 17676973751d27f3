// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The program of a scene: its wanted functions, and some more of its own: `imposed(t)` and
// `imposed_torque`, the motions and torques that the scene gives, `rates`, all that one evaluation of the
// field needs, `field_jacobian`, its derivative for a stiff integrator, and `contact_shares`, of the
// multipliers in the contact forces.

#include <memory>
#include <string>
#include <vector>

#include "derive/derive.hpp"
#include "describe/scene.hpp"
#include "reduce/partition.hpp"

namespace anholon {

struct SceneProgram {
  Model model;  // specialised
  std::unique_ptr<Derivation> derivation;
  Partition original, reduced;   // all active apart; torque-driven ones with the passive
  std::vector<int> driven;       // torque-driven velocity indices
  bool projects_motion = false;  // the imposed rates are moved to compatible ones: r_a is part of the state
  int operations = 0;            // of one evaluation of the field
  int jacobian_operations = 0;   // of its derivative; 0 where nothing asks for it
};

SceneProgram make_program(const Scene& scene);

/// Whether its program has a Jacobian: where the integrator may use one, and the motion is given with all of
/// its derivatives.
bool has_jacobian(const Scene& scene);

/// Functions `projected_rates` and `projected_accelerations`: from the wanted rates r_m_dot(t) to the nearest
/// that are compatible where the robot is, and their exact time derivative,
///
///   r_a_dot = r_m_dot - C^T (C C^T)^-1 C r_m_dot,   C = N^T B_a.
void add_projection(SceneProgram& program);

/// Function `field_jacobian` of a chart: the derivative of all rates that an integrator sees, quadratures
/// included. Where the program has been derived with state_jacobian.
void add_field_jacobian(SceneProgram& program, std::size_t chart);

/// Nodes of an output of a function; none where the program has no such output.
std::vector<NodeId> output_of(const Program& program, const std::string& function, const std::string& block);

/// Nodes of the program for expressions of the scene. Velocities are those that nu and r_a_dot mean in a
/// chart.
std::vector<NodeId> scene_expressions(const Scene& scene, const SceneProgram& program,
                                      const std::vector<Expr>& expressions, std::size_t chart = 0);

}  // namespace anholon
