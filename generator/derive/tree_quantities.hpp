// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the functions of a tree compute, as output blocks on a program's tape, in frames that the caller
// chooses.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "anholon/composite.hpp"
#include "derive/tree_inputs.hpp"
#include "describe/model.hpp"
#include "tape/interface.hpp"

namespace anholon {

/// A way to derive a function in given frames; where it does not apply there are no outputs.
struct TreeRoute {
  std::string name;
  std::function<std::vector<OutputBlock>(const Mechanism<Expr>&)> outputs;
  bool depends_on_frames = true;  // else it is that of the described frames, whatever is given
};

class TreeQuantities {
 public:
  /// Makes the inputs on the tape of the program and lists them there.
  /// @throws UnsupportedError where the model has constraints, external wrenches or compliant bodies
  TreeQuantities(const Model& model, Program& program);

  [[nodiscard]] const TreeInputs& inputs() const { return in_; }
  /// Every link a body.
  [[nodiscard]] const Mechanism<Expr>& described() const { return described_; }
  /// Without fixed joints, in the described frames.
  [[nodiscard]] const Mechanism<Expr>& merged() const { return merged_; }
  [[nodiscard]] int merged_bodies() const { return merged_bodies_; }

  /// All ways to derive a function of tree_function_names(), or regressor_motion.
  [[nodiscard]] std::vector<TreeRoute> routes(const std::string& function);
  [[nodiscard]] std::string meaning(const std::string& function) const;
  /// Output blocks of the functions that may be loops.
  std::vector<OutputBlock> blocks_of(const std::string& function,
                                     const std::vector<std::vector<Expr>>& values);

 private:
  OutputBlock block(std::string name, std::string unit, std::string meaning, const std::vector<Expr>& v);
  OutputBlock block(std::string name, std::string unit, std::string meaning, const Matrix<Expr>& m);

  [[nodiscard]] bool has_armatures() const;
  [[nodiscard]] bool independent(const Mechanism<Expr>& m) const;
  [[nodiscard]] bool factor_may_pay(const Mechanism<Expr>& m) const;
  [[nodiscard]] int n() const { return static_cast<int>(free_components(model_.group).size()); }
  [[nodiscard]] std::vector<Expr> zeros() const { return std::vector<Expr>(in_.r.size(), Expr(0)); }
  [[nodiscard]] std::vector<Expr> free_part(const Spatial<Expr>& x) const;

  std::vector<Expr> own_forces(const Mechanism<Expr>& m, const Spatial<Expr>& eta,
                               const std::vector<Expr>& r_dot) const;
  std::pair<Spatial<Expr>, std::vector<Expr>> sweep(const Mechanism<Expr>& m, const Spatial<Expr>& eta,
                                                    const Vec3<Expr>& wd, const Vec3<Expr>& a,
                                                    const std::vector<Expr>& r_dot,
                                                    const std::vector<Expr>& r_ddot, bool own) const;
  [[nodiscard]] Matrix<Expr> mass_matrix(const Mechanism<Expr>& m) const;
  [[nodiscard]] RigidTree<Expr> moving_tree() const;

  std::vector<OutputBlock> inverse_dynamics(const Mechanism<Expr>& m, const Spatial<Expr>& eta,
                                            const Spatial<Expr>& eta_dot, const std::vector<Expr>& r_dot,
                                            const std::vector<Expr>& r_ddot, bool own);
  std::vector<OutputBlock> forward_dynamics(const Mechanism<Expr>& m, bool articulated_bodies);
  std::vector<OutputBlock> imposed_motion(const Mechanism<Expr>& m);
  std::vector<OutputBlock> inverse_mass_matrix(const Mechanism<Expr>& m);
  std::vector<OutputBlock> forward_kinematics();
  std::vector<OutputBlock> jacobians();
  std::vector<OutputBlock> regressors();
  std::vector<OutputBlock> regressor_motions();

  const Model& model_;
  Tape& tape_;
  TreeInputs in_;
  Mechanism<Expr> described_, merged_;
  int merged_bodies_ = 0;
};

}  // namespace anholon
