// SPDX-License-Identifier: MIT
//
// Adaptive integration on a Lie group: Munthe-Kaas form (rkmk.hpp) of Dormand-Prince 5(4), with step control
// by a proportional-integral law (step_control.hpp) and continuous output (dense.hpp). Hairer, Norsett &
// Wanner 1993, "Solving Ordinary Differential Equations I", II.4 (error, first step, control), and their code
// DOPRI5, whose constants are kept.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "anholon/integrate/dense.hpp"
#include "anholon/integrate/result.hpp"
#include "anholon/integrate/rkmk.hpp"
#include "anholon/integrate/step_control.hpp"
#include "anholon/integrate/tableau.hpp"

namespace anholon::integrate {

template <class G>
using DormandPrince = RkmkStages<G, DormandPrince54>;

namespace detail {

/// Size of the first step, from the field at the start and after a small Euler step (Hairer et al. 1993,
/// II.4).
/// @return [s], > 0
template <class G, class Field>
typename G::Scalar first_step(DormandPrince<G>& stages, Field&& field, const ErrorScale<G>& scale,
                              typename G::Scalar direction,
                              const AdaptiveOptions<typename G::Scalar>& options) {
  using Real = typename G::Scalar;
  using std::pow;
  const auto& y = stages.y_begin();
  const Real d_0 =
      larger(G::dim > 0 ? Real(1) / (options.atol + options.rtol) : Real(0),  // a pose has size 1
             scale(G::Tangent::Zero(), y, y, y));
  const Real d_1 = scale(stages.theta_rate(0), stages.y_rate(0), y, y);
  Real h_0 = d_0 < Real(1e-5L) || d_1 < Real(1e-5L) ? Real(1e-6L) : Real(0.01L) * d_0 / d_1;
  h_0 = std::min(h_0, options.max_step);
  stages.probe(field, direction * h_0);
  auto& y_change = stages.scratch_y();
  y_change = stages.y_rate(1) - stages.y_rate(0);
  const typename G::Tangent theta_change = stages.theta_rate(1) - stages.theta_rate(0);
  const Real d_2 = scale(theta_change, y_change, y, y);
  if (!std::isfinite(d_2)) return h_0;
  const Real steepest = std::max(d_1, d_2 / h_0);
  const Real h_1 = steepest <= Real(1e-15L) ? std::max(Real(1e-6L), h_0 * Real(1e-3L))
                                            : pow(Real(0.01L) / steepest, Real(1) / 5);
  return std::min({100 * h_0, h_1, options.max_step});
}

/// What step control has to know of Dormand-Prince.
template <class G>
struct DormandPrinceControl {
  using Real = typename G::Scalar;
  static constexpr Real beta = Real(0.04L);                       // weight of the integral part
  static constexpr Real alpha = Real(0.2L) - Real(0.75L) * beta;  // the error of a step goes with h^5
  static constexpr Real largest_factor = Real(10);
  static constexpr int evaluations_per_attempt = DormandPrince<G>::evaluations_per_step;
  static constexpr int evaluations_per_commit = 0;

  template <class Field>
  static Real first_step(DormandPrince<G>& stages, Field&& field, const ErrorScale<G>& scale, Real direction,
                         const AdaptiveOptions<Real>& options, Result<Real>& result) {
    ++result.evaluations;
    return detail::first_step<G>(stages, field, scale, direction, options);
  }

  static Real error(DormandPrince<G>& stages, const ErrorScale<G>& scale) {
    using std::abs;
    using Tableau = DormandPrince54<Real>;
    typename G::Tangent theta_error = G::Tangent::Zero();
    auto& y_error = stages.scratch_y();
    y_error.setZero();
    for (int i = 0; i < Tableau::stages; ++i) {
      theta_error += Tableau::error[i] * stages.theta_rate(i);
      y_error += Tableau::error[i] * stages.y_rate(i);
    }
    return abs(stages.h()) * scale(theta_error, y_error, stages.y_begin(), stages.y_end());
  }

  static DenseStep<G> step(const DormandPrince<G>& stages, Real t_end) { return {stages, t_end}; }
};

}  // namespace detail

/// Integrates from state.t to t_end (which may lie before it) within the tolerances of `options`.
///
/// @param stages    workspace; its size_y() must be state.y.size()
/// @param field     see rkmk.hpp
/// @param state     in: initial; out: at the last accepted step
/// @param observer  called after each accepted step as observer(const DenseStep<G>&)
template <class G, class Field, class Observer>
Result<typename G::Scalar> integrate_adaptive(DormandPrince<G>& stages, Field&& field, State<G>& state,
                                              typename G::Scalar t_end,
                                              const AdaptiveOptions<typename G::Scalar>& options,
                                              Observer&& observer) {
  return detail::control_steps<detail::DormandPrinceControl<G>>(stages, field, state, t_end, options,
                                                                observer);
}

/// The same without an observer.
template <class G, class Field>
Result<typename G::Scalar> integrate_adaptive(DormandPrince<G>& stages, Field&& field, State<G>& state,
                                              typename G::Scalar t_end,
                                              const AdaptiveOptions<typename G::Scalar>& options) {
  return integrate_adaptive(stages, field, state, t_end, options, [](const DenseStep<G>&) {});
}

/// Integrates to the last of the requested times and reports the state at each of them, by dense output: the
/// steps are those of the tolerance, whatever the times.
///
/// @param times     (any number) in the order in which they are passed; the first not before state.t
/// @param observer  called once for each time reached, as observer(Real t, const G& g, const Vector& y)
template <class G, class Field, class Observer>
Result<typename G::Scalar> integrate_adaptive_at(DormandPrince<G>& stages, Field&& field, State<G>& state,
                                                 std::span<const typename G::Scalar> times,
                                                 const AdaptiveOptions<typename G::Scalar>& options,
                                                 Observer&& observer) {
  using Real = typename G::Scalar;
  if (times.empty()) return {};
  const Real direction = times.back() < state.t ? Real(-1) : Real(1);
  std::size_t next = 0;
  for (; next < times.size() && times[next] == state.t; ++next) observer(state.t, state.g, state.y);
  return integrate_adaptive(stages, field, state, times.back(), options, [&](const DenseStep<G>& step) {
    for (; next < times.size() && direction * times[next] <= direction * step.t_end(); ++next) {
      G g;
      auto& y = stages.scratch_y();
      step.evaluate(times[next], g, y);
      observer(times[next], std::as_const(g), std::as_const(y));
    }
  });
}

}  // namespace anholon::integrate
