// SPDX-License-Identifier: MIT
//
// Generated code of a scene, with nothing but the standard library.
#include <cmath>
#include <cstdio>

#include "bicycle_weave.hpp"

int main() {
  namespace weave = bicycle::weave;
  const auto par = weave::prepare(weave::Parameters<double>());
  const double steer_and_spin[2] = {0, 0}, rates[2] = {0, 6}, roll_rate[1] = {0.02};
  double eta[6], front_spin[1], H[7], J[14];
  weave::kinematics(par, steer_and_spin, roll_rate, rates, eta, front_spin, H, J);
  std::printf("forward %.3f m/s, front wheel %.3f rad/s\n", eta[1], front_spin[0]);
  // Straight on, both wheels roll alike: V_Y = h dot(r3) with h = 0.33 m.
  return std::abs(eta[1] - 0.33 * 6) < 1e-14 && std::abs(front_spin[0] - 6) < 1e-14 ? 0 : 1;
}
