// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Imposed motion r_a(t) from the table of a scene.

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <vector>

#include "anholon/motion.hpp"
#include "describe/specialise.hpp"
#include "simulate/buffers.hpp"
#include "simulate/scene_program.hpp"

namespace anholon {

template <class S>
class TableMotion {
 public:
  TableMotion(const Scene& scene, const SceneProgram& program) {
    const MotionTable& table = *scene.motion_table;
    const auto rows = static_cast<Eigen::Index>(table.times.size());
    Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> values(
        rows, static_cast<Eigen::Index>(program.reduced.active.size()));
    std::vector<S> times;
    values.setZero();
    const std::vector<int> kept = kept_coordinates(scene.model, scene);
    for (const double t : table.times) times.push_back(S(t));
    for (std::size_t c = 0; c < table.coordinates.size(); ++c) {
      const int index = kept[static_cast<std::size_t>(table.coordinates[c])] + program.original.n;
      const auto column = std::ranges::find(program.reduced.active, index) - program.reduced.active.begin();
      for (Eigen::Index i = 0; i < rows; ++i)
        values(i, column) = S(table.rows[static_cast<std::size_t>(i)][c]);
    }
    using Ends = MotionTable::Ends;
    const decltype(values) at_rest = decltype(values)::Zero(2, values.cols());  // slopes of clamped ends
    spline_.emplace(times, values,
                    table.ends == Ends::periodic  ? SplineEnds::periodic
                    : table.ends == Ends::clamped ? SplineEnds::clamped
                                                  : SplineEnds::natural,
                    at_rest);
    r_.setZero(values.cols()), r_dot_.setZero(values.cols()), r_ddot_.setZero(values.cols());
  }
  void operator()(S t, Buffers<S>& b) {
    spline_->evaluate(t, r_, r_dot_, r_ddot_);
    for (Eigen::Index i = 0; i < r_.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      b.r_m[at] = r_(i), b.r_m_dot[at] = r_dot_(i), b.r_m_ddot[at] = r_ddot_(i);
    }
  }

 private:
  std::optional<TabulatedMotion<S>> spline_;
  Eigen::Matrix<S, Eigen::Dynamic, 1> r_, r_dot_, r_ddot_;
};

}  // namespace anholon
