// SPDX-License-Identifier: MIT
#pragma once

// M = L^T D L of a mass matrix, L unit lower triangular, from the tips to the base: the zeros that branches
// leave in M stay zeros in L (Featherstone 2008, section 6.4). Zeros are those of structure, or of value
// where the scalar is a number.

#include <vector>

#include "anholon/matrix.hpp"
#include "anholon/second_moment.hpp"

namespace anholon {

template <class S>
struct LtdlFactor {
  Matrix<S> L;  // unit lower triangular; the diagonal is not stored
  std::vector<S> D;
  std::vector<S> inverse_D;

  /// Solves M x = b.
  [[nodiscard]] std::vector<S> solve(std::vector<S> x) const {
    const int n = L.rows();
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    for (int k = n; k-- > 0;) {  // L^T y = b
      for (int i = 0; i < k; ++i) {
        if (!vanishes(L(k, i))) x[at(i)] = x[at(i)] - L(k, i) * x[at(k)];
      }
    }
    for (int k = 0; k < n; ++k) {  // D z = y, L x = z
      x[at(k)] = inverse_D[at(k)] * x[at(k)];
      for (int i = 0; i < k; ++i) {
        if (!vanishes(L(k, i))) x[at(k)] = x[at(k)] - L(k, i) * x[at(i)];
      }
    }
    return x;
  }
};

template <class S>
LtdlFactor<S> ltdl(Matrix<S> M) {
  const int n = M.rows();
  LtdlFactor<S> f{Matrix<S>(n, n), std::vector<S>(static_cast<std::size_t>(n), S(0)),
                  std::vector<S>(static_cast<std::size_t>(n), S(0))};
  for (int k = n; k-- > 0;) {
    f.D[static_cast<std::size_t>(k)] = M(k, k);
    const S inverse = S(1) / M(k, k);
    f.inverse_D[static_cast<std::size_t>(k)] = inverse;
    for (int i = k; i-- > 0;) {
      if (vanishes(M(k, i))) continue;
      const S l = M(k, i) * inverse;
      f.L(k, i) = l;
      for (int j = 0; j <= i; ++j) {
        if (!vanishes(M(k, j))) M(i, j) = M(i, j) - l * M(k, j);
      }
    }
  }
  return f;
}

}  // namespace anholon
