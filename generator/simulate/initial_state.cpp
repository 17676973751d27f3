// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/initial_state.hpp"

#include <fmt/format.h>

#include "describe/location.hpp"
#include "simulate/numeric_reduction.hpp"

namespace anholon {

DynamicVector<double> completion(const Scene& scene, const SceneProgram& program,
                                 const DynamicMatrix<double>& A, const DynamicVector<double>& missing,
                                 const DynamicVector<double>& given, const std::vector<char>& named) {
  constexpr double allowed = 1e-9;  // relative: digits that a user may have rounded off
  DynamicMatrix<double> open = A;
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    if (named[static_cast<std::size_t>(j)] != 0) open.col(j).setZero();
  }
  const DynamicVector<double> step = least_norm(open, missing);
  Eigen::Index row = 0;
  const double residual = (open * step - missing).cwiseAbs().maxCoeff(&row);
  if (residual > allowed * std::max(1.0, given.cwiseAbs().maxCoeff())) {
    throw ModelError(
        scene.initial_where,
        fmt::format("the initial velocities violate constraint '{}' by {:.2g}",
                    program.model.rows[static_cast<std::size_t>(row)].name, residual),
        "leave velocities out that the constraints determine, or make the motion compatible at t = 0");
  }
  return step;
}

}  // namespace anholon
