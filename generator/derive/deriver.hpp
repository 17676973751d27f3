// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// One derivation at work: what all functions of a program share, and how each of them is derived. One file
// holds one kind of function.

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anholon/free_dynamics.hpp"
#include "derive/charts.hpp"
#include "derive/derive.hpp"
#include "derive/sampled_inputs.hpp"
#include "derive/symbols.hpp"
#include "describe/mechanise.hpp"
#include "optimise/accuracy/variants.hpp"
#include "optimise/model/merge_fixed.hpp"
#include "reduce/symmetric_factors.hpp"

namespace anholon {

/// One route to a function: its outputs on the tape.
struct Route {
  std::string name;
  std::vector<OutputBlock> outputs;
};

/// The nodes of all outputs, block by block.
std::vector<NodeId> roots_of(const Route& r);

/// 0, 1, ..., n - 1.
std::vector<int> range(int n);

/// A partition of the velocities with its kinematic reduction, in the chart that is derived at the moment.
struct Reduced {
  Partition partition;
  RankAnalysis ranks;
  KernelAtlas atlas;
  KinematicReduction* reduction = nullptr;
  [[nodiscard]] int k() const { return reduction->k(); }
};

class Deriver {
 public:
  Deriver(const Model& model, const DeriveRequest& request);
  std::unique_ptr<Derivation> run();

 private:
  /// Reduced mass matrix, forces and drift of one partition.
  struct ReducedDynamics {
    std::vector<Expr> velocity;           // n + s
    std::vector<Expr> bias_acceleration;  // n + s: at nu_dot = 0
    Matrix<Expr> M_r;
    std::vector<Expr> f_r;
  };
  /// A column of the kernel with a single entry, 1 at `row`.
  struct UnitColumn {
    int row, column;
  };
  struct Traced {
    std::string function;
    std::vector<Candidate> candidates;
    std::size_t best;
    std::size_t first_report;  // of the candidates
    const KernelAtlas* atlas;
    std::size_t chart;
  };

  static Mechanism<Expr> merged(Mechanism<Expr> mechanism) {
    merge_fixed(mechanism);
    return mechanism;
  }
  [[nodiscard]] bool wanted(const std::string& name) const {
    return request_.functions.empty() ||
           std::ranges::find(request_.functions, name) != request_.functions.end();
  }
  /// Of what is derived on demand only.
  [[nodiscard]] bool wants_state_jacobian() const {
    return request_.state_jacobian ||
           std::ranges::find(request_.functions, "state_jacobian") != request_.functions.end();
  }
  /// Puts passive and active entries into declared order (n + s).
  static std::vector<Expr> merged(const Partition& p, const std::vector<Expr>& passive,
                                  const std::vector<Expr>& active) {
    std::vector<Expr> v(p.passive.size() + p.active.size(), Expr(0));
    for (std::size_t i = 0; i < p.passive.size(); ++i) v[static_cast<std::size_t>(p.passive[i])] = passive[i];
    for (std::size_t i = 0; i < p.active.size(); ++i) v[static_cast<std::size_t>(p.active[i])] = active[i];
    return v;
  }
  static std::vector<Expr> picked(const std::vector<Expr>& v, const std::vector<int>& indices) {
    std::vector<Expr> r;
    for (const int i : indices) r.push_back(v[static_cast<std::size_t>(i)]);
    return r;
  }
  std::vector<Expr> full_velocity() { return merged(motion_partition_, full_passive(), r_a_dot_); }
  static std::vector<Expr> column_of(const Matrix<Expr>& m, int column) {
    std::vector<Expr> entries;
    for (int i = 0; i < m.rows(); ++i) entries.push_back(m(i, column));
    return entries;
  }
  std::vector<Expr> no_force(const Partition& p) const {
    return std::vector<Expr>(p.passive.size(), Expr(0));
  }

  // derive.cpp: the order of things, and the reduction of each chart
  Reduced reduce(const Partition& partition);
  [[nodiscard]] ReductionReport report(const Reduced& of) const;
  [[nodiscard]] static std::string meaning_of_nu(const Reduced& of);
  /// The functions that know nu, once more for every further chart, and how good each chart is.
  void derive_further_charts();
  void emit_quality(const KernelAtlas& atlas, const std::string& name, const std::string& nu,
                    const std::string& to, const std::string& from);
  void note_header();

  // candidates.cpp: routes to a function, and the one that is kept
  OutputBlock block(std::string name, std::string unit, std::string meaning, const Matrix<Expr>& m);
  OutputBlock block(std::string name, std::string unit, std::string meaning, const std::vector<Expr>& v);
  /// Keeps the route that choose() takes; the closed form of the cheapest one is a further candidate.
  /// @param simplified  let the closed form compete: it expands products, and with them loses digits again
  /// @param accurate  further routes, which are derived only where those lose digits
  void emit(const std::string& name, const std::string& meaning, std::vector<Route> routes,
            const std::string& remark = "", bool simplified = true,
            const std::function<std::vector<Route>()>& accurate = {});
  void add_stable_forms(std::vector<Candidate>& candidates);
  void add_after_passes(std::vector<Candidate>& candidates);
  /// Random states; where there are several charts, those at which this one is the best.
  std::vector<std::vector<double>> states_of(const KernelAtlas* atlas, std::size_t chart, int count);
  /// What all candidates lose, and what stable forms and each pass make of the route that was kept.
  void trace();

  // kinematic_functions.cpp
  /// eta, r_p and (torque-driven) r_a parts of the passive entries, as output blocks.
  std::vector<OutputBlock> split_passive(const Partition& p, const std::vector<Expr>& passive,
                                         const std::string& order);
  void derive_kinematics();
  std::vector<Expr> eta_input();
  std::vector<Expr> r_p_dot_input();
  /// eta and all passive rates as inputs, in the order of the motion partition.
  std::vector<Expr> full_passive();
  void derive_constraints();
  void derive_compatibility();
  void derive_position_conditions();
  void derive_poses();

  // dynamic_functions.cpp
  void derive_free_dynamics();
  /// @param H  basis of the kernel that M_r and f_r are projected on
  /// @param input_force  (passive) given forces on passive velocities, e.g. torques
  /// @param project  run the recursion on admissible motions; else form (66)-(68) from all blocks
  ReducedDynamics reduced_dynamics(const Reduced& of, const Matrix<Expr>& H, const std::vector<Expr>& nu,
                                   const std::vector<Expr>& r_a_dot, const std::vector<Expr>& r_a_ddot,
                                   const std::vector<Expr>& input_force, bool project);
  /// nu_dot, then all accelerations (n + s), from M_r and f_r on the kernel's own basis.
  std::pair<std::vector<Expr>, std::vector<Expr>> solved(const Reduced& of, const ReducedDynamics& d);
  /// What `solved` found, as blocks: the derivative of nu, then eta_dot, r_p_ddot and so on.
  std::vector<OutputBlock> acceleration_blocks(
      const Reduced& of, const std::string& nu,
      const std::pair<std::vector<Expr>, std::vector<Expr>>& solution);
  /// Forces on the passive velocities that an acceleration of these alone needs.
  std::vector<Expr> mass_times(const Partition& p, const State<Expr>& state,
                               const std::vector<Expr>& passive);
  /// Torques on the coordinates of a partition that are torque-driven, as forces on its passive velocities.
  std::vector<Expr> driving_force(const Partition& p);
  static std::vector<Expr> accelerations(const Reduced& of, const Matrix<Expr>& H, const ReducedDynamics& d,
                                         const std::vector<Expr>& nu_dot);
  void derive_reduced_dynamics();
  /// Where every route through the mass matrix loses most of its digits at the default parameters, and
  /// articulated bodies do not, they are the only route left.
  bool replace_by_articulated_bodies(const std::vector<Expr>& force, std::vector<Route>& routes);
  /// (4)-(5), where H is block triangular with both an external and an internal part.
  std::vector<OutputBlock> split_blocks(const ReducedDynamics& d);
  void derive_energies();

  // accurate_routes.cpp
  /// What `solved` finds, on an orthogonal basis: keeps digits where the kernel's own is almost singular.
  std::pair<std::vector<Expr>, std::vector<Expr>> solved_on_orthogonal_basis(
      const Reduced& of, const std::vector<Expr>& nu, const std::vector<Expr>& r_a_dot,
      const std::vector<Expr>& r_a_ddot, const std::vector<Expr>& input_force, bool project);
  /// The same with the modes eliminated body by body: what is left of a beam's inertia when its modes give
  /// way is a small difference, and so it comes about in the beam's own axes, before it is carried to others.
  std::pair<std::vector<Expr>, std::vector<Expr>> solved_modes_first(const Reduced& of,
                                                                     const std::vector<Expr>& nu,
                                                                     const std::vector<Expr>& r_a_dot,
                                                                     const std::vector<Expr>& r_a_ddot,
                                                                     const std::vector<Expr>& input_force);
  /// The same from the equations of motion with multipliers, in which no basis of the kernel has a part but
  /// for the velocities.
  /// @return nothing where rows are redundant, velocities have no inertia or nu names no velocities
  std::optional<std::pair<std::vector<Expr>, std::vector<Expr>>> solved_with_multipliers(
      const Reduced& of, const std::vector<Expr>& nu, const std::vector<Expr>& r_a_dot,
      const std::vector<Expr>& r_a_ddot, const std::vector<Expr>& input_force);
  /// Whether factors of a mass matrix M divide by nothing that is zero.
  bool have_inertia(const Matrix<Expr>& M, const SymmetricFactors& factors);
  /// Columns of the kernel that are the rate of one mode, which is in no other.
  [[nodiscard]] std::vector<UnitColumn> modal_columns(const Reduced& of) const;
  /// All of these that may differ from `solved`.
  std::vector<Route> accurate_routes(const Reduced& of, const std::string& name, const std::vector<Expr>& nu,
                                     const std::vector<Expr>& r_a_dot, const std::vector<Expr>& r_a_ddot,
                                     const std::vector<Expr>& input_force);

  // torque_functions.cpp
  void derive_torques_and_multipliers();
  /// Eq. (9): every active joint by torque, in charts of its own.
  void derive_torque_driven();
  void derive_torque_driven(const Reduced& all, const std::vector<Expr>& w,
                            const std::vector<std::string>& family);

  // linearised_functions.cpp
  /// Inputs that only this function has, and the directions of the state.
  void prepare_state_jacobian();
  /// The derivative of M_r(x) a = f_r(x) at a fixed, solved for that of a: one inverse dynamics is
  /// differentiated, and M_r is factored once for all directions.
  Matrix<Expr> differentiated_accelerations(bool project);
  void derive_state_jacobian();

  const Model& model_;
  const DeriveRequest& request_;
  std::unique_ptr<Derivation> result_;
  Program& program_;
  Tape& tape_;
  Partition motion_partition_;
  ProgramSymbols symbols_;
  MechanismDescription description_;
  Mechanism<Expr> described_;  // every body as the model has it
  Mechanism<Expr> mechanism_;  // bodies on fixed and locked joints merged
  FreeDynamics<Expr> dynamics_;
  std::vector<SampleState> samples_;
  std::vector<std::string> names_;
  std::vector<Exact> defaults_;
  Reduced motion_, torque_driven_;
  std::string prefix_;                  // of the names of functions: the chart
  const KernelAtlas* atlas_ = nullptr;  // that chart_ belongs to; null before there is one
  std::size_t chart_ = 0;
  std::vector<NodeId> parameter_nodes_;
  SampledInputs sampled_inputs_;
  std::vector<Traced> traced_;
  std::vector<Expr> nu_, r_a_dot_, r_a_ddot_;
};

}  // namespace anholon
