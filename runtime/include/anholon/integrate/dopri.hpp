// SPDX-License-Identifier: MIT
//
// Adaptive integration on a Lie group: Munthe-Kaas form (rkmk.hpp) of Dormand-Prince 5(4), with step control
// by a proportional-integral law and continuous output (dense.hpp). Hairer, Norsett & Wanner 1993, "Solving
// Ordinary Differential Equations I", II.4 (error, first step, control), and their code DOPRI5, whose
// constants are kept.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "anholon/integrate/dense.hpp"
#include "anholon/integrate/result.hpp"
#include "anholon/integrate/rkmk.hpp"
#include "anholon/integrate/tableau.hpp"

namespace anholon::integrate {

template <class G>
using DormandPrince = RkmkStages<G, DormandPrince54>;

/// The error of a step is weighed component by component, and the largest counts:
///
///   y_i             atol size_i + rtol max(|y_i(t)|, |y_i(t + h)|)
///   rotation        (atol + rtol) angle                         [rad]
///   translation     (atol + rtol) length                        [m]
///
/// What counts as a small error depends on the motion: 1e-9 J is little for a car and much for a robot of a
/// few grams. The sizes say how large each quantity ordinarily is in the motion at hand, such as its largest
/// magnitude; atol and rtol are then pure numbers. The pose has no size of its own (its position depends on
/// where the origin of the world is), so its error is taken in the body's axes.
template <class Real>
struct AdaptiveOptions {
  Real rtol = Real(1e-6L);
  Real atol = Real(1e-9L);
  Real angle = Real(1);         ///< what counts as a rotation of ordinary size [rad], > 0
  Real length = Real(1);        ///< what counts as a length of ordinary size [m], > 0
  std::span<const Real> sizes;  ///< (n_y) what counts as ordinary for each y_i, in its unit, > 0; empty:
                                ///< all 1. Read during the integration, not copied
  Real initial_step = Real(0);  ///< [s], > 0; 0: chosen from the field, at the cost of one evaluation
  Real max_step = std::numeric_limits<Real>::infinity();  ///< [s]
  long max_steps = 1'000'000;  ///< limit on attempted steps, rejected ones included
};

namespace detail {

/// The larger of two magnitudes, or not-a-number if either is.
template <class Real>
inline Real larger(Real a, Real b) noexcept {
  return a >= b || std::isnan(a) ? a : b;
}

/// Largest component of (tangent, vector), each divided by the tolerance that it is allowed.
template <class G>
class ErrorScale {
 public:
  using Real = typename G::Scalar;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

  explicit ErrorScale(const AdaptiveOptions<Real>& options) : options_(options) {}

  /// @param theta  (dim)     @param y  (n_y)     @param y_0, y_1  (n_y) values that set the size of each y_i
  Real operator()(const typename G::Tangent& theta, const Vector& y, const Vector& y_0,
                  const Vector& y_1) const {
    using std::abs;
    const Real rotation = (options_.atol + options_.rtol) * options_.angle;
    const Real translation = (options_.atol + options_.rtol) * options_.length;
    Real largest = Real(0);
    for (int i = 0; i < G::dim; ++i) {
      largest = larger(largest, abs(theta[i]) / (i < G::linear_dim ? translation : rotation));
    }
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const Real size = options_.sizes.empty() ? Real(1) : options_.sizes[static_cast<std::size_t>(i)];
      const Real allowed = options_.atol * size + options_.rtol * std::max(abs(y_0[i]), abs(y_1[i]));
      largest = larger(largest, abs(y[i]) / allowed);
    }
    return largest;
  }

 private:
  const AdaptiveOptions<Real>& options_;
};

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

}  // namespace detail

/// Integrates from state.t to t_end (which may lie before it) within the tolerances of `options`.
///
/// @param stages    workspace; its size_y() must be state.y.size()
/// @param field     see rkmk.hpp
/// @param state     in: initial; out: at the last accepted step
/// @param observer  called after each accepted step as observer(const DenseStep<G>&)
///
/// A step is also rejected, and halved, when it turns the body by more than pi, the range of the chart.
template <class G, class Field, class Observer>
Result<typename G::Scalar> integrate_adaptive(DormandPrince<G>& stages, Field&& field, State<G>& state,
                                              typename G::Scalar t_end,
                                              const AdaptiveOptions<typename G::Scalar>& options,
                                              Observer&& observer) {
  using Real = typename G::Scalar;
  using Tableau = DormandPrince54<Real>;
  using std::abs;
  using std::pow;
  eigen_assert(stages.size_y() == state.y.size());
  eigen_assert(options.sizes.empty() || static_cast<Eigen::Index>(options.sizes.size()) == state.y.size());

  const Real beta = Real(0.04L);                       // weight of the integral part
  const Real alpha = Real(0.2L) - Real(0.75L) * beta;  // the error of a step goes with h^5
  const Real safety = Real(0.9L), least_factor = Real(0.2L), largest_factor = Real(10);

  Result<Real> result;
  const detail::ErrorScale<G> scale(options);
  const Real direction = t_end < state.t ? Real(-1) : Real(1);
  // Below this a stage's time t + c h is no longer told from t.
  const Real least_step = 16 * std::numeric_limits<Real>::epsilon() * std::max(abs(state.t), abs(t_end));

  result.evaluations = 1;
  if (!stages.start(field, state)) {
    result.status = Status::non_finite;
    return result;
  }
  if (state.t == t_end) return result;

  Real size = options.initial_step;
  if (!(size > Real(0))) {
    size = detail::first_step<G>(stages, field, scale, direction, options);
    ++result.evaluations;
  }
  Real previous_error = Real(1e-4L);
  bool after_rejection = false;
  bool met_non_finite = false;

  while (true) {
    size = std::min(size, options.max_step);
    const Real t = stages.t_begin();
    const Real remaining = abs(t_end - t);
    if (result.accepted_steps + result.rejected_steps >= options.max_steps) {
      result.status = Status::too_many_steps;
      break;
    }
    if (size < least_step && size < remaining) {
      result.status = met_non_finite ? Status::non_finite : Status::step_too_small;
      break;
    }
    const bool last = Real(1.01L) * size >= remaining;
    const Real t_next = last ? t_end : t + direction * size;
    const Real h = t_next - t;  // exactly the difference of the two times
    stages.advance(field, h);
    result.evaluations += DormandPrince<G>::evaluations_per_step;

    if (stages.largest_turn() > largest_turn_in_a_step<Real>) {
      ++result.rejected_steps;
      after_rejection = true;
      size = abs(h) / 2;
      continue;
    }

    typename G::Tangent theta_error = G::Tangent::Zero();
    auto& y_error = stages.scratch_y();
    y_error.setZero();
    for (int i = 0; i < Tableau::stages; ++i) {
      theta_error += Tableau::error[i] * stages.theta_rate(i);
      y_error += Tableau::error[i] * stages.y_rate(i);
    }
    const Real error = abs(h) * scale(theta_error, y_error, stages.y_begin(), stages.y_end());

    if (!std::isfinite(error) || !stages.end_is_finite()) {
      ++result.rejected_steps;
      after_rejection = met_non_finite = true;
      size = abs(h) / 10;
      continue;
    }
    const Real needed = pow(error, alpha);
    if (error > Real(1)) {
      ++result.rejected_steps;
      after_rejection = true;
      size = abs(h) * std::max(least_factor, safety / needed);
      continue;
    }

    ++result.accepted_steps;
    met_non_finite = false;
    const Real wished = safety * pow(previous_error, beta) / needed;
    const Real factor = std::clamp(wished, least_factor, after_rejection ? Real(1) : largest_factor);
    previous_error = std::max(error, Real(1e-4L));
    after_rejection = false;
    // A last step that was cut short says little about the size to go on with.
    const Real proposed = abs(h) * factor;
    size = last ? std::max(size, proposed) : proposed;

    observer(DenseStep<G>(stages, t_next));
    stages.commit(field, t_next);
    if (last) break;
  }
  result.next_step = direction * size;
  stages.copy_current_to(state);
  return result;
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
