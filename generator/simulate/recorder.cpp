// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/recorder.hpp"

#include <fmt/format.h>

namespace anholon {
namespace {

/// Unit of the multiplier of a row: N where the row is the velocity of points, N m where bodies only turn in
/// it.
const char* multiplier_unit(const RowDescription& row) {
  if (row.terms.empty()) return "mixed";  // written by the user
  for (const RowTermDescription& term : row.terms) {
    for (const Expr& x : term.linear) {
      if (!x.is_zero()) return "N";
    }
  }
  return "N m";
}

}  // namespace

Recorder::Recorder(const SceneProgram& program, Runner<double>& run, SimulationResult& result,
                   const RowObserver& observer)
    : program_(program),
      run_(run),
      result_(result),
      observer_(observer),
      compatibility_(program, run),
      rank_(program, run) {
  const Buffers<double>& b = run.b;
  const Partition& p = program.original;
  const GroupKind group = program.model.group;
  const auto column = [&](std::string name, const double& source) {
    result_.columns.push_back(std::move(name));
    sources_.push_back(&source);
  };
  const auto coordinate = [&](int velocity) -> const Coordinate& {
    return program.model.coordinates[static_cast<std::size_t>(velocity - p.n)];
  };
  const auto rate = [&](int velocity, const double& source) {
    const Coordinate& c = coordinate(velocity);
    column(fmt::format("dot({}) [{}]", c.name, c.is_angle ? "rad/s" : "m/s"), source);
  };
  const auto is_driven = [&](int velocity) {
    return std::ranges::find(program.driven, velocity) != program.driven.end();
  };
  const std::vector<int> shape(p.passive.begin() + p.n, p.passive.end());

  column("t [s]", b.t[0]);
  if (group == GroupKind::SE2)
    column("x [m]", b.g[0]), column("y [m]", b.g[1]), column("theta [rad]", b.g[2]);
  for (std::size_t i = 0; i < b.p.size(); ++i) column(fmt::format("p_{} [m]", "XYZ"[i]), b.p[i]);
  if (group == GroupKind::SE3 || group == GroupKind::SO3) {
    for (std::size_t i = 0; i < 9; ++i) column(fmt::format("R_{}{} [1]", "XYZ"[i / 3], "XYZ"[i % 3]), b.R[i]);
  }
  const auto position = [&](int velocity, const double& source) {
    const Coordinate& c = coordinate(velocity);
    column(fmt::format("{} [{}]", c.name, c.is_angle ? "rad" : "m"), source);
  };
  for (std::size_t i = 0; i < shape.size(); ++i) position(shape[i], b.r_p[i]);
  for (std::size_t i = 0; i < p.active.size(); ++i) position(p.active[i], b.r_a[i]);

  const auto components = free_components(group);
  for (std::size_t i = 0; i < b.eta.size(); ++i) {
    const auto c = static_cast<std::size_t>(components[i]);
    column(fmt::format("{} [{}]", twist_component_names[c], c < 3 ? "m/s" : "rad/s"), b.eta[i]);
  }
  for (std::size_t i = 0; i < shape.size(); ++i) rate(shape[i], b.r_p_dot[i]);
  std::size_t motion = 0, driven = 0;
  for (const int i : p.active) rate(i, is_driven(i) ? b.r_d_dot[driven++] : b.r_a_dot[motion++]);
  for (std::size_t i = 0; i < b.nu.size(); ++i) column(fmt::format("nu_{} [mixed]", i + 1), b.nu[i]);

  if (run.charts() > 1) column("chart [1]", run.chart_number);

  motion = driven = 0;
  for (const int i : p.active) {
    if (!is_driven(i) && !run.torques) continue;
    column(fmt::format("tau_{} [{}]", coordinate(i).name, coordinate(i).is_angle ? "N m" : "N"),
           is_driven(i) ? b.torque[driven++] : b.tau_a[motion++]);
  }
  for (std::size_t i = 0; run.multipliers && i < program.model.rows.size(); ++i) {
    const RowDescription& row = program.model.rows[i];
    column(fmt::format("lambda_{} [{}]", row.name.empty() ? std::to_string(i + 1) : row.name,
                       multiplier_unit(row)),
           b.lambda[i]);
  }
  column("kinetic [J]", b.kinetic[0]), column("potential [J]", potential_), column("work [J]", work_);
  column("dissipated [J]", dissipated_), column("energy defect [J]", defect_);
  column("constraint residual [1]", residual_);
  if (!program.model.positions.empty()) column("position residual [m]", position_residual_);
}

void Recorder::observe() {
  if (run_.rates) run_.rates();
  if (run_.energies) run_.energies();
  potential_ = run_.b.gravity[0] + run_.b.elastic[0];
  defect_ = energy_.observe(run_.b.kinetic[0], potential_, work_, dissipated_);
  result_.energy_balance = energy_.largest_relative_defect();
  result_.largest_energy = energy_.scale();
  residual_ = constraint_residual(program_, run_);
  result_.constraint_residual = std::max(result_.constraint_residual, residual_);
  if (result_.violation.empty()) result_.violation = compatibility_.violation(run_.b.t[0]);
  if (!result_.violation.empty()) run_.stop();
}

void Recorder::add_row() {
  if (run_.torques) run_.torques();
  if (run_.multipliers) run_.multipliers();
  std::vector<double> row;
  for (const double* source : sources_) row.push_back(*source);
  result_.rows.push_back(std::move(row));
  if (observer_) observer_(program_, run_);
}

}  // namespace anholon
