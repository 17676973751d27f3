// SPDX-License-Identifier: GPL-2.0-or-later
//
// One sheet of laws for every Lie group and every floating type.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "run/lie_samples.hpp"

namespace anholon::testing::lie_laws_test {
namespace {

using lie::SE2;
using lie::SE3;
using lie::SO3;
using lie::Translation;
using lie::Trivial;

template <class G>
struct InLongDouble;
template <class Real>
struct InLongDouble<SE3<Real>> {
  using type = SE3<long double>;
};
template <class Real>
struct InLongDouble<SE2<Real>> {
  using type = SE2<long double>;
};
template <class Real>
struct InLongDouble<SO3<Real>> {
  using type = SO3<long double>;
};
template <class Real, int k>
struct InLongDouble<Translation<Real, k>> {
  using type = Translation<long double, k>;
};
template <class Real>
struct InLongDouble<Trivial<Real>> {
  using type = Trivial<long double>;
};

template <class G>
class EveryLieGroup : public ::testing::Test {
 protected:
  using Real = typename G::Scalar;
  using Long = typename InLongDouble<G>::type;
  static constexpr Real ulp = std::numeric_limits<Real>::epsilon();
  static constexpr Real pi = Real(3.1415926535897932385L);

  std::mt19937_64 rng{20130922};  // fixed: a failure must be repeatable

  typename G::Tangent random_tangent(Real largest_angle = pi) {
    return tangent_of_angle<G>(largest_angle * Real(std::uniform_real_distribution<double>(0, 1)(rng)), rng);
  }
  G random_pose() { return G::exp(random_tangent()) * G::exp(random_tangent()); }

  /// Largest difference of two poses, taken over the entries of their 4x4 matrices.
  template <class A, class B>
  static long double distance(const A& a, const B& b) {
    return (pose_matrix(a).template cast<long double>() - pose_matrix(b).template cast<long double>())
        .cwiseAbs()
        .maxCoeff();
  }
  static long double length(const typename G::Tangent& xi) { return static_cast<long double>(xi.norm()); }

  /// exp by squaring a Taylor polynomial of the 4x4 matrix, in long double.
  static Matrix4<long double> matrix_exponential(Matrix4<long double> A) {
    A /= 1024.0L;
    Matrix4<long double> sum = Matrix4<long double>::Identity(), term = sum;
    for (int k = 1; k < 16; ++k) {
      term = (term * A / static_cast<long double>(k)).eval();
      sum += term;
    }
    for (int k = 0; k < 10; ++k) sum = (sum * sum).eval();
    return sum;
  }
};

using Groups = ::testing::Types<SE3<double>, SE3<float>, SE3<long double>, SE2<double>, SE2<float>,
                                SE2<long double>, SO3<double>, Translation<long double, 3>, Trivial<double>>;
TYPED_TEST_SUITE(EveryLieGroup, Groups);

TYPED_TEST(EveryLieGroup, ComposesAsMatricesDo) {
  for (int sample = 0; sample < 200; ++sample) {
    const auto a = this->random_pose(), b = this->random_pose();
    const auto product = (pose_matrix(a) * pose_matrix(b)).eval();
    // entries up to 8 (two displacements), some 10 roundings
    EXPECT_LT((pose_matrix(a * b) - product).cwiseAbs().maxCoeff(), 20 * this->ulp);
  }
}

TYPED_TEST(EveryLieGroup, IdentityIsNeutralAndInverseUndoes) {
  for (int sample = 0; sample < 200; ++sample) {
    const auto g = this->random_pose();
    const auto one = TypeParam::identity();
    EXPECT_EQ(this->distance(g * one, g), 0);
    EXPECT_EQ(this->distance(one * g, g), 0);
    EXPECT_LT(this->distance(g * g.inverse(), one), 20 * this->ulp);  // as for the product
    EXPECT_LT(this->distance(g.inverse() * g, one), 20 * this->ulp);
  }
}

TYPED_TEST(EveryLieGroup, RotationIsOrthonormalAndRightHanded) {
  for (int sample = 0; sample < 200; ++sample) {
    const auto R = this->random_pose().R();
    // Two exps and a product leave |q| off by 3 ulp at most, which R^T R shows 4 sqrt(2) times: measured 16.
    EXPECT_LT((R.transpose() * R - R.Identity()).norm(), 24 * this->ulp);
    EXPECT_GT(R.determinant(), 0.5);
  }
}

TYPED_TEST(EveryLieGroup, ExpIsTheMatrixExponentialAtEveryAngle) {
  for (const auto angle : angles_up_to(this->pi * 2)) {
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    const auto xi = tangent_of_angle<TypeParam>(angle, this->rng);
    const auto expected =
        this->matrix_exponential(twist_matrix<typename TestFixture::Long>(xi.template cast<long double>()));
    const auto difference = (pose_matrix(TypeParam::exp(xi)).template cast<long double>() - expected).eval();
    // The angle itself is only known to 1/2 ulp of up to 2 pi = 3 ulp(1); the reference in long double has
    // lost 1024 roundings by squaring: 1024 * 1e-19 = 1e-16, which is what is allowed to the long double
    // groups.
    const long double tolerance = 12 * static_cast<long double>(this->ulp) + 2e-16L;
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), tolerance);
  }
}

TYPED_TEST(EveryLieGroup, LogUndoesExpAtEveryAngleUpToPi) {
  for (const auto angle : angles_up_to(this->pi * (1 - 4 * this->ulp))) {  // pi itself may round to beyond pi
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    for (int sample = 0; sample < 10; ++sample) {
      const auto xi = tangent_of_angle<TypeParam>(angle, this->rng);
      const auto back = TypeParam::exp(xi).log();
      // Relative in the angle, relative to the whole in the displacement; Jacobian of the round trip <= pi/2.
      EXPECT_LE(this->length(back - xi), 16 * static_cast<long double>(this->ulp) * this->length(xi));
      if constexpr (TypeParam::dim > TypeParam::linear_dim) {
        constexpr int angular = TypeParam::dim - TypeParam::linear_dim;
        EXPECT_LE((back - xi).template tail<angular>().norm(), 6 * this->ulp * angle);
      }
    }
  }
}

TYPED_TEST(EveryLieGroup, ExpUndoesLogOfAnyPose) {
  for (int sample = 0; sample < 500; ++sample) {
    const auto g = this->random_pose();
    const auto xi = g.log();
    // dexp_inv grows to pi/2 at half a turn and the displacement is up to 4: 20 roundings of that size
    EXPECT_LT(this->distance(TypeParam::exp(xi), g), 64 * this->ulp);
    if constexpr (TypeParam::dim > TypeParam::linear_dim) {
      EXPECT_LE(xi.template tail<TypeParam::dim - TypeParam::linear_dim>().norm(),
                this->pi * (1 + 2 * this->ulp));
    }
  }
}

TYPED_TEST(EveryLieGroup, ExpIsAHomomorphismAlongALine) {
  for (int sample = 0; sample < 200; ++sample) {
    const auto xi = this->random_tangent();
    const auto third = (xi / 3).eval(), rest = (xi - third).eval();
    EXPECT_LT(this->distance(TypeParam::exp(third) * TypeParam::exp(rest), TypeParam::exp(xi)),
              30 * this->ulp);
  }
}

TYPED_TEST(EveryLieGroup, BracketIsTheCommutatorOfMatrices) {
  for (int sample = 0; sample < 100; ++sample) {
    const auto a = this->random_tangent(), b = this->random_tangent();
    const auto A = twist_matrix<TypeParam>(a), B = twist_matrix<TypeParam>(b);
    const auto difference = (twist_matrix<TypeParam>(TypeParam::bracket(a, b)) - (A * B - B * A)).eval();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 60 * this->ulp);  // entries up to 2 pi^2
  }
}

TYPED_TEST(EveryLieGroup, AdjointCarriesATwistFromBodyToWorld) {
  for (int sample = 0; sample < 100; ++sample) {
    const auto g = this->random_pose();
    const auto xi = this->random_tangent();
    const typename TypeParam::Tangent carried = g.adjoint() * xi;
    // (Ad_g xi)^ = g xi^ g^-1
    const auto expected = (pose_matrix(g) * twist_matrix<TypeParam>(xi) * pose_matrix(g.inverse())).eval();
    EXPECT_LT((twist_matrix<TypeParam>(carried) - expected).cwiseAbs().maxCoeff(),
              200 * this->ulp);  // <= 4 * 4 * pi
  }
}

TYPED_TEST(EveryLieGroup, DexpInvSolvesTheSeriesOfTheRightJacobian) {
  using Long = typename TestFixture::Long;
  for (const auto angle : angles_up_to(this->pi)) {
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    for (int sample = 0; sample < 10; ++sample) {
      const auto theta = tangent_of_angle<TypeParam>(angle, this->rng);
      const auto eta = this->random_tangent();
      const auto theta_dot = TypeParam::dexp_inv(theta, eta);
      // eta = dexp_{-theta}(theta_dot) = sum_k (-1)^k/(k + 1)! ad_theta^k theta_dot, in long double
      typename Long::Tangent term = theta_dot.template cast<long double>(), sum = term;
      for (int k = 1; k < 50; ++k) {
        term = (Long::bracket(theta.template cast<long double>(), term) / -static_cast<long double>(k + 1))
                   .eval();
        sum += term;
      }
      const auto residual = (sum - eta.template cast<long double>()).eval();
      // Coefficients c and c' to 4 and 10 ulp times |theta|^2 <= 10; terms of the series up to e^pi = 23.
      const long double tolerance = 60 * static_cast<long double>(this->ulp) * (this->length(eta) + 1);
      EXPECT_LE(residual.norm(), tolerance);
    }
  }
}

TYPED_TEST(EveryLieGroup, DexpInvIsTheRateOfTheCoordinatesOfAMovingBody) {
  using Long = typename TestFixture::Long;
  const long double h = 1e-5L;
  for (const auto angle : angles_up_to(typename TypeParam::Scalar(6))) {
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    const typename Long::Tangent theta =
        tangent_of_angle<TypeParam>(angle, this->rng).template cast<long double>();
    const typename Long::Tangent eta = this->random_tangent().template cast<long double>();
    const typename Long::Tangent theta_dot = Long::dexp_inv(theta, eta);
    // eta = d/dt log( exp(theta)^-1 exp(theta + t theta_dot) ), by central differences
    const Long back = Long::exp(theta).inverse();
    const typename Long::Tangent later = (back * Long::exp(theta + h * theta_dot)).log();
    const typename Long::Tangent earlier = (back * Long::exp(theta - h * theta_dot)).log();
    // theta_dot reaches 60 at 6 rad, and the third derivative its cube: h^2/6 * 60^3 = 4e-6
    const long double allowed = 1e-9L + h * h * std::pow(theta_dot.norm(), 3.0L);
    EXPECT_LE(((later - earlier) / (2 * h) - eta).norm(), allowed);
  }
}

TYPED_TEST(EveryLieGroup, AgreesWithLongDoubleThroughEveryBranch) {
  using Long = typename TestFixture::Long;
  for (const auto angle : angles_up_to(this->pi)) {
    SCOPED_TRACE(::testing::Message() << "angle " << angle);
    const auto xi = tangent_of_angle<TypeParam>(angle, this->rng);
    const auto eta = this->random_tangent();
    const typename Long::Tangent& xi_long = xi.template cast<long double>();
    const typename Long::Tangent& eta_long = eta.template cast<long double>();
    EXPECT_LT(this->distance(TypeParam::exp(xi), Long::exp(xi_long)), 8 * this->ulp);
    const auto difference =
        (TypeParam::dexp_inv(xi, eta).template cast<long double>() - Long::dexp_inv(xi_long, eta_long))
            .eval();
    // sums of a handful of terms, each up to |theta|^2/4 = 2.5 times |eta| <= 4
    EXPECT_LE(difference.norm(), 24 * static_cast<long double>(this->ulp));
  }
}

TEST(SpecialEuclidean2, KeepsTheTurnsThatTheHeadingHasMade) {
  const SE2<double> turn = SE2<double>::exp({0, 0, 3});
  EXPECT_EQ((turn * turn * turn).theta(), 9);
  EXPECT_NEAR((turn * turn * turn).log()[2], 9 - 2 * M_PI, 1e-15);  // one rounding of 9
}

TEST(SpecialEuclidean2, IsThePlaneOfSpecialEuclidean3) {
  std::mt19937_64 rng(20130922);
  std::uniform_real_distribution<double> uniform(-3, 3);
  for (int sample = 0; sample < 100; ++sample) {
    const Eigen::Vector3d xi(uniform(rng), uniform(rng), uniform(rng));
    const Eigen::Vector3d eta(uniform(rng), uniform(rng), uniform(rng));
    Eigen::Matrix<double, 6, 1> xi_space, eta_space;
    xi_space << xi[0], xi[1], 0, 0, 0, xi[2];
    eta_space << eta[0], eta[1], 0, 0, 0, eta[2];
    const auto plane = SE2<double>::dexp_inv(xi, eta);
    const auto space = SE3<double>::dexp_inv(xi_space, eta_space);
    EXPECT_NEAR(plane[0], space[0], 1e-14);  // entries up to 20, a dozen roundings
    EXPECT_NEAR(plane[1], space[1], 1e-14);
    EXPECT_NEAR(plane[2], space[5], 1e-14);
    EXPECT_LT((pose_matrix(SE2<double>::exp(xi)) - pose_matrix(SE3<double>::exp(xi_space))).norm(), 1e-14);
  }
}

TEST(SpecialOrthogonal3, LogOfHalfATurnHasLengthPi) {
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector4d quaternion = Eigen::Vector4d::Zero();
    quaternion[1 + axis] = -1;
    const Eigen::Vector3d theta = SO3<double>(quaternion).log();
    EXPECT_EQ(std::abs(theta[axis]), M_PI);
    EXPECT_EQ(theta.norm(), M_PI);
  }
}

TEST(SpecialOrthogonal3, OppositeQuaternionsHaveTheSameLog) {
  std::mt19937_64 rng(20130922);
  for (int sample = 0; sample < 100; ++sample) {
    const auto g = SO3<double>::exp(tangent_of_angle<SO3<double>>(3.0 * sample / 100, rng));
    const SO3<double> opposite(-g.quaternion_wxyz());
    EXPECT_LT((g.log() - opposite.log()).norm(), 1e-15);  // the norm is divided out: 2 roundings
  }
}

}  // namespace
}  // namespace anholon::testing::lie_laws_test
