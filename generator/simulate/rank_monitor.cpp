// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/rank_monitor.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "reduce/decompositions.hpp"

namespace anholon {
namespace {

constexpr double incompatible = 1e-6;  // of the size of B_a r_a_dot: digits that a user may have rounded off
constexpr double takes_part = 0.05;    // of the largest entry of a combination of rows

}  // namespace

void RankMonitor::read_rows() {
  const auto rows = static_cast<Eigen::Index>(program_.model.rows.size());
  const Partition &original = program_.original, &reduced = program_.reduced;
  A_.setZero(rows, static_cast<Eigen::Index>(reduced.passive.size()));
  B_.setZero(rows, static_cast<Eigen::Index>(reduced.active.size()));
  if (rows == 0 || !run_.constraints) return;
  run_.constraints();
  const auto column = [&](int velocity) {
    const auto of = [&](const std::vector<double>& m, std::ptrdiff_t j, std::size_t cols) {
      Eigen::VectorXd c(rows);
      for (Eigen::Index i = 0; i < rows; ++i)
        c(i) = m[static_cast<std::size_t>(i) * cols + static_cast<std::size_t>(j)];
      return c;
    };
    if (velocity < original.n) return of(run_.b.A, velocity, static_cast<std::size_t>(original.n));
    const auto active = std::ranges::find(original.active, velocity);
    if (active != original.active.end())
      return of(run_.b.B_a, active - original.active.begin(), original.active.size());
    const auto passive = std::ranges::find(original.passive, velocity);
    return of(run_.b.B_p, passive - original.passive.begin() - original.n,
              static_cast<std::size_t>(original.s_p()));
  };
  for (std::size_t j = 0; j < reduced.passive.size(); ++j)
    A_.col(static_cast<Eigen::Index>(j)) = column(reduced.passive[j]);
  for (std::size_t j = 0; j < reduced.active.size(); ++j)
    B_.col(static_cast<Eigen::Index>(j)) = column(reduced.active[j]);
}

Eigen::MatrixXd RankMonitor::leading_rows() {
  read_rows();
  const std::vector<int>& leading = program_.derivation->reduction.ranks.leading_rows;
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(leading.size()), A_.cols());
  for (std::size_t i = 0; i < leading.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = A_.row(leading[i]).normalized();
  return rows;
}

bool RankMonitor::turned_over(const Eigen::MatrixXd& now) const {
  return (before_ * now.transpose()).determinant() < 0;
}

double RankMonitor::condition() {
  read_rows();
  const int generic = program_.derivation->reduction.ranks.m_locked;
  if (generic == 0) return 1;
  const Eigen::VectorXd sigma = singular_values(A_).sigma;
  return sigma(0) / sigma(generic - 1);
}

std::optional<std::string> RankMonitor::obstacle(double t, double share) {
  read_rows();
  if (A_.rows() == 0 || !A_.allFinite()) return std::nullopt;
  const int generic = program_.derivation->reduction.ranks.m_locked;
  const SingularValues svd = singular_values(A_.transpose());  // V: combinations of rows
  const Eigen::VectorXd& sigma = svd.sigma;
  int rank = 0;
  while (rank < generic && sigma(rank) > share * sigma(0)) ++rank;
  if (rank == generic) return std::nullopt;
  Eigen::VectorXd r_a_dot(B_.cols());
  for (Eigen::Index j = 0; j < r_a_dot.size(); ++j) r_a_dot(j) = run_.b.r_a_dot[static_cast<std::size_t>(j)];
  const Eigen::VectorXd asked = B_ * r_a_dot;
  double size = 0;  // of the terms, which may cancel
  for (Eigen::Index j = 0; j < r_a_dot.size(); ++j)
    size = std::max(size, B_.col(j).norm() * std::abs(r_a_dot(j)));
  Eigen::Index worst = rank;
  for (Eigen::Index c = rank; c < generic; ++c) {
    if (std::abs(svd.V.col(c).dot(asked)) > std::abs(svd.V.col(worst).dot(asked))) worst = c;
  }
  const Eigen::VectorXd u = svd.V.col(worst);
  if (!(std::abs(u.dot(asked)) > incompatible * size)) return std::nullopt;
  std::vector<std::string> rows, where;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const std::string& name = program_.model.rows[static_cast<std::size_t>(i)].name;
    if (std::abs(u(i)) > takes_part * u.cwiseAbs().maxCoeff())
      rows.push_back(name.empty() ? fmt::format("{}", i + 1) : name);
  }
  const Partition& p = program_.original;
  const auto place = [&](int velocity, double value) {
    where.push_back(fmt::format(
        "{} = {:.6g}", program_.model.coordinates[static_cast<std::size_t>(velocity - p.n)].name, value));
  };
  for (std::size_t i = 0; i < run_.b.r_p.size(); ++i)
    place(p.passive[static_cast<std::size_t>(p.n) + i], run_.b.r_p[i]);
  for (std::size_t i = 0; i < run_.b.r_a.size(); ++i) place(p.active[i], run_.b.r_a[i]);
  return fmt::format(
      "no finite motion goes through t = {:.6g} s, {}: the rank of (A, B_p) falls from {} to {} there, the "
      "rows {} depend on each other, and the imposed rates are not compatible with that",
      t, fmt::join(where, ", "), generic, rank, fmt::join(rows, ", "));
}

}  // namespace anholon
