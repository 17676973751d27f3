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

std::string incompatibility(Runner<double>& run, double t) {
  if (!run.compatibility) return {};
  run.compatibility();
  for (std::size_t i = 0; i < run.b.velocity_residual.size(); ++i) {
    const double residual = run.b.velocity_residual[i];
    if (std::abs(residual) > 1e-6)
      return fmt::format("the imposed motion violates compatibility condition {} by {:.2g} at t = {:.6g} s",
                         i + 1, residual, t);
  }
  return {};
}

}  // namespace anholon
