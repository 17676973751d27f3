// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "anholon/integrate/result.hpp"

namespace anholon {

/// A state as one list: R (9, row-major), p (3), then y.
template <class G>
std::vector<typename G::Scalar> final_values(const integrate::State<G>& state) {
  std::vector<typename G::Scalar> values;
  const auto R = state.g.R();
  const auto p = state.g.p();
  for (int i = 0; i < 9; ++i) values.push_back(R(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) values.push_back(p(i));
  for (Eigen::Index i = 0; i < state.y.size(); ++i) values.push_back(state.y(i));
  return values;
}

}  // namespace anholon
