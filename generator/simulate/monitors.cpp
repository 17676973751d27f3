// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/monitors.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "anholon/monitors.hpp"

namespace anholon {

double EnergyMonitor::observe(double kinetic, double potential, double work, double dissipated) {
  if (!started_) initial_ = kinetic + potential, initial_potential_ = potential;
  started_ = true;
  const double defect = kinetic + potential - initial_ - work + dissipated;
  scale_ = std::max(
      {scale_, kinetic, std::abs(potential - initial_potential_), std::abs(work), std::abs(dissipated)});
  worst_ = std::max(worst_, std::abs(defect));
  return defect;
}

double constraint_residual(const SceneProgram& program, Runner<double>& run) {
  const auto rows = static_cast<Eigen::Index>(program.model.rows.size());
  if (rows == 0 || !run.constraints) return 0;
  run.constraints();
  const Buffers<double>& b = run.b;
  const Partition& p = program.original;
  Eigen::MatrixXd G(rows, p.n + p.s_p() + p.s_a());
  Eigen::VectorXd v(G.cols());
  const auto put = [&](const std::vector<double>& m, int cols, int at) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) G(i, at + j) = m[static_cast<std::size_t>(i * cols + j)];
    }
  };
  put(b.A, p.n, 0), put(b.B_p, p.s_p(), p.n), put(b.B_a, p.s_a(), p.n + p.s_p());
  for (int i = 0; i < p.n; ++i) v(i) = b.eta[static_cast<std::size_t>(i)];
  for (int i = 0; i < p.s_p(); ++i) v(p.n + i) = b.r_p_dot[static_cast<std::size_t>(i)];
  std::size_t motion = 0, driven = 0;
  for (int i = 0; i < p.s_a(); ++i) {
    const bool is_driven =
        std::ranges::find(program.driven, p.active[static_cast<std::size_t>(i)]) != program.driven.end();
    v(p.n + p.s_p() + i) = is_driven ? b.r_d_dot[driven++] : b.r_a_dot[motion++];
  }
  return relative_constraint_residual(G, v);
}

CompatibilityMonitor::CompatibilityMonitor(const SceneProgram& program, Runner<double>& run)
    : program_(program), run_(run) {
  const RankAnalysis& ranks = program.derivation->reduction.ranks;
  for (int row = 0; row < ranks.rows; ++row) {
    if (std::ranges::find(ranks.leading_rows, row) == ranks.leading_rows.end()) implied_.push_back(row);
  }
  rate_size_.assign(implied_.size(), 0), accel_size_.assign(implied_.size(), 0);
}

std::string CompatibilityMonitor::violation(double t) {
  constexpr double allowed =
      1e-6;  // of the terms that should cancel: digits that a user may have rounded off
  if (!run_.compatibility || !run_.constraints) return {};
  run_.constraints(), run_.compatibility();
  const Buffers<double>& b = run_.b;
  const std::vector<double>& N = b.lambda_stat_basis;
  const std::size_t conditions = implied_.size();
  const std::vector<int>& active = program_.original.active;
  for (std::size_t i = 0; i < conditions; ++i) {
    double rate = 0, acceleration = 0;
    for (std::size_t row = 0; row < program_.model.rows.size(); ++row) {
      const double n = std::abs(N[row * conditions + i]);
      std::size_t motion = 0;
      acceleration += n * std::abs(b.bias[row]);
      for (std::size_t j = 0; j < active.size(); ++j) {
        if (std::ranges::find(program_.driven, active[j]) != program_.driven.end()) continue;
        const double entry = n * std::abs(b.B_a[row * active.size() + j]);
        rate += entry * std::abs(b.r_a_dot[motion]);
        acceleration += entry * std::abs(b.r_a_ddot[motion++]);
      }
    }
    rate_size_[i] = std::max(rate_size_[i], rate), accel_size_[i] = std::max(accel_size_[i], acceleration);
    const double residuals[] = {b.velocity_residual[i], b.acceleration_residual[i]};
    const double sizes[] = {rate_size_[i], accel_size_[i]};
    for (const int order : {0, 1}) {
      if (!(std::abs(residuals[order]) > allowed * sizes[order])) continue;
      const std::string& name = program_.model.rows[static_cast<std::size_t>(implied_[i])].name;
      return fmt::format(
          "the imposed {} violate row {} at t = {:.6g} s by {:.2g} of its terms, which the other rows leave "
          "no "
          "passive velocity to mend",
          order == 0 ? "rates" : "accelerations",
          name.empty() ? fmt::format("{}", implied_[i] + 1) : "'" + name + "'", t,
          std::abs(residuals[order]) / sizes[order]);
    }
  }
  return {};
}

}  // namespace anholon
