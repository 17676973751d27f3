// SPDX-License-Identifier: GPL-2.0-or-later
#include "motion.hpp"

namespace anholon::bench {

FinalState free_base(const std::array<double, 4>& quaternion_wxyz, const Vec3<double>& p,
                     const Vec3<double>& linear_in_world, const Vec3<double>& angular) {
  const Mat3<double> R = rotation(quaternion_wxyz);
  const Vec3<double> linear = transposed_times(R, linear_in_world);
  FinalState end;
  end.position.assign(R.m.begin(), R.m.end());
  for (int c = 0; c < 3; ++c) end.position.push_back(p[c]);
  for (const Vec3<double>& v : {linear, angular}) {
    for (int c = 0; c < 3; ++c) end.velocity.push_back(v[c]);
  }
  return end;
}

}  // namespace anholon::bench
