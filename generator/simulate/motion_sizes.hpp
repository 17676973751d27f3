// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// How large the quantities of a motion ordinarily are: what a tolerance without unit refers to. Learnt from a
// coarse run ahead of the real one, which costs little beside it.

#include <span>
#include <vector>

#include "anholon/integrate/step_control.hpp"
#include "simulate/integrators.hpp"
#include "simulate/monitors.hpp"
#include "simulate/runner.hpp"

namespace anholon {

/// Largest magnitudes along a motion, none of them zero: a quantity that hardly moves gets a thousandth of
/// the largest of its kind (lengths, angles, reduced velocities), since its own digits are rounding; a kind
/// that vanishes gets 1.
struct MotionSizes {
  double angle = 1;                // turned by the reference body, at most 1 [rad]
  double length = 1;               // its displacement [m]
  std::vector<double> shape;       // r_p, then r_d
  std::vector<double> nu;          // reduced velocities
  std::vector<double> velocities;  // eta, r_p_dot, r_d_dot
  double energy = 1;               // the largest energy that takes part [J]

  /// Every size 1, for the motion of a program.
  MotionSizes(const SceneProgram& program, const Runner<double>& run);
  /// For y = (shape, nu, work, dissipated).
  [[nodiscard]] std::vector<double> of_state() const;
  /// For y = (shape, velocities), the state of RecursionDynamics.
  [[nodiscard]] std::vector<double> of_velocity_state() const;
};

/// Options of an integration to a tolerance relative to the sizes.
/// @param y  sizes of its y, which outlive the options
integrate::AdaptiveOptions<double> relative_tolerance(double tolerance, const MotionSizes& sizes,
                                                      std::span<const double> y);

/// Collects magnitudes along a coarse run.
class MotionSizesCollector {
 public:
  MotionSizesCollector(const SceneProgram& program, Runner<double>& run);
  /// After run.impose() and run.set() at the state.
  void observe(double turn, double displacement, double work, double dissipated);
  /// With the floors applied.
  [[nodiscard]] MotionSizes sizes() const;

 private:
  const SceneProgram& program_;
  Runner<double>& run_;
  MotionSizes seen_;
  EnergyMonitor energy_;
};

/// @return whether any size is so much smaller than the one that an integration was judged by that its error
/// may have been larger than the quantity itself
bool overestimated(const MotionSizes& used, const MotionSizes& seen);

/// How stiff the motion is, seen on the coarse run.
struct Stiffness {
  double fast = 0;   // radians that the fastest component turns or decays by: integral of the spectral radius
  double steps = 0;  // of the stiff method, at the coarse tolerance
};
constexpr double coarse_tolerance = 1e-3;

/// Largest magnitude of an eigenvalue, by Gelfand's formula: ||J^m||^(1/m), m = 256, is a few percent off.
double spectral_radius(const Eigen::MatrixXd& J);

/// Sizes along the motion from `initial`, whose y has the quadratures; all 1 where the coarse run fails. The
/// runner is left in the chart of `initial`. Where the program has a Jacobian, the run is one of the stiff
/// method, which no motion makes slow.
template <class G>
MotionSizes motion_sizes(const SceneProgram& program, Runner<double>& run, const integrate::State<G>& initial,
                         double t_end, Stiffness* stiffness = nullptr) {
  const auto method = run.field_jacobian ? Integrator::Method::rodas5p : Integrator::Method::dopri5;
  constexpr int most_passes = 6;  // each may find the motion smaller than the tolerance of the one before
  MotionSizes sizes(program, run);
  const std::size_t chart = run.chart();
  for (int pass = 0; pass < most_passes; ++pass) {
    MotionSizesCollector collector(program, run);
    const auto observe = [&](double t, const G& g, const auto& y) {
      run.impose(t), run.set(g, y);
      double turn = 0, displacement = 0;
      if constexpr (G::dim > G::linear_dim) {
        const auto theta = (initial.g.inverse() * g).log();
        turn = theta.template tail<G::dim - G::linear_dim>().norm();
      }
      if constexpr (G::linear_dim > 0) displacement = (g.p() - initial.g.p()).norm();
      collector.observe(turn, displacement, y(y.size() - 2), y(y.size() - 1));
    };
    integrate::State<G> state = initial;
    run.use_chart(chart);
    observe(0.0, state.g, state.y);
    const std::vector<double> y_sizes = sizes.of_state();
    auto options = relative_tolerance(coarse_tolerance, sizes, y_sizes);
    options.max_step = (t_end - initial.t) / 20;  // so that the run sees the motion
    options.max_steps = 100'000;
    Stiffness seen_stiffness;
    const auto outcome = integrate_adaptive<G>(
        field_with_corrections<G>(run.template charted_field<G>()), state, t_end, options,
        [&](const AnyStep<G>& step) {
          observe(step.t_end(), step.g_end(), step.y_end());
          ++seen_stiffness.steps;
          if (stiffness != nullptr && step.jacobian() != nullptr)
            seen_stiffness.fast += (step.t_end() - step.t_begin()) * spectral_radius(*step.jacobian());
        },
        method);
    if (stiffness != nullptr) *stiffness = seen_stiffness;
    run.use_chart(chart);
    if (!outcome) return {program, run};
    const MotionSizes seen = collector.sizes();
    const bool again = overestimated(sizes, seen);
    sizes = seen;
    if (!again) break;
  }
  return sizes;
}

}  // namespace anholon
