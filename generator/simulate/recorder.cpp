// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace anholon {
namespace {

/// Unit of the multiplier of a row: N where the row is the velocity of points, N m where bodies only turn in
/// it.
const char* multiplier_unit(const Model& model, const RowDescription& row) {
  for (const ContactForceDescription& contact : model.contact_forces) {
    if (std::ranges::count(contact.shares, row.name, &ContactForceDescription::Share::row) > 0) return "N";
  }
  if (row.terms.empty()) return "mixed";  // written by the user
  for (const RowTermDescription& term : row.terms) {
    for (const Expr& x : term.linear) {
      if (!x.is_zero()) return "N";
    }
  }
  return "N m";
}

}  // namespace

Recorder::Recorder(const SceneProgram& program, Runner<double>& run, EnergyMonitor& energy,
                   const SharingRule& sharing, SimulationResult& result, const RowObserver& observer)
    : program_(program),
      run_(run),
      result_(result),
      observer_(observer),
      energy_(energy),
      compatibility_(program, run),
      rank_(program, run),
      sharing_(sharing) {
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
                       multiplier_unit(program.model, row)),
           b.lambda[i]);
  }
  name_contacts();
  for (std::size_t i = 0; i < contact_values_.size(); ++i) {
    const ContactHistory& contact = result_.contacts[i];
    const ContactValues& values = contact_values_[i];
    if (contact.has_normal) column(contact.contact + ".normal [N]", values.normal);
    if (program.model.contact_forces[i].has_directions) {
      column(contact.contact + ".longitudinal [N]", values.longitudinal);
      column(contact.contact + ".lateral [N]", values.lateral);
    } else {
      column(contact.contact + ".tangential [N]", values.tangential);
    }
    if (contact.has_friction && contact.has_normal) {
      column(contact.contact + ".utilisation [1]", values.utilisation);
      column(contact.contact + ".flag [1]", values.flag);
    }
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
  if (run_.contact_shares && run_.multipliers) observe_contacts(run_.b.t[0]);
}

void Recorder::name_contacts() {
  if (!run_.multipliers) return;
  const auto rows = static_cast<Eigen::Index>(program_.model.rows.size());
  problem_.lambda = Eigen::VectorXd::Zero(rows);
  for (const ContactForceDescription& contact : program_.model.contact_forces) {
    ContactHistory history;
    history.contact = contact.contact;
    history.has_normal = contact.has_normal;
    history.has_friction = contact.friction.has_value();
    history.least_normal = std::numeric_limits<double>::infinity();
    result_.contacts.push_back(history);
    ContactMap map;
    map.name = contact.contact;
    map.unilateral = contact.unilateral;
    map.normal = Eigen::MatrixXd::Zero(contact.has_normal ? 1 : 0, rows);
    map.tangential = Eigen::MatrixXd::Zero(contact.has_directions ? 2 : 3, rows);
    problem_.contacts.push_back(map);
  }
  contact_values_.resize(problem_.contacts.size());
}

/// lambda_stat by the scene's rule, and the torques and multipliers that follow.
void Recorder::share_loads() {
  std::vector<double>& s = run_.b["lambda_stat"];
  std::ranges::fill(s, 0.0);
  if (run_.multipliers) run_.multipliers();
  if (run_.contact_shares) run_.contact_shares();
  const std::vector<double>&shares = run_.b["shares"], &friction = run_.b["friction"];
  const std::vector<RowDescription>& rows = program_.model.rows;
  std::size_t next = 0;
  for (std::size_t c = 0; c < problem_.contacts.size(); ++c) {
    const ContactForceDescription& contact = program_.model.contact_forces[c];
    ContactMap& map = problem_.contacts[c];
    map.friction = friction[c];
    for (std::size_t k = 0; k < contact.shares.size(); ++k, next += 3) {
      const auto row = std::ranges::find(rows, contact.shares[k].row, &RowDescription::name) - rows.begin();
      if (row == static_cast<std::ptrdiff_t>(rows.size())) continue;  // holds by itself in this scene
      if (contact.has_normal) map.normal(0, row) = shares[next];
      if (contact.has_directions) {
        map.tangential(0, row) = shares[next + 1], map.tangential(1, row) = shares[next + 2];
      } else {  // the rows are components: what is left of them across the normal
        for (std::size_t j = 0; j < contact.shares.size() && j < 3; ++j)
          map.tangential(static_cast<Eigen::Index>(j), row) =
              (j == k ? 1.0 : 0.0) - shares[next] * shares[next - 3 * k + 3 * j];
      }
    }
  }
  for (Eigen::Index i = 0; i < problem_.lambda.size(); ++i)
    problem_.lambda(i) = run_.b.lambda[static_cast<std::size_t>(i)];
  if (s.empty()) return;
  const std::vector<double>& N = run_.b["lambda_stat_basis"];
  const auto columns = static_cast<Eigen::Index>(s.size());
  problem_.N = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      N.data(), problem_.lambda.size(), columns);
  const Eigen::VectorXd chosen = sharing_(problem_);
  for (Eigen::Index i = 0; i < columns; ++i) s[static_cast<std::size_t>(i)] = chosen(i);
  problem_.lambda += problem_.N * chosen;
  if (run_.multipliers) run_.multipliers();
}

void Recorder::observe_contacts(double t) {
  share_loads();
  for (std::size_t c = 0; c < problem_.contacts.size(); ++c) {
    const ContactMap& map = problem_.contacts[c];
    ContactValues& values = contact_values_[c];
    ContactHistory& history = result_.contacts[c];
    const Eigen::VectorXd tangential = map.tangential * problem_.lambda;
    values.longitudinal = tangential(0), values.lateral = tangential(1);
    values.tangential = tangential.norm();
    if (!history.has_normal) continue;
    values.normal = (map.normal * problem_.lambda)(0);
    if (values.normal < history.least_normal)
      history.least_normal = values.normal, history.least_normal_at = t;
    const bool lifts = map.unilateral && values.normal < 0;
    if (lifts && !history.lifts_at) history.lifts_at = t;
    if (!history.has_friction) continue;
    values.utilisation = values.normal > 0 ? values.tangential / (map.friction * values.normal)
                                           : std::numeric_limits<double>::infinity();
    if (values.utilisation > history.largest_utilisation)
      history.largest_utilisation = values.utilisation, history.utilisation_at = t;
    const bool slips = values.utilisation > 1;
    if (slips && !history.slips_at) history.slips_at = t;
    values.flag = lifts ? 2 : slips ? 1 : 0;
  }
}

void Recorder::add_row() {
  if (!run_.contact_shares && run_.multipliers) share_loads();
  if (run_.torques) run_.torques();
  std::vector<double> row;
  for (const double* source : sources_) row.push_back(*source);
  result_.rows.push_back(std::move(row));
  if (observer_) observer_(program_, run_);
}

void Recorder::forget_sharing() { std::ranges::fill(run_.b["lambda_stat"], 0.0); }

}  // namespace anholon
