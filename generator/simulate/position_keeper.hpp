// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Conditions on the position are kept by Newton's method at the ends of steps: the shortest way back in the
// passive velocities. No constants to tune, and nothing is added to the equations of motion.

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include "reduce/decompositions.hpp"
#include "simulate/runner.hpp"

namespace anholon {

template <class G>
class PositionKeeper {
 public:
  using Real = typename G::Scalar;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  PositionKeeper(const SceneProgram& program, Runner<Real>& run) : program_(program), run_(run) {
    const auto count = static_cast<Eigen::Index>(program.model.positions.size());
    kept_.setZero(count), residual_.setZero(count);
    slopes_.setZero(count, static_cast<Eigen::Index>(program.reduced.passive.size()));
  }

  /// Whether there is anything to keep.
  [[nodiscard]] bool empty() const { return kept_.size() == 0; }

  /// Conditions that hold from the start take their values from this position.
  void start(Real t, const G& g, const Vector& y) {
    kept_.setZero();
    measure(t, g, y);
    for (Eigen::Index i = 0; i < kept_.size(); ++i) {
      if (program_.model.positions[static_cast<std::size_t>(i)].from_start) kept_(i) = residual_(i);
    }
  }

  /// Largest residual at a position, m or 1.
  Real residual(Real t, const G& g, const Vector& y) {
    measure(t, g, y);
    return empty() ? Real(0) : residual_.cwiseAbs().maxCoeff();
  }

  /// Moves the position to where the conditions hold, if it has left them by more than rounding.
  /// @return whether it moved
  bool operator()(Real t, G& g, Vector& y) {
    bool moved = false;
    Real before = std::numeric_limits<Real>::infinity();
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
      const Real now = residual(t, g, y);
      // Near rounding the residual no longer falls; far off, Newton's method may rise once before it falls.
      if (!(now > worth_moving) || !std::isfinite(now) || (iteration > 2 && now >= before)) break;
      before = now;
      const Vector step = ConstraintFactors<Real>(slopes_, rank_threshold).solve(Vector(-residual_));
      typename G::Tangent twist = G::Tangent::Zero();
      const int n = program_.reduced.n;
      for (int i = 0; i < n; ++i) twist(i) = step(i);
      g = g * G::exp(twist);
      for (Eigen::Index i = n; i < step.size(); ++i) y(i - n) += step(i);
      moved = true;
    }
    return moved;
  }

 private:
  static constexpr int most_iterations = 20;
  static constexpr Real rank_threshold =
      Real(1e-10L);  // between rounding and the slopes of regular configurations
  static constexpr Real worth_moving = 200 * std::numeric_limits<Real>::epsilon();  // 4e-14 m in double

  void measure(Real t, const G& g, const Vector& y) {
    if (empty()) return;
    run_.impose(t);
    run_.set(g, y);
    run_.position_conditions();
    const std::size_t columns = run_.b.Phi_q.size() / run_.b.Phi.size();
    for (Eigen::Index i = 0; i < kept_.size(); ++i) {
      const auto row = static_cast<std::size_t>(i);
      residual_(i) = run_.b.Phi[row] - kept_(i);
      for (Eigen::Index j = 0; j < slopes_.cols(); ++j) {
        const auto velocity = static_cast<std::size_t>(program_.reduced.passive[static_cast<std::size_t>(j)]);
        slopes_(i, j) = run_.b.Phi_q[row * columns + velocity];
      }
    }
  }

  const SceneProgram& program_;
  Runner<Real>& run_;
  Vector kept_, residual_;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> slopes_;
};

}  // namespace anholon
