// SPDX-License-Identifier: GPL-2.0-or-later
#include "report/motion_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace anholon {

using nlohmann::ordered_json;

namespace {

ordered_json json_of(const ContactHistory& contact) {
  ordered_json j = {{"contact", contact.contact}};
  if (!contact.has_normal) return j;
  const auto time = [](const std::optional<double>& t) { return t ? ordered_json(*t) : ordered_json(); };
  j["least_normal_N"] = contact.least_normal, j["at_s"] = contact.least_normal_at;
  j["lifts_at_s"] = time(contact.lifts_at);
  if (!contact.has_friction) return j;
  j["largest_utilisation"] = finite_or_null(contact.largest_utilisation),
  j["utilisation_at_s"] = contact.utilisation_at;
  j["slips_at_s"] = time(contact.slips_at);
  return j;
}

ordered_json json_of(const ContactSwitch& at) {
  ordered_json impulses;
  for (const auto& [row, impulse] : at.impulses) impulses[row] = impulse;
  return {{"t", at.t},
          {"from", at.from},
          {"to", at.to},
          {"energy_lost_J", at.lost},
          {"motor_work_J", at.work},
          {"relative_jump", at.relative},
          {"impulses", impulses}};
}

ordered_json to_json(const CostPoint& p) {
  return {{"steps", p.jacobians},
          {"evaluations", p.evaluations},
          {"cpu_seconds", p.cpu_seconds},
          {"error", finite_or_null(p.error)},
          {"tolerance", p.tolerance}};
}

}  // namespace

ordered_json finite_or_null(double x) { return std::isfinite(x) ? ordered_json(x) : nullptr; }

std::string integrator_text(const Integrator& integrator, Integrator::Method method) {
  switch (method) {
    case Integrator::Method::dopri5:
      return fmt::format("Dormand-Prince 5(4) in Lie form, tolerance {:g}", integrator.tolerance);
    case Integrator::Method::dopri8:
      return fmt::format("Dormand-Prince 8(5,3) in Lie form, tolerance {:g}", integrator.tolerance);
    case Integrator::Method::rkmk4:
      return fmt::format("Munthe-Kaas RK4, step {:g} s", integrator.step);
    case Integrator::Method::rkmk8:
      return fmt::format("Munthe-Kaas RK8, step {:g} s", integrator.step);
    case Integrator::Method::cf4:
      return fmt::format("commutator-free, order 4, step {:g} s", integrator.step);
    case Integrator::Method::rodas5p:
      return fmt::format("Rodas5P 5(4), stiff, in Lie form, tolerance {:g}", integrator.tolerance);
    case Integrator::Method::automatic:
      break;  // a motion has one of the others
  }
  return "";
}

ordered_json to_json(const Scene& scene, const SimulationResult& result) {
  ordered_json contacts = ordered_json::array(), switches = contacts;
  for (const ContactHistory& contact : result.contacts) contacts.push_back(json_of(contact));
  for (const ContactSwitch& at : result.switches) switches.push_back(json_of(at));
  return {{"schema", "anholon.simulation/1"},
          {"model", scene.model.name},
          {"scene", scene.name},
          {"status", result.status},
          {"finished", result.finished},
          {"table_I", result.class_of_table_I},
          {"integrator", integrator_text(scene.integrator, result.method)},
          {"why", result.why},
          {"projected", result.projected},
          {"departure", finite_or_null(result.departure)},
          {"charts", result.charts},
          {"chart_changes_s", result.chart_changes},
          {"steps", result.steps},
          {"rejected", result.rejected},
          {"evaluations", result.evaluations},
          {"operations_per_evaluation", result.operations},
          {"jacobians", result.jacobians},
          {"operations_per_jacobian", result.jacobian_operations},
          {"nanoseconds_per_evaluation", result.nanoseconds_per_evaluation},
          {"cpu_seconds", result.cpu_seconds},
          {"largest_energy", finite_or_null(result.largest_energy)},
          {"energy_balance", finite_or_null(result.energy_balance)},
          {"constraint_residual", finite_or_null(result.constraint_residual)},
          {"position_residual_m", finite_or_null(result.position_residual)},
          {"orthonormality", finite_or_null(result.orthonormality)},
          {"rounding_of_accelerations", finite_or_null(result.rounding.error)},
          {"lost_digits", result.rounding.is_loss()},
          {"switches", switches},
          {"contacts", contacts}};
}

ordered_json to_json(const Scene& scene, const WorkPrecision& result) {
  const char* rung = result.by_step ? "step" : "tolerance";
  ordered_json j = {{"schema", "anholon.work_precision/1"},
                    {"model", scene.model.name},
                    {"scene", scene.name},
                    {"method", scene.integrator.name()},
                    {"reference",
                     {{"method", result.reference_method + ", long double"},
                      {"steps", result.reference_steps},
                      {"own_error", finite_or_null(result.reference_error)}}}};
  for (const char* code : {"generated", "recursion"}) {
    const RoundingFloor floor = rounding_floor(result, code);
    j["floor"][code] = {
        {"error", finite_or_null(floor.error)}, {rung, floor.tolerance}, {"seen", floor.seen}};
  }
  for (const WorkPrecisionPoint& p : result.points)
    j["points"].push_back({{"code", p.code},
                           {rung, p.tolerance},
                           {"error", finite_or_null(p.error)},
                           {"cpu_seconds", p.cpu_seconds},
                           {"evaluations", p.evaluations},
                           {"status", p.status}});
  return j;
}

ordered_json to_json(const Scene& scene, const StiffnessCost& result) {
  ordered_json j = {{"schema", "anholon.stiffness_cost/1"},
                    {"model", scene.model.name},
                    {"scene", scene.name},
                    {"operations", result.operations},
                    {"jacobian_operations", result.jacobian_operations},
                    {"rows", ordered_json::array()}};
  for (const StiffnessCostRow& row : result.rows)
    j["rows"].push_back({{"factor", row.factor},
                         {"fastest_per_s", row.fast},
                         {"stiff", to_json(row.stiff)},
                         {"explicit", to_json(row.explicit_method)},
                         {"reference_error", finite_or_null(row.reference_error)}});
  return j;
}

}  // namespace anholon
