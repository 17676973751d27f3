// SPDX-License-Identifier: GPL-2.0-or-later
//
// The stiff integrator: its order on Lie groups, what fast components cost and spoil, its stability.
#include "anholon/integrate/rosenbrock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "anholon/integrate/dopri.hpp"
#include "run/lie_samples.hpp"
#include "run/stiff_motion.hpp"

namespace anholon::testing::rosenbrock_test {
namespace {

using integrate::AdaptiveOptions;
using integrate::RosenbrockStages;
using integrate::RosenbrockStep;
using integrate::State;
using integrate::Status;

template <class Real>
AdaptiveOptions<Real> equal_steps(long steps) {
  AdaptiveOptions<Real> options;  // a tolerance that everything meets: steps of max_step
  options.rtol = options.atol = Real(1e30L);
  options.initial_step = options.max_step = Real(1) / Real(steps);
  return options;
}

/// Errors at t = 1, and the largest of the continuous solution on the way.
struct Errors {
  long double end = 0, inside = 0, slow = 0;  // slow: of the pose and of y_0, y_1
};

template <class G>
Errors errors_of(const StiffMotion<G>& motion, long steps) {
  using Real = typename G::Scalar;
  RosenbrockStages<G> stages(StiffMotion<G>::size_y);
  State<G> state{0, motion.pose(0), motion.y(0)};
  Errors errors;
  const auto outcome = integrate_adaptive(
      stages, motion, state, Real(1), equal_steps<Real>(steps), [&](const RosenbrockStep<G>& step) {
        G g;
        typename StiffMotion<G>::Vector y(motion.size_y);
        for (const Real s : {Real(0.25L), Real(0.5L), Real(0.75L)}) {
          const Real t = step.t_begin() + s * (step.t_end() - step.t_begin());
          step.evaluate(t, g, y);
          errors.inside = std::max<long double>(errors.inside, motion.error(t, g, y));
        }
      });
  EXPECT_EQ(outcome.status, Status::ok);
  EXPECT_EQ(outcome.accepted_steps, steps);
  errors.end = motion.error(1, state.g, state.y);
  const typename StiffMotion<G>::Vector off = state.y - motion.y(1);
  errors.slow =
      std::sqrt((motion.pose(1).inverse() * state.g).log().squaredNorm() + off[0] * off[0] + off[1] * off[1]);
  return errors;
}

template <class G>
class RosenbrockOn : public ::testing::Test {
 protected:
  /// Slope of the errors from 8 to 128 steps.
  static double slope(const Errors& coarse, const Errors& fine, long double Errors::*which) {
    return static_cast<double>(std::log2(coarse.*which / fine.*which)) / 4;
  }
};
using Groups = ::testing::Types<lie::SE3<double>, lie::SE2<double>, lie::SO3<long double>>;
TYPED_TEST_SUITE(RosenbrockOn, Groups);

TYPED_TEST(RosenbrockOn, TheJacobianOfTheTestMotionIsThatOfItsField) {
  using G = TypeParam;
  using Real = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Vector = typename StiffMotion<G>::Vector;
  const StiffMotion<G> motion;
  constexpr int n = G::dim, size = n + StiffMotion<G>::size_y;
  const auto field = [&](Real t, const G& g, const Vector& y) {
    Tangent eta;
    Vector y_dot(motion.size_y), all(size);
    motion(t, g, y, eta, y_dot);
    all << eta, y_dot;
    return all;
  };
  const Real t = Real(0.4L), h = Real(1e-4L);
  const G g = motion.pose(t) * G::exp(Real(0.1L) * motion.path.xi_1);
  const Vector y = motion.y(t) + Vector::LinSpaced(motion.size_y, Real(0.1L), Real(0.5L));
  typename StiffMotion<G>::Matrix F(size, size);
  Vector F_t(size);
  motion.jacobian(t, g, y, F, F_t);
  const Real allowed = Real(1e-6L);  // h^2 times third derivatives of up to some ten
  EXPECT_LT(((field(t + h, g, y) - field(t - h, g, y)) / (2 * h) - F_t).norm(), allowed);
  for (int j = 0; j < size; ++j) {
    Vector after, before;
    if (j < n) {
      const Tangent twist = h * Tangent::Unit(j);
      after = field(t, g * G::exp(twist), y), before = field(t, g * G::exp(-twist), y);
    } else {
      const Vector step = h * Vector::Unit(motion.size_y, j - n);
      after = field(t, g, y + step), before = field(t, g, y - step);
    }
    EXPECT_LT(((after - before) / (2 * h) - F.col(j)).norm(), allowed) << "column " << j;
  }
}

TYPED_TEST(RosenbrockOn, HasOrder5) {
  const StiffMotion<TypeParam> motion;  // 3 rad/s and 2 1/s: nothing is fast
  const Errors coarse = errors_of(motion, 8), fine = errors_of(motion, 128);
  EXPECT_NEAR(this->slope(coarse, fine, &Errors::end), 5, 0.15);  // measured 4.9 to 5.1
  EXPECT_NEAR(this->slope(coarse, fine, &Errors::inside), 5, 0.25);
}

TYPED_TEST(RosenbrockOn, HasOrder5AtAMillionRadiansASecondToo) {
  // Long before a step resolves the fast components, the method works on them as on algebraic equations,
  // and is of order 5 there as well; its continuous solution is of order 4.
  StiffMotion<TypeParam> motion;
  motion.omega = motion.lambda = 1e6;
  const Errors coarse = errors_of(motion, 8), fine = errors_of(motion, 64);
  const double end = static_cast<double>(std::log2(coarse.end / fine.end)) / 3;
  const double slow = static_cast<double>(std::log2(coarse.slow / fine.slow)) / 3;
  const double inside = static_cast<double>(std::log2(coarse.inside / fine.inside)) / 3;
  EXPECT_GT(end, 4.6);  // measured 4.8 to 5.0: an error of the force's rate in 1/omega shows at last
  EXPECT_GT(slow, 4.8);
  EXPECT_GT(inside, 3.8);
}

TYPED_TEST(RosenbrockOn, ErrsNoMoreWhereFastComponentsAreFaster) {
  const StiffMotion<TypeParam> slow_motion;
  const long double allowed = 20 * errors_of(slow_motion, 20).slow;  // measured up to 6 times, at omega = 100
  for (const double omega : {1e1, 1e2, 1e3, 1e4, 1e5, 1e6}) {
    StiffMotion<TypeParam> motion;
    motion.omega = motion.lambda = static_cast<typename TypeParam::Scalar>(omega);
    EXPECT_LT(errors_of(motion, 20).slow, allowed) << omega;
  }
}

TEST(Rosenbrock, TakesAsManyStepsWhereFastComponentsAreFaster) {
  const auto run = [](double omega, auto stages, long& evaluations) {
    using G = lie::SE3<double>;
    StiffMotion<G> motion;
    motion.omega = motion.lambda = omega;
    // A rate of fast elongation weighs as the energy does that it would have as ringing: its own size is
    // smaller by 1/omega, and to that the method is of order 2 only.
    const std::vector<double> sizes = {1, 1, 1 / (omega * omega), 1 / omega, 1};
    AdaptiveOptions<double> options;
    options.rtol = options.atol = 1e-7;
    options.sizes = sizes;
    State<G> state{0, motion.pose(0), motion.y(0)};
    const auto outcome = integrate_adaptive(stages, motion, state, 1.0, options);
    EXPECT_TRUE(outcome) << name(outcome.status);
    // of a thousand undamped radians by the explicit method 2.3e-5: what its steps err adds up
    EXPECT_LT(motion.error(1, state.g, state.y), 1e-4);
    evaluations = outcome.evaluations;
  };
  long soft = 0, stiff = 0, explicit_soft = 0, explicit_stiff = 0;
  run(1e1, RosenbrockStages<lie::SE3<double>>(5), soft);
  run(1e6, RosenbrockStages<lie::SE3<double>>(5), stiff);
  run(1e1, integrate::DormandPrince<lie::SE3<double>>(5), explicit_soft);
  run(1e3, integrate::DormandPrince<lie::SE3<double>>(5), explicit_stiff);
  EXPECT_LT(stiff, 2 * soft);
  EXPECT_GT(explicit_stiff, 10 * explicit_soft);
}

/// Growth of y' = z y over one step of length 1, R(z).
std::complex<double> growth(std::complex<double> z) {
  using G = lie::Trivial<double>;
  using Vector = Eigen::VectorXd;
  struct Linear {
    std::complex<double> z;
    void operator()(double, const G&, const Vector& y, G::Tangent&, Vector& y_dot) const {
      y_dot << z.real() * y[0] - z.imag() * y[1], z.imag() * y[0] + z.real() * y[1];
    }
    void jacobian(double, const G&, const Vector&, Eigen::MatrixXd& F, Vector& F_t) const {
      F << z.real(), -z.imag(), z.imag(), z.real();
      F_t.setZero();
    }
  };
  RosenbrockStages<G> stages(2);
  State<G> state{0, {}, Eigen::Vector2d(1, 0)};
  EXPECT_TRUE(integrate_adaptive(stages, Linear{z}, state, 1.0, equal_steps<double>(1)));
  return {state.y[0], state.y[1]};
}

TEST(Rosenbrock, IsLStable) {
  for (double size = 1e-3; size < 1e9; size *= 1.3) {
    EXPECT_LE(std::abs(growth({0, size})), 1 + 1e-12) << size;  // undamped oscillations do not grow
    EXPECT_LE(std::abs(growth({-size, size})), 1) << size;
    EXPECT_LE(std::abs(growth({-size, 0})), 1) << size;
  }
  EXPECT_LT(std::abs(growth({-1e8, 0})), 1e-6);  // and what is fast enough is gone after one step
  EXPECT_LT(std::abs(growth({0, 1e8})), 1e-6);
  const std::complex<double> z(-0.02, 0.01);
  EXPECT_LT(std::abs(growth(z) - std::exp(z)), 1e-13);  // z^6/6! = 2e-13 times an error constant below 1
}

TEST(Rosenbrock, CountsWhatItCalls) {
  using G = lie::SE2<double>;
  struct Counting : StiffMotion<G> {
    mutable long evaluations = 0, jacobians = 0;
    void operator()(double t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) const {
      ++evaluations;
      StiffMotion<G>::operator()(t, g, y, eta, y_dot);
    }
    void jacobian(double t, const G& g, const Vector& y, Matrix& F, Vector& F_t) const {
      ++jacobians;
      StiffMotion<G>::jacobian(t, g, y, F, F_t);
    }
  };
  const Counting motion;
  AdaptiveOptions<double> options;
  options.rtol = options.atol = 1e-9;
  options.initial_step = 0.5;  // too long: steps are rejected
  State<G> state{0, motion.pose(0), motion.y(0)};
  RosenbrockStages<G> stages(decltype(motion)::size_y);
  const auto outcome = integrate_adaptive(stages, motion, state, 1.0, options);
  ASSERT_TRUE(outcome);
  EXPECT_GT(outcome.rejected_steps, 0);
  EXPECT_EQ(outcome.evaluations, motion.evaluations);
  EXPECT_EQ(outcome.jacobians, motion.jacobians);
  EXPECT_EQ(outcome.evaluations, 1 + 8 * outcome.accepted_steps + 7 * outcome.rejected_steps);
}

TEST(Rosenbrock, NamesAFieldThatEnds) {
  using G = lie::Trivial<double>;
  struct Blowing {  // y' = y^2, which is infinite at t = 1
    void operator()(double, const G&, const Eigen::VectorXd& y, G::Tangent&, Eigen::VectorXd& y_dot) const {
      y_dot[0] = y[0] * y[0];
    }
    void jacobian(double, const G&, const Eigen::VectorXd& y, Eigen::MatrixXd& F,
                  Eigen::VectorXd& F_t) const {
      F(0, 0) = 2 * y[0];
      F_t.setZero();
    }
  };
  RosenbrockStages<G> stages(1);
  State<G> state{0, {}, Eigen::VectorXd::Ones(1)};
  AdaptiveOptions<double> options;
  options.rtol = options.atol = 1e-8;
  const auto outcome = integrate_adaptive(stages, Blowing{}, state, 2.0, options);
  EXPECT_NE(outcome.status, Status::ok);
  EXPECT_NEAR(state.t, 1, 1e-3);
}

}  // namespace
}  // namespace anholon::testing::rosenbrock_test
