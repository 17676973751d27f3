// SPDX-License-Identifier: GPL-2.0-or-later
//
// What the tests of the Lie groups and of the integrators share: tangent vectors of a given angle, and poses
// and twists as 4x4 matrices, in which the laws of a group are plain linear algebra.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "anholon/lie/se2.hpp"
#include "anholon/lie/se3.hpp"
#include "anholon/lie/so3.hpp"
#include "anholon/lie/translation.hpp"
#include "anholon/lie/trivial.hpp"

namespace anholon::testing {

template <class Real>
using Matrix4 = Eigen::Matrix<Real, 4, 4>;

/// [R, p; 0, 1]
template <class G>
Matrix4<typename G::Scalar> pose_matrix(const G& g) {
  Matrix4<typename G::Scalar> matrix = Matrix4<typename G::Scalar>::Identity();
  matrix.template topLeftCorner<3, 3>() = g.R();
  matrix.template topRightCorner<3, 1>() = g.p();
  return matrix;
}

/// The components of a tangent among (V_X, V_Y, V_Z, Omega_X, Omega_Y, Omega_Z).
template <class Real>
std::vector<int> twist_places(const lie::SE3<Real>&) {
  return {0, 1, 2, 3, 4, 5};
}
template <class Real>
std::vector<int> twist_places(const lie::SE2<Real>&) {
  return {0, 1, 5};
}
template <class Real>
std::vector<int> twist_places(const lie::SO3<Real>&) {
  return {3, 4, 5};
}
template <class Real, int k>
std::vector<int> twist_places(const lie::Translation<Real, k>&) {
  std::vector<int> places;
  for (int i = 0; i < k; ++i) places.push_back(i);
  return places;
}
template <class Real>
std::vector<int> twist_places(const lie::Trivial<Real>&) {
  return {};
}

/// xi^ = [Omega^, V; 0, 0]
template <class G>
Matrix4<typename G::Scalar> twist_matrix(const typename G::Tangent& xi) {
  using Real = typename G::Scalar;
  Eigen::Matrix<Real, 6, 1> twist = Eigen::Matrix<Real, 6, 1>::Zero();
  const std::vector<int> places = twist_places(G::identity());
  for (int i = 0; i < G::dim; ++i) twist[places[i]] = xi[i];
  Matrix4<Real> matrix;
  matrix << Real(0), -twist[5], twist[4], twist[0],  //
      twist[5], Real(0), -twist[3], twist[1],        //
      -twist[4], twist[3], Real(0), twist[2],        //
      Real(0), Real(0), Real(0), Real(0);
  return matrix;
}

/// A tangent with entries in [-1, 1], the angular part then brought to the given length.
template <class G>
typename G::Tangent tangent_of_angle(typename G::Scalar angle, std::mt19937_64& rng) {
  using Real = typename G::Scalar;
  std::uniform_real_distribution<double> uniform(-1, 1);
  typename G::Tangent xi;
  for (int i = 0; i < G::dim; ++i) xi[i] = Real(uniform(rng));
  if constexpr (G::dim > G::linear_dim) {
    auto angular = xi.template tail<G::dim - G::linear_dim>();
    angular *= angle / angular.norm();
  }
  return xi;
}

/// Angles that visit every branch: 0, log-spaced from 1e-12, both sides of pi/2 and of pi, then up to
/// `largest`.
template <class Real>
std::vector<Real> angles_up_to(Real largest) {
  const Real pi = Real(3.1415926535897932385L);
  std::vector<Real> angles = {Real(0)};
  for (int i = -48; i <= 2; ++i) angles.push_back(std::pow(Real(10), Real(i) / 4));  // 1e-12 ... 3.16
  for (int i = 1; i <= 12; ++i) angles.push_back(pi - std::pow(Real(10), Real(-i)));
  for (Real factor : {Real(0.999L), Real(1.001L)}) {
    angles.push_back(pi / 2 * factor);
    angles.push_back(pi * factor);
  }
  for (Real angle : {Real(4), Real(5), Real(6)}) angles.push_back(angle);
  std::erase_if(angles, [&](Real angle) { return angle > largest; });
  return angles;
}

}  // namespace anholon::testing
