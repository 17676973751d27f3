// SPDX-License-Identifier: GPL-2.0-or-later
//
// Orders of the integrators on Lie groups, against a motion known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "anholon/integrate/cf4.hpp"
#include "anholon/integrate/cooper_verner.hpp"
#include "anholon/integrate/dop853.hpp"
#include "anholon/integrate/dopri.hpp"
#include "anholon/integrate/rkmk.hpp"
#include "run/lie_samples.hpp"
#include "run/manufactured_motion.hpp"

namespace anholon::testing::integrate_order_test {
namespace {

using integrate::AdaptiveOptions;
using integrate::Cf4Stages;
using integrate::Dop853;
using integrate::DormandPrince;
using integrate::Rkmk4;
using integrate::Rkmk8;
using integrate::State;
using integrate::Status;

/// Errors at growing numbers of steps.
struct Convergence {
  std::vector<long double> step, error;

  /// Slope of log(error) over log(step), by least squares.
  long double slope() const {
    const std::size_t n = step.size();
    long double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < n; ++i) {
      mean_x += std::log(step[i]) / n;
      mean_y += std::log(error[i]) / n;
    }
    for (std::size_t i = 0; i < n; ++i) {
      xx += (std::log(step[i]) - mean_x) * (std::log(step[i]) - mean_x);
      xy += (std::log(step[i]) - mean_x) * (std::log(error[i]) - mean_y);
    }
    return xy / xx;
  }
  /// The same between the last two.
  long double last_slope() const {
    const std::size_t n = step.size();
    return std::log(error[n - 1] / error[n - 2]) / std::log(step[n - 1] / step[n - 2]);
  }
  long double decades() const { return std::log10(error.front() / error.back()); }
};

template <class G>
State<G> initial_state(const ManufacturedMotion<G>& motion) {
  return {0, motion.pose(0), motion.y(0)};
}

/// Halves the step until the error has fallen by the wanted number of decades or below the floor, which then
/// does not count, or 2^18 steps are made.
template <class Stages, class G>
Convergence converge(const ManufacturedMotion<G>& motion, long steps, double decades, double floor = 0) {
  using Real = typename G::Scalar;
  Convergence result;
  Stages stages(motion.size_y);
  for (; steps <= (1L << 18); steps *= 2) {
    State<G> state = initial_state(motion);
    const auto outcome = integrate_fixed(stages, motion, state, Real(1), steps);
    EXPECT_EQ(outcome.status, Status::ok);
    const auto error = motion.error(1, state.g, state.y);
    if (error < floor) break;
    result.step.push_back(1.0L / steps);
    result.error.push_back(error);
    if (result.error.size() > 1 && result.decades() >= decades) break;
  }
  return result;
}

template <class G>
class IntegrationOn : public ::testing::Test {
 protected:
  // Double: errors from some 1e-3 down to 1e-13, a few hundred roundings. Long double: from 1e-4 down to
  // 1e-16.
  static constexpr bool is_long = std::numeric_limits<typename G::Scalar>::digits > 53;
  static constexpr double decades = is_long ? 12 : 10;
  static constexpr long coarsest = is_long ? 6 : 3;

  void expect_order(const Convergence& found, double order) const {
    EXPECT_GE(found.decades(), decades);
    EXPECT_NEAR(found.slope(), order,
                0.12);  // the coarsest steps still show the next order; measured 0.01 to 0.1
    // Less so at the finest (measured 0.06), unless rounding shows, as it may in double at 1e-13.
    EXPECT_NEAR(found.last_slope(), order, is_long ? 0.08 : 0.3);
  }
  /// Order 8 leaves few halvings between steps that are too long and rounding, which shows from some thirty
  /// units of the last place on: two or three of them.
  template <class Stages>
  void expect_order_8() const {
    constexpr double floor = is_long ? 1e-17 : 1e-14;
    const Convergence found = converge<Stages>(motion, is_long ? 6 : 3, 99, floor);
    ASSERT_GE(found.error.size(), 3U);
    EXPECT_GE(found.decades(), 4.5);
    EXPECT_NEAR(found.slope(), 8, is_long ? 0.1 : 0.25);       // measured 0.05 and 0.17 away
    EXPECT_NEAR(found.last_slope(), 8, is_long ? 0.1 : 0.25);  // 0.01 and 0.08
  }
  ManufacturedMotion<G> motion;
};
using Groups = ::testing::Types<lie::SE3<double>, lie::SE2<double>, lie::Translation<double, 2>,
                                lie::SE3<long double>, lie::SE2<long double>>;
TYPED_TEST_SUITE(IntegrationOn, Groups);

TYPED_TEST(IntegrationOn, MuntheKaas4HasOrder4OverTenDecades) {
  this->expect_order(converge<Rkmk4<TypeParam>>(this->motion, this->coarsest, this->decades), 4);
}

TYPED_TEST(IntegrationOn, DormandPrinceHasOrder5OverTenDecades) {
  this->expect_order(converge<DormandPrince<TypeParam>>(this->motion, this->coarsest, this->decades), 5);
}

TYPED_TEST(IntegrationOn, CommutatorFree4HasOrder4OverTenDecades) {
  this->expect_order(converge<Cf4Stages<TypeParam>>(this->motion, this->coarsest, this->decades), 4);
}

TYPED_TEST(IntegrationOn, MuntheKaas8HasOrder8) { this->template expect_order_8<Rkmk8<TypeParam>>(); }

TYPED_TEST(IntegrationOn, Dop853HasOrder8) { this->template expect_order_8<Dop853<TypeParam>>(); }

/// Largest error of the continuous solution at a quarter, a half and three quarters of every step.
template <template <class> class Stages, class G>
Convergence converge_inside_steps(const ManufacturedMotion<G>& motion, bool first_step_only, long steps,
                                  int halvings) {
  using Real = typename G::Scalar;
  Convergence result;
  Stages<G> stages(motion.size_y);
  for (int i = 0; i < halvings; ++i, steps *= 2) {
    const Real h = Real(1) / Real(steps);
    AdaptiveOptions<Real> fixed;  // a tolerance that everything meets: steps of max_step
    fixed.rtol = fixed.atol = Real(1e6L);
    fixed.initial_step = fixed.max_step = h;
    State<G> state = initial_state(motion);
    Real largest = 0;
    const Real t_end = first_step_only ? h : Real(1);
    integrate_adaptive(stages, motion, state, t_end, fixed, [&](const auto& step) {
      G g;
      typename ManufacturedMotion<G>::Vector y(motion.size_y);
      for (const Real s : {Real(0.25L), Real(0.5L), Real(0.75L)}) {
        const Real t = step.t_begin() + s * (step.t_end() - step.t_begin());
        step.evaluate(t, g, y);
        largest = std::max(largest, motion.error(t, g, y));
      }
    });
    result.step.push_back(h);
    result.error.push_back(largest);
  }
  return result;
}

TYPED_TEST(IntegrationOn, DenseOutputOfOneStepErrsWithItsFifthPower) {
  const Convergence found = converge_inside_steps<DormandPrince>(this->motion, true, 8, 5);
  EXPECT_NEAR(found.slope(), 5, 0.15);  // an interpolant of order 4
}

TYPED_TEST(IntegrationOn, DenseOutputOfManyStepsKeepsOrder5) {
  const Convergence found = converge_inside_steps<DormandPrince>(this->motion, false, 8, 6);
  EXPECT_NEAR(found.slope(), 5, 0.15);
}

TYPED_TEST(IntegrationOn, DenseOutputOfDop853KeepsOrder8) {
  const Convergence found = converge_inside_steps<Dop853>(this->motion, false, 4, this->is_long ? 4 : 3);
  EXPECT_NEAR(found.slope(), 8, 0.4);
}

TYPED_TEST(IntegrationOn, GoingBackReturnsToTheStart) {
  using Real = typename TypeParam::Scalar;
  DormandPrince<TypeParam> stages(this->motion.size_y);
  State<TypeParam> state = initial_state(this->motion);
  AdaptiveOptions<Real> options;
  options.rtol = options.atol = Real(1e-10L);
  ASSERT_TRUE(integrate_adaptive(stages, this->motion, state, Real(2), options));
  const auto back = integrate_adaptive(stages, this->motion, state, Real(0), options);
  ASSERT_TRUE(back);
  EXPECT_LT(back.next_step, 0);
  EXPECT_EQ(state.t, 0);
  // some 100 steps each way of 1e-10; measured 3e-10
  EXPECT_LT(this->motion.error(0, state.g, state.y), 3e-9);
}

}  // namespace
}  // namespace anholon::testing::integrate_order_test
