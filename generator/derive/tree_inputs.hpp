// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Inputs of the functions of a tree, made on a program's tape once for all of them.

#include <string>
#include <vector>

#include "anholon/mechanism.hpp"
#include "describe/model.hpp"
#include "tape/interface.hpp"

namespace anholon {

struct TreeInputs {
  std::vector<Expr> parameters;
  Mat3<Expr> R = Mat3<Expr>::identity();
  Vec3<Expr> p;
  Spatial<Expr> eta, eta_dot;
  std::vector<Expr> r, r_dot, r_ddot, tau;

  /// Makes the inputs and lists them in the program.
  TreeInputs(const Model& model, Program& program);
  /// Pose, shape and velocities.
  [[nodiscard]] State<Expr> state() const;
};

}  // namespace anholon
