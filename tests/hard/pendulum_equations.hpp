// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Lagrange's equations of a pendulum of many links, written by hand in the angles from the vertical, theta_i
// = r_1 + ... + r_i, each link with its mass at its end:
//
//   sum_j mu_ij l_i l_j (cos(theta_i - theta_j) theta_j'' + sin(theta_i - theta_j) theta_j'^2)
//       + J_i theta_i'' + mu_ii l_i g sin theta_i = 0,     mu_ij = m_max(i,j) + ... + m_n.
//
// Nothing of the project takes part but its exact numbers.

#include <algorithm>
#include <vector>

#include "number/exact.hpp"

namespace anholon::testing {

struct Links {
  std::vector<Exact> mass, length, inertia;  // kg; m; kg m^2 about the end
  Exact g;
};

/// Second derivatives of the angles between links.
inline std::vector<Exact> accelerations(const Links& links, const std::vector<Exact>& r,
                                        const std::vector<Exact>& r_dot) {
  const std::size_t n = r.size();
  std::vector<Exact> theta = r, rate = r_dot, carried = links.mass;
  for (std::size_t i = 1; i < n; ++i) theta[i] += theta[i - 1], rate[i] += rate[i - 1];
  for (std::size_t i = n - 1; i-- > 0;) carried[i] += carried[i + 1];
  std::vector<Exact> s, c;  // so that a difference of angles takes no sine of its own
  for (const Exact& angle : theta) s.push_back(sin(angle)), c.push_back(cos(angle));
  std::vector<std::vector<Exact>> M(n, std::vector<Exact>(n));
  std::vector<Exact> x(n);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = -carried[i] * links.length[i] * links.g * s[i];
    for (std::size_t j = 0; j < n; ++j) {
      const Exact coupling = carried[std::max(i, j)] * links.length[i] * links.length[j];
      M[i][j] = coupling * (c[i] * c[j] + s[i] * s[j]);
      x[i] -= coupling * (s[i] * c[j] - c[i] * s[j]) * rate[j] * rate[j];
    }
    M[i][i] += links.inertia[i];
  }
  for (std::size_t k = 0; k < n; ++k) {  // Gauss; M is positive definite
    for (std::size_t i = k + 1; i < n; ++i) {
      const Exact factor = M[i][k] / M[k][k];
      for (std::size_t j = k; j < n; ++j) M[i][j] -= factor * M[k][j];
      x[i] -= factor * x[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) x[k] -= M[k][j] * x[j];
    x[k] /= M[k][k];
  }
  for (std::size_t i = n; i-- > 1;) x[i] -= x[i - 1];
  return x;
}

}  // namespace anholon::testing
