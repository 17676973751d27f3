// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/scene_program.hpp"

#include <algorithm>
#include <string>

#include "describe/specialise.hpp"
#include "optimise/tape/count.hpp"
#include "tape/derivative.hpp"

namespace anholon {

bool has_jacobian(const Scene& scene) {
  return may_be_stiff(scene.integrator) && !scene.project_motion && !scene.motion_table;
}

namespace {

/// The entry that a scene has for each of some velocities; `missing` where it has none.
template <class Entry>
std::vector<Entry> entries_for(const Scene& scene, const SceneProgram& p, const std::vector<Entry>& entries,
                               const std::vector<int>& velocities, const Entry& missing) {
  const std::vector<int> kept = kept_coordinates(scene.model, scene);
  std::vector<Entry> result;
  for (const int i : velocities) {
    const auto found = std::ranges::find_if(entries, [&](const Entry& entry) {
      return kept[static_cast<std::size_t>(entry.coordinate)] == i - p.original.n;
    });
    result.push_back(found == entries.end() ? missing : *found);
  }
  return result;
}

/// r_a(t) and its derivatives, in the order of the reduced partition's active coordinates.
void add_imposed_motion(const Scene& scene, SceneProgram& p) {
  const int size = p.reduced.s_a();
  if (size == 0 || scene.motion_table) return;
  std::vector<Expr> r, r_dot, r_ddot, r_dddot;
  Tape& tape = *scene.model.tape;
  for (const ImposedMotion& m : entries_for(scene, p, scene.motion, p.reduced.active, {})) {
    r.push_back(m.r);
    r_dot.push_back(m.r_dot);
    r_ddot.push_back(m.r_ddot);
    if (has_jacobian(scene))
      r_dddot.emplace_back(tape, derivative(tape, m.r_ddot.id(tape), scene.model.symbols.t));
  }
  Function imposed{"imposed", "Imposed motion of the active coordinates.", {}, ""};
  imposed.outputs = {
      {"r_m", "rad or m", "motion-driven coordinates", size, 1, scene_expressions(scene, p, r)},
      {"r_m_dot", "rad/s or m/s", "their rates", size, 1, scene_expressions(scene, p, r_dot)},
      {"r_m_ddot", "rad/s^2 or m/s^2", "their second derivatives", size, 1,
       scene_expressions(scene, p, r_ddot)}};
  if (has_jacobian(scene))
    imposed.outputs.push_back({"r_m_dddot", "rad/s^3 or m/s^3", "their third derivatives", size, 1,
                               scene_expressions(scene, p, r_dddot)});
  p.derivation->program.functions.push_back(std::move(imposed));
}

void add_imposed_torque(const Scene& scene, SceneProgram& p) {
  if (p.driven.empty()) return;
  std::vector<Expr> torque;
  for (const ImposedTorque& t : entries_for(scene, p, scene.torques, p.driven, {}))
    torque.push_back(t.torque);
  const int size = static_cast<int>(torque.size());
  for (std::size_t c = 0; c < p.derivation->reduction.charts.size(); ++c) {  // velocities are those of nu
    p.derivation->program.functions.push_back({chart_prefix(c) + "imposed_torque",
                                               "Torques on the torque-driven coordinates.",
                                               {{"torque", "N m or N", "torque-driven coordinates", size, 1,
                                                 scene_expressions(scene, p, torque, c)}},
                                               ""});
  }
}

/// Velocities and reduced accelerations by one program, so that what they share is computed once.
void add_rates(SceneProgram& p, std::size_t chart) {
  Program& program = p.derivation->program;
  const std::string prefix = chart_prefix(chart);
  Function rates{
      prefix + "rates", "Velocities and reduced accelerations for one evaluation of the field.", {}, ""};
  std::vector<NodeId> roots;
  for (const Function& f : program.functions) {
    for (const OutputBlock& b : f.outputs) {
      const bool velocity =
          f.name == prefix + "kinematics" && (b.name == "eta" || b.name == "r_p_dot" || b.name == "r_d_dot");
      if (!velocity && !(f.name == prefix + "forward_dynamics" && b.name == "nu_dot")) continue;
      rates.outputs.push_back(b);
      roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
    }
  }
  p.operations = std::max(p.operations, operations_per_call(program, roots).total());
  if (!rates.outputs.empty()) program.functions.push_back(std::move(rates));
}

/// How the multipliers make up the force of each contact: by contact, by row, (normal, longitudinal,
/// lateral).
void add_contact_shares(const Scene& scene, SceneProgram& p) {
  std::vector<Expr> shares, friction;
  for (const ContactForceDescription& contact : scene.model.contact_forces) {
    const auto is_it = [&](const auto& other) { return other.contact == contact.contact; };
    if (std::ranges::none_of(p.model.contact_forces, is_it)) continue;
    for (const ContactForceDescription::Share& share : contact.shares)
      shares.insert(shares.end(), {share.normal, share.longitudinal, share.lateral});
    friction.push_back(contact.friction.value_or(Expr(0)));
  }
  if (shares.empty()) return;
  const int rows = static_cast<int>(shares.size()) / 3, contacts = static_cast<int>(friction.size());
  p.derivation->program.functions.push_back(
      {"contact_shares",
       "Shares of the multipliers in the contact forces.",
       {{"shares", "1", "rows of contacts x 3", rows, 3, scene_expressions(scene, p, shares)},
        {"friction", "1", "coefficients, 0 where none is given", contacts, 1,
         scene_expressions(scene, p, friction)}},
       ""});
}

}  // namespace

std::vector<NodeId> output_of(const Program& program, const std::string& function, const std::string& block) {
  for (const Function& f : program.functions) {
    for (const OutputBlock& b : f.outputs) {
      if (f.name == function && b.name == block) return b.nodes;
    }
  }
  return {};
}

SceneProgram make_program(const Scene& scene) {
  SceneProgram p{specialise(scene.model, scene), nullptr, {}, {}, {}};
  DeriveRequest request;
  request.scene = program_name(scene);
  request.torque_driven = {scene.torque_driven.begin(), scene.torque_driven.end()};
  request.optimise = optimise_for(scene.optimise);
  request.functions = {"kinematics",       "reduced_velocities", "constraints",
                       "forward_dynamics", "inverse_torques",    "multipliers",
                       "compatibility",    "energies",           "position_conditions"};
  request.rates = scene.project_motion || !scene.initial.equilibrium.empty();
  request.state_jacobian = has_jacobian(scene);
  if (scene.integrator.method == Integrator::Method::rodas5p && !request.state_jacobian)
    throw ModelError(scene.integrator.where,
                     "the method rodas5p needs a motion whose derivatives are known, not one from a table or "
                     "a projection",
                     "write the motion as expressions, or take dopri5");
  p.derivation = derive(p.model, request);
  p.original = partition_of(p.model);
  p.reduced = partition_of(p.model, request.torque_driven);
  for (const int i : p.original.active) {
    if (std::ranges::find(p.reduced.active, i) == p.reduced.active.end()) p.driven.push_back(i);
  }
  add_imposed_torque(scene, p);
  add_imposed_motion(scene, p);
  if (scene.project_motion) add_projection(p);
  for (std::size_t c = 0; c < p.derivation->reduction.charts.size(); ++c) {
    add_rates(p, c);
    if (request.state_jacobian) add_field_jacobian(p, c);
  }
  add_contact_shares(scene, p);
  return p;
}

}  // namespace anholon
