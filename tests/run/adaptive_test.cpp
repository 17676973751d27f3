// SPDX-License-Identifier: GPL-2.0-or-later
//
// The adaptive integrator: accuracy follows the tolerance, dense output meets it, failures are named.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "anholon/integrate/dopri.hpp"
#include "anholon/monitors.hpp"
#include "run/lie_samples.hpp"
#include "run/manufactured_motion.hpp"

namespace anholon::testing::adaptive_test {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using integrate::AdaptiveOptions;
using integrate::DenseStep;
using integrate::DormandPrince;
using integrate::Rkmk4;
using integrate::State;
using integrate::Status;
using lie::SE3;
using lie::SO3;
using lie::Trivial;

template <class Real>
AdaptiveOptions<Real> tolerance(long double value) {
  AdaptiveOptions<Real> options;
  options.rtol = options.atol = Real(value);
  return options;
}

TEST(DormandPrince, ErrorIsProportionalToTheTolerance) {
  const ManufacturedMotion<SE3<double>> motion;
  DormandPrince<SE3<double>> stages(decltype(motion)::size_y);
  std::vector<double> errors;
  for (int exponent = -3; exponent >= -12; --exponent) {
    SCOPED_TRACE(::testing::Message() << "tolerance 1e" << exponent);
    const double allowed = std::pow(10.0, exponent);
    State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
    ASSERT_TRUE(integrate_adaptive(stages, motion, state, 2.0, tolerance<double>(allowed)));
    errors.push_back(motion.error(2, state.g, state.y));
    // A global error is the sum of those of the steps (8 to 400 of them), less what local extrapolation
    // gains: measured 0.6 to 1.0 times the tolerance.
    EXPECT_LT(errors.back(), 5 * allowed);
    EXPECT_GT(errors.back(), allowed / 5);
  }
  const double slope = std::log10(errors.front() / errors.back()) / 9;
  EXPECT_NEAR(slope, 1, 0.1);  // measured 1.03
}

TEST(DormandPrince, TakesTheSameStepsForAMotionOfAnySize) {
  const auto oscillator = [](double, const Trivial<double>&, const VectorXd& y, auto&, VectorXd& y_dot) {
    y_dot << y[1], -y[0];
  };
  const auto run = [&](double size, State<Trivial<double>>& state) {
    DormandPrince<Trivial<double>> stages(2);
    const std::vector<double> sizes = {size, size};
    auto options = tolerance<double>(1e-9);
    options.sizes = sizes;
    state = {0, {}, size * Eigen::Vector2d(0.3, -0.4)};
    return integrate_adaptive(stages, oscillator, state, 10.0, options);
  };
  State<Trivial<double>> ordinary, tiny;
  const double size = std::ldexp(1.0, -40);  // a power of two, so that roundings are the same
  const auto expected = run(1, ordinary), found = run(size, tiny);
  ASSERT_TRUE(expected && found);
  EXPECT_EQ(found.accepted_steps, expected.accepted_steps);
  EXPECT_EQ(found.rejected_steps, expected.rejected_steps);
  EXPECT_EQ(tiny.y, size * ordinary.y);
}

TEST(DormandPrince, EvaluatesSixTimesAStepAndReportsIt) {
  const ManufacturedMotion<SE3<double>> motion;
  DormandPrince<SE3<double>> stages(decltype(motion)::size_y);
  State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
  const auto result = integrate_adaptive(stages, motion, state, 2.0, tolerance<double>(1e-8));
  EXPECT_EQ(result.evaluations, motion.evaluations);
  // one at the start, one to choose the first step
  EXPECT_EQ(result.evaluations, 2 + 6 * (result.accepted_steps + result.rejected_steps));
}

TEST(MuntheKaas4, EvaluatesFourTimesAStepAndReportsIt) {
  ManufacturedMotion<SE3<double>> motion;
  Rkmk4<SE3<double>> stages(decltype(motion)::size_y);
  State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
  const auto result = integrate_fixed(stages, motion, state, 1.0, 10);
  EXPECT_EQ(result.evaluations, motion.evaluations);
  EXPECT_EQ(result.evaluations, 1 + 4 * result.accepted_steps);
}

TEST(DormandPrince, RejectsStepsAcrossAKinkAndStillMeetsTheTolerance) {
  // y' = 1 before t = 1, 100 after
  const auto kink = [](double t, const Trivial<double>&, const VectorXd&, auto&, VectorXd& y_dot) {
    y_dot[0] = t < 1 ? 1 : 100;
  };
  DormandPrince<Trivial<double>> stages(1);
  State<Trivial<double>> state{0, {}, VectorXd::Zero(1)};
  const auto result = integrate_adaptive(stages, kink, state, 2.0, tolerance<double>(1e-8));
  EXPECT_TRUE(result);
  EXPECT_GT(result.rejected_steps, 3);
  EXPECT_NEAR(state.y[0], 101, 1e-5);  // 1e-8 * 101, in the one step that crosses
}

/// Free heavy top of inertia (1, 1, I_3): R(t) = exp(L t) exp((1 - I_3) Omega_3 t e_3), L = I Omega(0), g(0)
/// = 1.
struct SymmetricTop {
  double I_3 = 2.5;
  Vector3d Omega_0{0.6, -0.3, 1.7};
  Vector3d momentum() const { return {Omega_0[0], Omega_0[1], I_3 * Omega_0[2]}; }
  SO3<double> pose(double t) const {
    return SO3<double>::exp(t * momentum()) *
           SO3<double>::exp((1 - I_3) * Omega_0[2] * t * Vector3d::UnitZ());
  }
  void operator()(double, const SO3<double>&, const VectorXd& y, Vector3d& eta, VectorXd& y_dot) const {
    const Vector3d Omega = y.head<3>(), L(Omega[0], Omega[1], I_3 * Omega[2]);
    eta = Omega;
    const Vector3d moment = L.cross(Omega);
    y_dot << moment[0], moment[1], moment[2] / I_3;
  }
};

TEST(DormandPrince, FollowsTheFreeSymmetricTop) {
  const SymmetricTop top;
  DormandPrince<SO3<double>> stages(3);
  State<SO3<double>> state{0, {}, top.Omega_0};
  double worst_pose = 0, worst_momentum = 0, worst_rotation = 0;
  EnergyBalance<double> energy(top.Omega_0.dot(top.momentum()) / 2, top.Omega_0.dot(top.momentum()) / 2);
  const auto result = integrate_adaptive(
      stages, top, state, 20.0, tolerance<double>(1e-10), [&](const DenseStep<SO3<double>>& step) {
        const Vector3d Omega = step.y_end(), L(Omega[0], Omega[1], top.I_3 * Omega[2]);
        worst_pose = std::max(worst_pose, (top.pose(step.t_end()).inverse() * step.g_end()).log().norm());
        worst_momentum = std::max(worst_momentum, (step.g_end().R() * L - top.momentum()).norm());
        worst_rotation = std::max(worst_rotation, orthonormality_defect(step.g_end().R()));
        energy.observe(Omega.dot(L) / 2);
      });
  EXPECT_TRUE(result);
  // 1250 steps of less than 1e-10 each; angles drift with the error of Omega besides.
  EXPECT_LT(worst_pose, 2e-8);        // measured 1.8e-9
  EXPECT_LT(worst_momentum, 2e-9);    // measured 1.7e-10
  EXPECT_LT(energy.largest(), 2e-9);  // measured 1.9e-10
  EXPECT_LT(worst_rotation, 4e-15);   // rounding only: measured 1.9e-15
}

TEST(DormandPrince, DenseOutputMeetsTheToleranceAtRequestedTimes) {
  const ManufacturedMotion<SE3<double>> motion;
  DormandPrince<SE3<double>> stages(decltype(motion)::size_y);
  State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
  std::vector<double> times, seen;
  for (int i = 0; i <= 500; ++i) times.push_back(i * 0.004);
  double worst = 0;
  const auto result = integrate_adaptive_at(stages, motion, state, times, tolerance<double>(1e-9),
                                            [&](double t, const auto& g, const VectorXd& y) {
                                              seen.push_back(t);
                                              worst = std::max(worst, motion.error(t, g, y));
                                            });
  EXPECT_TRUE(result);
  EXPECT_EQ(seen, times);
  EXPECT_LT(result.accepted_steps, 300);  // the times do not shorten the steps
  EXPECT_LT(worst, 1e-8);                 // measured 1.1e-9
}

TEST(DormandPrince, DenseOutputIsContinuousWithItsSlopeFromStepToStep) {
  const ManufacturedMotion<SE3<double>> motion;
  DormandPrince<SE3<double>> stages(decltype(motion)::size_y);
  State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
  const double small = 1e-6;
  VectorXd last_y, last_slope;
  Eigen::Matrix<double, 6, 1> last_twist = Eigen::Matrix<double, 6, 1>::Zero();
  integrate_adaptive(stages, motion, state, 2.0, tolerance<double>(1e-4),
                     [&](const DenseStep<SE3<double>>& step) {
                       SE3<double> g, g_after;
                       VectorXd y(3), y_after(3);
                       step.evaluate(step.t_begin(), g, y);
                       step.evaluate(step.t_begin() + small, g_after, y_after);
                       const Eigen::Matrix<double, 6, 1> twist = (g.inverse() * g_after).log() / small;
                       if (step.t_begin() > 0) {
                         EXPECT_LT((y - last_y).norm(), 1e-14);
                         // difference quotients: second derivatives below 20, times 1e-6
                         EXPECT_LT(((y_after - y) / small - last_slope).norm(), 4e-5);
                         EXPECT_LT((twist - last_twist).norm(), 4e-5);
                       }
                       step.evaluate(step.t_end(), g_after, y_after);
                       step.evaluate(step.t_end() - small, g, y);
                       last_y = y_after;
                       last_slope = (y_after - y) / small;
                       last_twist = (g.inverse() * g_after).log() / small;
                     });
}

TEST(DormandPrince, NamesABlowUp) {
  // y' = y^2, y = 1/(1 - t)
  const auto field = [](double, const Trivial<double>&, const VectorXd& y, auto&, VectorXd& y_dot) {
    y_dot[0] = y[0] * y[0];
  };
  DormandPrince<Trivial<double>> stages(1);
  State<Trivial<double>> state{0, {}, VectorXd::Ones(1)};
  const auto result = integrate_adaptive(stages, field, state, 2.0, tolerance<double>(1e-8));
  EXPECT_EQ(result.status, Status::step_too_small) << name(result.status);
  EXPECT_NEAR(state.t, 1, 1e-6);
  EXPECT_TRUE(state.y.allFinite());
}

TEST(DormandPrince, NamesTheEndOfTheDomainOfTheField) {
  const auto field = [](double t, const Trivial<double>&, const VectorXd&, auto&, VectorXd& y_dot) {
    y_dot[0] = std::sqrt(0.5 - t);
  };
  DormandPrince<Trivial<double>> stages(1);
  State<Trivial<double>> state{0, {}, VectorXd::Ones(1)};
  const auto result = integrate_adaptive(stages, field, state, 1.0, tolerance<double>(1e-8));
  EXPECT_EQ(result.status, Status::non_finite) << name(result.status);
  EXPECT_NEAR(state.t, 0.5, 1e-6);
  EXPECT_TRUE(state.y.allFinite());
}

TEST(DormandPrince, NeverTakesAnErrorThatIsNotANumberForASmallOne) {
  const AdaptiveOptions<double> options;
  const integrate::detail::ErrorScale<Trivial<double>> scale(options);
  const VectorXd y = VectorXd::Ones(2);
  EXPECT_TRUE(std::isnan(scale({}, Eigen::Vector2d(std::nan(""), 1), y, y)));
  EXPECT_TRUE(std::isnan(scale({}, Eigen::Vector2d(1, std::nan("")), y, y)));
}

TEST(DormandPrince, NamesAStartThatIsNotANumber) {
  const ManufacturedMotion<SE3<double>> motion;
  DormandPrince<SE3<double>> stages(decltype(motion)::size_y);
  State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
  state.y[2] = std::nan("");
  EXPECT_EQ(integrate_adaptive(stages, motion, state, 1.0, {}).status, Status::non_finite);
}

TEST(DormandPrince, StopsAtTheLimitOfSteps) {
  const ManufacturedMotion<SE3<double>> motion;
  DormandPrince<SE3<double>> stages(decltype(motion)::size_y);
  State<SE3<double>> state{0, motion.pose(0), motion.y(0)};
  auto options = tolerance<double>(1e-9);
  options.max_steps = 7;
  const auto result = integrate_adaptive(stages, motion, state, 2.0, options);
  EXPECT_EQ(result.status, Status::too_many_steps);
  EXPECT_EQ(result.accepted_steps + result.rejected_steps, 7);
  EXPECT_LT(motion.error(state.t, state.g, state.y), 1e-7);  // the state is that of the last accepted step
}

TEST(Integration, RefusesStepsBeyondTheChartOfExp) {
  const auto spin = [](double, const SO3<double>&, const VectorXd&, Vector3d& eta, VectorXd&) {
    eta << 0, 0, 10;
  };
  Rkmk4<SO3<double>> fixed(0);
  State<SO3<double>> state{0, {}, VectorXd()};
  EXPECT_EQ(integrate_fixed(fixed, spin, state, 1.0, 1).status, Status::turned_too_far);
  EXPECT_EQ(state.t, 0);
  EXPECT_EQ(integrate_fixed(fixed, spin, state, 1.0, 4).status, Status::ok);  // 2.5 rad a step

  // A constant spin is exact at any step, so only the chart limits the adaptive one.
  DormandPrince<SO3<double>> adaptive(0);
  state = {0, {}, VectorXd()};
  auto options = tolerance<double>(1e-3);
  options.initial_step = 1;
  const auto result = integrate_adaptive(adaptive, spin, state, 1.0, options);
  EXPECT_TRUE(result);
  EXPECT_GE(result.rejected_steps, 2);
  EXPECT_LT((SO3<double>::exp({0, 0, 10}).inverse() * state.g).log().norm(), 1e-14);
}

TEST(Integration, KeepsTheQuaternionOfUnitLengthThroughAMillionSteps) {
  const auto field = [](float t, const SE3<float>&, const Eigen::VectorXf&, auto& eta, Eigen::VectorXf&) {
    eta << 1, 0, 0, std::sin(t), 0.5f, std::cos(2 * t);
  };
  Rkmk4<SE3<float>> stages(0);
  State<SE3<float>> state{0, {}, Eigen::VectorXf()};
  float worst = 0;
  integrate_fixed(stages, field, state, 1000.0f, 1'000'000,
                  [&](float, const SE3<float>& g, const Eigen::VectorXf&) {
                    worst = std::max(worst, std::abs(g.quaternion_wxyz().norm() - 1));
                  });
  EXPECT_LE(worst, 3e-7f);  // 2 or 3 ulp(1) = 1.2e-7; without renormalisation 8e-3
}

TEST(Integration, SumsAMillionEqualIncrementsToOneUlp) {
  const auto field = [](float, const Trivial<float>&, const Eigen::VectorXf&, auto&, Eigen::VectorXf& y_dot) {
    y_dot[0] = 0.1f;
  };
  Rkmk4<Trivial<float>> stages(1);
  State<Trivial<float>> state{0, {}, Eigen::VectorXf::Zero(1)};
  integrate_fixed(stages, field, state, 1000.0f, 1'000'000);
  // 100 to one or two ulp (8e-6 each), and the rounding of h = 0.001 and of the mean of rates, 1e-7 relative
  // each: measured 1.5e-5. Plain summation misses by 0.7.
  EXPECT_NEAR(state.y[0], 100, 4e-5);
}

TEST(DormandPrince, WorksInFloatAndLongDouble) {
  {
    const ManufacturedMotion<SE3<float>> motion;
    DormandPrince<SE3<float>> stages(decltype(motion)::size_y);
    State<SE3<float>> state{0, motion.pose(0), motion.y(0)};
    ASSERT_TRUE(integrate_adaptive(stages, motion, state, 1.0f, tolerance<float>(1e-4L)));
    EXPECT_LT(motion.error(1, state.g, state.y), 1e-3f);
  }
  {
    const ManufacturedMotion<SE3<long double>> motion;
    DormandPrince<SE3<long double>> stages(decltype(motion)::size_y);
    State<SE3<long double>> state{0, motion.pose(0), motion.y(0)};
    ASSERT_TRUE(integrate_adaptive(stages, motion, state, 1.0L, tolerance<long double>(1e-15L)));
    EXPECT_LT(motion.error(1, state.g, state.y), 1e-14L);
  }
}

}  // namespace
}  // namespace anholon::testing::adaptive_test
