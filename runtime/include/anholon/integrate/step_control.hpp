// SPDX-License-Identifier: MIT
//
// Steps that follow a tolerance: how the error of a step is weighed, and when a step is accepted, repeated or
// made longer. The same for every method that has an embedded solution. Hairer, Norsett & Wanner 1993,
// "Solving Ordinary Differential Equations I", II.4; Hairer & Wanner 1996, "II", IV.2 (proportional-integral
// control).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "anholon/integrate/result.hpp"

namespace anholon::integrate {

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
      if (y[i] == Real(0)) continue;  // what is and stays 0 is allowed 0 by atol = 0: no 0/0
      const Real size = options_.sizes.empty() ? Real(1) : options_.sizes[static_cast<std::size_t>(i)];
      const Real allowed = options_.atol * size + options_.rtol * std::max(abs(y_0[i]), abs(y_1[i]));
      largest = larger(largest, abs(y[i]) / allowed);
    }
    return largest;
  }

 private:
  const AdaptiveOptions<Real>& options_;
};

/// Integrates from state.t to t_end (which may lie before it) within the tolerances of `options`.
///
/// Method says what differs between methods:
///
///   alpha, beta, largest_factor    of the control: factor = 0.9 previous_error^beta / error^alpha
///   evaluations_per_attempt, evaluations_per_commit    calls of the field
///   first_step(stages, field, scale, direction, options, result)    [s], > 0
///   error(stages, scale)    of the step that was just advanced, 1 is what is allowed
///   step(stages, t_end)     what observers get: the step with its continuous output
///
/// A step is also rejected, and halved, when it turns the body by more than pi, the range of the chart.
template <class Method, class G, class Stages, class Field, class Observer>
Result<typename G::Scalar> control_steps(Stages& stages, Field&& field, State<G>& state,
                                         typename G::Scalar t_end,
                                         const AdaptiveOptions<typename G::Scalar>& options,
                                         Observer&& observer) {
  using Real = typename G::Scalar;
  using std::abs;
  using std::pow;
  eigen_assert(stages.size_y() == state.y.size());
  eigen_assert(options.sizes.empty() || static_cast<Eigen::Index>(options.sizes.size()) == state.y.size());
  const Real safety = Real(0.9L), least_factor = Real(0.2L);

  Result<Real> result;
  const ErrorScale<G> scale(options);
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
  if (!(size > Real(0))) size = Method::first_step(stages, field, scale, direction, options, result);
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
    result.evaluations += Method::evaluations_per_attempt;

    if (stages.largest_turn() > largest_turn_in_a_step<Real>) {
      ++result.rejected_steps;
      after_rejection = true;
      size = abs(h) / 2;
      continue;
    }

    const Real error = Method::error(stages, scale);

    if (!std::isfinite(error) || !stages.end_is_finite()) {
      ++result.rejected_steps;
      after_rejection = met_non_finite = true;
      size = abs(h) / 10;
      continue;
    }
    const Real needed = pow(error, Method::alpha);
    if (error > Real(1)) {
      ++result.rejected_steps;
      after_rejection = true;
      size = abs(h) * std::max(least_factor, safety / needed);
      continue;
    }

    ++result.accepted_steps;
    met_non_finite = false;
    const Real wished = safety * pow(previous_error, Method::beta) / needed;
    const Real factor = std::clamp(wished, least_factor, after_rejection ? Real(1) : Method::largest_factor);
    previous_error = std::max(error, Real(1e-4L));
    after_rejection = false;
    // A last step that was cut short says little about the size to go on with.
    const Real proposed = abs(h) * factor;
    size = last ? std::max(size, proposed) : proposed;

    observer(Method::step(stages, t_next));
    stages.commit(field, t_next);
    result.evaluations += Method::evaluations_per_commit;
    if (last) break;
  }
  result.next_step = direction * size;
  stages.copy_current_to(state);
  return result;
}

}  // namespace detail

}  // namespace anholon::integrate
