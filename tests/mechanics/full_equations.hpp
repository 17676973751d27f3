// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The equations of motion with multipliers in all coordinates, from the positions of masses and the
// velocities of contact points, solved in long double; and the comparison of a derived program with them.

#include <Eigen/Core>
#include <set>

#include "mechanics/witness.hpp"

namespace anholon::test {

/// (direction . velocity of the point) + (about . angular velocity of the frame) - roll_dot = 0; all in the
/// world.
struct Contact {
  Vector direction, point;
  Jet roll = {};
  Vector about = {};
  Pose frame = {};
};

struct Robot {
  Witness witness;  // its description is left empty
  std::function<std::vector<Contact>(const Pose& g, const std::vector<Jet>& r, const Jet& t)> contacts;
};

using Dense = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Column = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// M v_dot = force + G^T lambda + actuation,   G v_dot = -bias.
struct Equations {
  Dense M, G;
  Column force, bias;
};

Equations equations(const Robot& robot, GroupKind group, const Sample& sample);

struct Motion {
  Column acceleration, multipliers;  // of least norm
};

/// The saddle-point system of the given unknowns, solved as one; where rows are redundant, the solution of
/// least norm.
Motion solve_saddle(const Dense& M, const Column& force, const Dense& A, const Column& bias);

Dense kernel_of(const Dense& A);

/// Largest over smallest singular value that does not vanish.
Real condition_of(const Dense& A);

inline std::vector<Real> list(const Column& x) { return {x.data(), x.data() + x.size()}; }

inline Column picked(const Column& x, const std::vector<int>& at) {
  Column r(static_cast<Eigen::Index>(at.size()));
  for (std::size_t i = 0; i < at.size(); ++i) r(static_cast<Eigen::Index>(i)) = x(at[i]);
  return r;
}
inline Dense picked(const Dense& x, const std::vector<int>& rows, const std::vector<int>& cols) {
  Dense r(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(cols.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < cols.size(); ++j)
      r(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = x(rows[i], cols[j]);
  }
  return r;
}

/// Gives the sample a position in the working range and an admissible velocity, the projection of a random
/// one.
/// @return an admissible acceleration of all coordinates
Column admissible_motion(const Robot& robot, const Model& model, Sample& sample, std::mt19937_64& rng);

/// Near a loss of rank the tolerance grows with the condition number: the error is divided by it instead.
template <class Have>
void add_scaled(BlockErrors& errors, const std::string& block, const Column& want, const Have& have,
                Real condition) {
  std::vector<Real> shrunk = list(want);
  ASSERT_EQ(shrunk.size(), have.size()) << block;
  for (std::size_t i = 0; i < shrunk.size(); ++i)
    shrunk[i] += (static_cast<Real>(have[i]) - shrunk[i]) / condition;
  errors.add(block, list(want), shrunk);
}

/// Accelerations, torques and multipliers of the derived program, at 100 admissible states, against the full
/// equations: with r_a(t) given and with the torques given.
/// @param several_charts  the kernel has no basis that is regular everywhere (the rows name a direction of
/// the world). With torques given, the program stays in one chart and may lose the square of the condition
/// number of its basis, as M_r = H^T M H does
void expect_reduced_motion_of(const Model& model, const Robot& robot, bool several_charts = false);

/// Likewise with some of the active coordinates driven by torque and the others by motion.
void expect_hybrid_motion_of(const Model& model, const Robot& robot, const std::set<std::string>& driven);

}  // namespace anholon::test
