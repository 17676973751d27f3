// SPDX-License-Identifier: MIT
//
// Generated code of a robot file: what holds the chain up against the moon.
#include <cmath>
#include <cstdio>

#include "free_chain.hpp"

int main() {
  namespace chain = free_chain::standard;
  const auto par = chain::prepare(chain::Parameters<double>());
  const double level[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, r[2] = {0.3, -0.4};
  double base_wrench[6], tau[2];
  chain::gravity_forces(par, level, r, base_wrench, tau);
  std::printf("weight %.3f N\n", base_wrench[2]);
  // A free base carries all 17.5 kg, by 1.62 m/s^2, whatever the joints do.
  return std::abs(base_wrench[2] - 17.5 * 1.62) < 1e-13 ? 0 : 1;
}
