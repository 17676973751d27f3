// SPDX-License-Identifier: MIT
//
// What a Lie group must offer to the integrators and to the mechanics: a concept, not a base class.
// Every group of this folder has the same functions in the same order, and the conventions below.
//
// An element g is the pose of a body frame B in the world frame W: x_W = R x_B + p.
//
// Velocities are left-trivialised, that is taken in the axes of the body, the LINEAR PART FIRST:
//
//   eta = g^-1 g_dot = (V, Omega)                              V [m/s], Omega [rad/s], both in B
//
// Canonical coordinates of the first kind are taken on the right of a fixed element g0,
//
//   g(t) = g0 exp(theta(t)),     theta_dot = dexp^-1_{-theta}(eta) =: dexp_inv(theta, eta)
//
//   dexp^-1_{-theta}(eta) = sum_k (-1)^k B_k / k! ad_theta^k eta                          (1)
//                         = eta + 1/2 [theta, eta] + 1/12 [theta, [theta, eta]] - ...
//
// with B_k the Bernoulli numbers (B_1 = -1/2). So dexp_inv(theta, .) is the inverse of the *right* Jacobian
// of exp; the inverse of the left one is dexp_inv(-theta, .). Iserles, Munthe-Kaas, Norsett & Zanna 2000,
// "Lie-group methods", Acta Numerica 9; there Y_dot = A Y is trivialised on the right, whence our -theta.
#pragma once

#include <Eigen/Core>
#include <concepts>

namespace anholon::lie {

/// A Lie group of poses. `dim` is its dimension n, of which the first `linear_dim` components of a tangent
/// vector are lengths (or speeds) and the others angles (or angular rates).
template <class G>
concept LieGroup = requires(G& writable, const G& g, const typename G::Tangent& xi) {
  typename G::Scalar;
  requires std::same_as<typename G::Tangent, Eigen::Matrix<typename G::Scalar, G::dim, 1>>;
  requires 0 <= G::linear_dim&& G::linear_dim <= G::dim;
  { G::identity() } -> std::same_as<G>;
  { g* g } -> std::same_as<G>;
  { g.inverse() } -> std::same_as<G>;
  { G::exp(xi) } -> std::same_as<G>;
  { g.log() } -> std::same_as<typename G::Tangent>;
  { g.adjoint() } -> std::same_as<Eigen::Matrix<typename G::Scalar, G::dim, G::dim>>;
  { G::bracket(xi, xi) } -> std::same_as<typename G::Tangent>;
  { G::dexp_inv(xi, xi) } -> std::same_as<typename G::Tangent>;
  { g.R() } -> std::same_as<Eigen::Matrix<typename G::Scalar, 3, 3>>;
  { g.p() } -> std::same_as<Eigen::Matrix<typename G::Scalar, 3, 1>>;
  { writable.normalize() } -> std::same_as<void>;
  { g.is_finite() } -> std::same_as<bool>;
};

}  // namespace anholon::lie
