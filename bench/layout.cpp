// SPDX-License-Identifier: GPL-2.0-or-later
#include "layout.hpp"

namespace anholon::bench {

std::vector<double> Layout::theirs(const Sample& s, const Spatial<double>& base,
                                   const std::vector<double>& joints) const {
  std::vector<double> v(at.size(), 0.0);
  const std::size_t n = free_base ? 6 : 0;
  if (free_base) {
    const Vec3<double> linear = linear_in_world ? s.state.R * base.linear : base.linear;
    const Vec3<double> angular = angular_in_world ? s.state.R * base.angular : base.angular;
    for (int c = 0; c < 3; ++c) {
      v[at[static_cast<std::size_t>(c)]] = linear[c];
      v[at[static_cast<std::size_t>(c) + 3]] = angular[c];
    }
  }
  for (std::size_t i = 0; i < joints.size(); ++i) v[at[n + i]] = joints[i];
  return v;
}

std::vector<double> Layout::velocity(const Sample& s) const { return theirs(s, s.state.eta, s.state.r_dot); }

std::vector<double> Layout::acceleration(const Sample& s) const {
  Spatial<double> base = s.eta_dot;
  if (linear_in_world) base.linear += cross(s.state.eta.angular, s.state.eta.linear);
  return theirs(s, base, s.r_ddot);
}

std::vector<double> Layout::force(const Sample& s) const { return theirs(s, {}, s.tau); }

void Layout::turn_base(const Sample& s, std::vector<double>& v) const {
  if (!free_base) return;
  const auto turn = [&](std::size_t first) {
    const Vec3<double> own = transposed_times(s.state.R, Vec3<double>{v[first], v[first + 1], v[first + 2]});
    for (int c = 0; c < 3; ++c) v[first + static_cast<std::size_t>(c)] = own[c];
  };
  if (linear_in_world) turn(0);
  if (angular_in_world) turn(3);
}

std::vector<double> Layout::our_force(const Sample& s, const Entry& theirs) const {
  std::vector<double> v;
  for (const std::size_t i : at) v.push_back(theirs(i));
  turn_base(s, v);
  return v;
}

std::vector<double> Layout::our_acceleration(const Sample& s, const Entry& theirs) const {
  std::vector<double> v = our_force(s, theirs);
  if (!free_base || !linear_in_world) return v;
  const Vec3<double> drift = cross(s.state.eta.angular, s.state.eta.linear);
  for (int c = 0; c < 3; ++c) v[static_cast<std::size_t>(c)] -= drift[c];
  return v;
}

std::vector<double> Layout::our_matrix(const Sample& s, const MatrixEntry& theirs) const {
  const std::size_t n = at.size();
  std::vector<double> half(n * n);  // rows are theirs, columns ours
  for (std::size_t i = 0; i < n; ++i) {
    const std::vector<double> row = our_force(s, [&](std::size_t j) { return theirs(at[i], j); });
    std::copy(row.begin(), row.end(), half.begin() + static_cast<std::ptrdiff_t>(n * i));
  }
  std::vector<double> M(n * n);
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<double> column;
    for (std::size_t i = 0; i < n; ++i) column.push_back(half[n * i + j]);
    turn_base(s, column);
    for (std::size_t i = 0; i < n; ++i) M[n * i + j] = column[i];
  }
  return M;
}

}  // namespace anholon::bench
