// SPDX-License-Identifier: MIT
//
// Adaptive integration on a Lie group: embedded pairs in Munthe-Kaas form (rkmk.hpp) with step control and
// continuous output (dense.hpp). Hairer, Norsett & Wanner 1993, "Solving Ordinary Differential Equations I",
// II.4 (error, first step, control), and their codes DOPRI5 and DOP853, whose constants are kept. The pairs:
// dopri.hpp, dop853.hpp.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <type_traits>
#include <utility>

#include "anholon/integrate/dense.hpp"
#include "anholon/integrate/result.hpp"
#include "anholon/integrate/rkmk.hpp"
#include "anholon/integrate/step_control.hpp"

namespace anholon::integrate {

/// Stages whose tableau estimates its error and has a continuous solution.
template <class Stages>
concept AdaptiveStages = requires {
  Stages::Tableau::error;
};

namespace detail {

/// Size of the first step, from the field at the start and after a small Euler step (Hairer et al. 1993,
/// II.4).
/// @return [s], > 0
template <class Stages, class Field>
typename Stages::Real first_step(Stages& stages, Field&& field,
                                 const ErrorScale<typename Stages::Group>& scale,
                                 typename Stages::Real direction,
                                 const AdaptiveOptions<typename Stages::Real>& options) {
  using Real = typename Stages::Real;
  using G = typename Stages::Group;
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
                                            : pow(Real(0.01L) / steepest, Real(1) / Stages::Tableau::order);
  return std::min({100 * h_0, h_1, options.max_step});
}

/// Error of a step of length h, from two sums of its rates where the tableau has them: the estimate of order
/// 5 decides, and that of order 3 keeps it from vanishing by chance (Hairer et al. 1993, II.5, eq. (5.27)).
/// Alone the former would err by h^6; together they behave as h^8.
template <class Stages>
typename Stages::Real step_error(Stages& stages, const ErrorScale<typename Stages::Group>& scale) {
  using Real = typename Stages::Real;
  using Tableau = typename Stages::Tableau;
  using std::abs;
  using std::sqrt;
  const auto scaled = [&](const std::array<Real, Tableau::stages>& weights) {
    typename Stages::Tangent theta = Stages::Tangent::Zero();
    auto& y = stages.scratch_y();
    y.setZero();
    for (int i = 0; i < Tableau::stages; ++i) {
      if (weights[i] == Real(0)) continue;
      theta += weights[i] * stages.theta_rate(i);
      y += weights[i] * stages.y_rate(i);
    }
    return scale(theta, y, stages.y_begin(), stages.y_end());
  };
  const Real error = scaled(Tableau::error);
  if constexpr (requires { Tableau::error_of_order_3; }) {
    if (error == Real(0)) return error;
    const Real ratio = scaled(Tableau::error_of_order_3) / error;  // not the squares: they may overflow
    return abs(stages.h()) * error / sqrt(Real(1) + ratio * ratio / 100);
  } else {
    return abs(stages.h()) * error;
  }
}

/// What step control has to know of an embedded pair.
template <class Stages>
struct PairControl {
  using Real = typename Stages::Real;
  using Scale = ErrorScale<typename Stages::Group>;
  using Tableau = typename Stages::Tableau;
  static constexpr Real beta = Tableau::integral_weight;
  static constexpr Real alpha = Real(1) / Tableau::order - Real(0.75L) * beta;  // the error goes with h^order
  static constexpr Real largest_factor = Tableau::largest_factor;
  static constexpr int evaluations_per_attempt = Stages::evaluations_per_step;
  static constexpr int evaluations_per_commit = 0;

  template <class Field>
  static Real first_step(Stages& stages, Field&& field, const Scale& scale, Real direction,
                         const AdaptiveOptions<Real>& options, Result<Real>& result) {
    ++result.evaluations;
    return detail::first_step(stages, field, scale, direction, options);
  }
  static Real error(Stages& stages, const Scale& scale) { return step_error(stages, scale); }
  static Real step(const Stages&, Real t_end) { return t_end; }
};

}  // namespace detail

/// Integrates from state.t to t_end (which may lie before it) within the tolerances of `options`.
///
/// @param stages    workspace; its size_y() must be state.y.size()
/// @param field     see rkmk.hpp
/// @param state     in: initial; out: at the last accepted step
/// @param observer  called after each accepted step as observer(const DenseStepOf<...>&), dense.hpp
template <AdaptiveStages Stages, class Field, class Observer>
Result<typename Stages::Real> integrate_adaptive(Stages& stages, Field&& field,
                                                 State<typename Stages::Group>& state,
                                                 typename Stages::Real t_end,
                                                 const AdaptiveOptions<typename Stages::Real>& options,
                                                 Observer&& observer) {
  static_assert(Stages::Tableau::first_same_as_last);
  using Real = typename Stages::Real;
  const auto show = [&](Real t) {
    if constexpr (Stages::dense_stages > 0) {
      observer(DenseStepOf<Stages, std::remove_reference_t<Field>>(stages, field, t));
    } else {
      NoField none;
      observer(DenseStepOf<Stages, NoField>(stages, none, t));
    }
  };
  auto result =
      detail::control_steps<detail::PairControl<Stages>>(stages, field, state, t_end, options, show);
  result.evaluations += stages.evaluations_of_completion();
  return result;
}

/// The same without an observer.
template <AdaptiveStages Stages, class Field>
Result<typename Stages::Real> integrate_adaptive(Stages& stages, Field&& field,
                                                 State<typename Stages::Group>& state,
                                                 typename Stages::Real t_end,
                                                 const AdaptiveOptions<typename Stages::Real>& options) {
  return integrate_adaptive(stages, field, state, t_end, options, [](const auto&) {});
}

/// Integrates to the last of the requested times and reports the state at each of them, by dense output: the
/// steps are those of the tolerance, whatever the times.
///
/// @param times     (any number) in the order in which they are passed; the first not before state.t
/// @param observer  called once for each time reached, as observer(Real t, const G& g, const Vector& y)
template <AdaptiveStages Stages, class Field, class Observer>
Result<typename Stages::Real> integrate_adaptive_at(Stages& stages, Field&& field,
                                                    State<typename Stages::Group>& state,
                                                    std::span<const typename Stages::Real> times,
                                                    const AdaptiveOptions<typename Stages::Real>& options,
                                                    Observer&& observer) {
  using Real = typename Stages::Real;
  if (times.empty()) return {};
  const Real direction = times.back() < state.t ? Real(-1) : Real(1);
  std::size_t next = 0;
  for (; next < times.size() && times[next] == state.t; ++next) observer(state.t, state.g, state.y);
  return integrate_adaptive(stages, field, state, times.back(), options, [&](const auto& step) {
    for (; next < times.size() && direction * times[next] <= direction * step.t_end(); ++next) {
      typename Stages::Group g;
      auto& y = stages.scratch_y();
      step.evaluate(times[next], g, y);
      observer(times[next], std::as_const(g), std::as_const(y));
    }
  });
}

}  // namespace anholon::integrate
