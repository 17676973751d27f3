// SPDX-License-Identifier: GPL-2.0-or-later
//
// The variational integrator: order, momentum, energy over long times, on a tumbling body and a heavy top.
#include "anholon/integrate/variational.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "anholon/integrate/cooper_verner.hpp"
#include "run/lie_samples.hpp"

namespace anholon::testing::variational_test {
namespace {

using integrate::Rkmk8;
using integrate::State;
using integrate::VariationalStages;
using lie::SE2;
using lie::SE3;

/// A body with its origin off the mass centre, in a force field that pulls a point of it towards the origin
/// of the world with k times the distance; k = 0 leaves it free.
template <class G>
struct PulledBody {
  using Real = typename G::Scalar;
  using Tangent = typename G::Tangent;
  using Matrix = Eigen::Matrix<Real, G::dim, G::dim>;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Vector3 = Eigen::Matrix<Real, 3, 1>;
  Real k = 0;

  static Matrix mass_matrix() {
    Matrix M;
    if constexpr (G::dim == 6) {
      M << 2, 0, 0, 0, Real(0.2L), Real(-0.6L),  //
          0, 2, 0, Real(-0.2L), 0, Real(0.4L),   //
          0, 0, 2, Real(0.6L), Real(-0.4L), 0,   //
          0, Real(-0.2L), Real(0.6L), 1, Real(-0.1L), 0, Real(0.2L), 0, Real(-0.4L), Real(-0.1L), 2,
          Real(0.2L),  //
          Real(-0.6L), Real(0.4L), 0, 0, Real(0.2L), Real(2.5L);
    } else {
      M << 2, 0, Real(-0.6L), 0, 2, Real(0.4L), Real(-0.6L), Real(0.4L), Real(1.5L);
    }
    return M;
  }
  static Tangent velocity() {
    Tangent eta;
    if constexpr (G::dim == 6) {
      eta << Real(0.3L), Real(-0.2L), Real(0.5L), 1, Real(-0.7L), Real(0.4L);
    } else {
      eta << Real(0.3L), Real(-0.2L), Real(1.2L);
    }
    return eta;
  }

  void inertia(Matrix& M) const { M = mass_matrix(); }
  void wrench(Real, const G& g, Tangent& f) const {
    const Vector3 point(Real(0.3L), Real(0.1L), G::dim == 6 ? Real(0.2L) : Real(0));
    const Vector3 force = -k * (g.R().transpose() * g.p() + point);
    const Vector3 moment = point.cross(force);
    if constexpr (G::dim == 6) {
      f << force, moment;
    } else {
      f << force[0], force[1], moment[2];
    }
  }
  Real energy(const G& g, const Tangent& mu) const {
    const Vector3 point(Real(0.3L), Real(0.1L), G::dim == 6 ? Real(0.2L) : Real(0));
    return mu.dot(mass_matrix().llt().solve(mu)) / 2 + k / 2 * (g.p() + g.R() * point).squaredNorm();
  }
  /// Momentum in the axes of the world: Ad(g^-1)^T mu
  static Tangent of_world(const G& g, const Tangent& mu) { return g.inverse().adjoint().transpose() * mu; }

  /// The same motion as an ordinary field, y = mu: mu_dot = ad_eta^T mu + f.
  void operator()(Real t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) const {
    const Tangent mu = y;
    eta = mass_matrix().llt().solve(mu);
    Tangent f;
    wrench(t, g, f);
    for (int i = 0; i < G::dim; ++i) y_dot[i] = G::bracket(eta, Tangent::Unit(i)).dot(mu) + f[i];
  }
};

template <class G>
State<G> start() {
  State<G> state;
  state.y = PulledBody<G>::mass_matrix() * PulledBody<G>::velocity();
  return state;
}

template <class G, int order>
double slope_of_error() {
  using Real = typename G::Scalar;
  PulledBody<G> body{Real(3)};
  Rkmk8<G> accurate(G::dim);
  State<G> reference = start<G>();
  EXPECT_TRUE(integrate_fixed(accurate, body, reference, Real(2), 800));
  VariationalStages<G, order> stages;
  double errors[2];
  for (int i = 0; i < 2; ++i) {
    State<G> state = start<G>();
    EXPECT_TRUE(integrate_fixed(stages, body, state, Real(2), 80 << i));
    const auto pose = static_cast<double>((reference.g.inverse() * state.g).log().norm());
    errors[i] = pose + static_cast<double>((state.y - reference.y).norm());
  }
  return std::log2(errors[0] / errors[1]);
}

TEST(Variational, HasItsOrderOnSE3AndSE2) {
  EXPECT_NEAR((slope_of_error<SE3<long double>, 2>()), 2, 0.05);
  EXPECT_NEAR((slope_of_error<SE2<long double>, 2>()), 2, 0.05);
  EXPECT_NEAR((slope_of_error<SE3<long double>, 4>()), 4, 0.1);
  EXPECT_NEAR((slope_of_error<SE2<long double>, 4>()), 4, 0.1);
}

TEST(Variational, KeepsTheMomentumOfAFreeBodyToRounding) {
  using G = SE3<double>;
  const PulledBody<G> body;
  VariationalStages<G, 2> stages;
  State<G> state = start<G>();
  const auto before = decltype(body)::of_world(state.g, state.y);
  double worst = 0;
  const auto observe = [&](double, const G& g, const auto& mu) {
    worst = std::max(worst, (decltype(body)::of_world(g, mu) - before).norm() / before.norm());
  };
  EXPECT_TRUE(integrate_fixed(stages, body, state, 200.0, 2000, observe));  // steps of 0.1 s, 0.13 rad each
  EXPECT_LT(worst, 1e-12);  // roundings of 2000 steps, times the distance of up to 60 m that it has moved
}

TEST(Variational, LetsTheEnergySwingButNotDrift) {
  using G = SE3<double>;
  const PulledBody<G> body{3};
  VariationalStages<G, 2> stages;
  State<G> state = start<G>();
  const double before = body.energy(state.g, state.y);
  double early = 0, late = 0;
  const auto observe = [&](double t, const G& g, const auto& mu) {
    double& worst = t <= 200 ? early : late;
    if (t <= 200 || t > 1800) worst = std::max(worst, std::abs(body.energy(g, mu) / before - 1));
  };
  EXPECT_TRUE(integrate_fixed(stages, body, state, 2000.0, 40'000, observe));  // steps of 0.05 s
  EXPECT_LT(early, 1e-3);  // 1/12 of (0.05 s * 1.3 rad/s)^2, by the third derivatives; measured 3.6e-4
  EXPECT_LT(late, 1.2 * early);
}

TEST(Variational, GoesBackTheWayItCame) {
  using G = SE3<double>;
  const PulledBody<G> body{3};
  VariationalStages<G, 4> stages;
  State<G> state = start<G>();
  const State<G> before = state;
  EXPECT_TRUE(integrate_fixed(stages, body, state, 20.0, 200));
  EXPECT_TRUE(integrate_fixed(stages, body, state, 0.0, 200));
  // roundings of 2000 substeps; the way there errs by 1e-4
  EXPECT_LT((before.g.inverse() * state.g).log().norm() + (state.y - before.y).norm(), 1e-11);
}

TEST(Variational, NamesAStepThatHasNoSolution) {
  using G = SE3<double>;
  const PulledBody<G> body;
  VariationalStages<G, 2> stages;
  State<G> state = start<G>();
  EXPECT_FALSE(integrate_fixed(stages, body, state, 100.0, 10));  // 13 rad a step
  EXPECT_EQ(state.t, 0);
}

}  // namespace
}  // namespace anholon::testing::variational_test
