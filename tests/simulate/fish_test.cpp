// SPDX-License-Identifier: GPL-2.0-or-later
// The shipped fish: its balance of energy, its motion by shape alone against the connection of momentum that
// is written here, and the limit of a stiff fin.

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "simulate/columns.hpp"

namespace anholon::fish_test {
namespace {

using testing::column;
using testing::scene_of;
using Real = long double;

TEST(Fish, BalancesItsEnergyOverTenSeconds) {
  const SimulationResult result = simulate_scene(scene_of("fish/cruise"));
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_LT(result.energy_balance, 1e-9);
  EXPECT_GT(column(result, "x"), 1.5);  // three lengths of the fish and more: it swims
  EXPECT_GT(column(result, "dissipated"), 0.1 * column(result, "work"));
}

// ---- the kinematic fish, by hand

/// Data of models/fish/fish.toml, typed again. A link lies between its joint and the next one; the fin is a
/// link that does not bend.
struct Link {
  Real length, height, mass, inertia, along;  // added mass along it
};
std::array<Link, 5> links() {
  const Real rho = 1000, w = 0.05L;
  std::array<Link, 5> list = {{{0.16L, 0.12L, 0, 0, 0.08L},
                               {0.10L, 0.11L, 0, 0, 0},
                               {0.09L, 0.08L, 0, 0, 0},
                               {0.06L, 0.05L, 0, 0, 0},
                               {0.10L, 0.14L, 0, 0, 0}}};
  for (std::size_t i = 0; i < 4; ++i) {
    Link& k = list[i];
    k.mass = rho * M_PIl * w * k.height * k.length / 4;
    k.inertia = k.mass * (k.length * k.length / 12 + w * w / 16);
  }
  list[4].mass = 0.3L * 0.10L;
  list[4].inertia = list[4].mass * 0.10L * 0.10L / 12;
  return list;
}

/// eta = -I^-1 K r_dot: momentum in the head's axes, about its middle, is zero.
Eigen::Matrix<Real, 3, 1> velocity_without_momentum(const std::array<Real, 3>& r,
                                                    const std::array<Real, 3>& rate) {
  using Row = Eigen::Matrix<Real, 1, 6>;  // of (V_X, V_Y, Omega_Z, r1_dot, r2_dot, r3_dot)
  Eigen::Matrix<Real, 3, 6> momentum = Eigen::Matrix<Real, 3, 6>::Zero();
  Row x_dot = Row::Zero(), y_dot = Row::Zero(), turning = Row::Zero();  // of the end of the link before
  x_dot[0] = 1, y_dot[1] = 1, turning[2] = 1;
  Real x = 0, y = 0, angle = 0;
  std::size_t i = 0;
  for (const Link& link : links()) {
    const auto ahead = [&](Real by) {  // along the link, whose velocity turns with it
      x += by * std::cos(angle), y += by * std::sin(angle);
      x_dot -= by * std::sin(angle) * turning, y_dot += by * std::cos(angle) * turning;
    };
    if (i == 0) {
      // the head's frame is at its middle; V + Omega x (x, y)
    } else {
      if (i < 4) angle += r[i - 1], turning[static_cast<Eigen::Index>(2 + i)] = 1;
      ahead(-link.length / 2);
    }
    const Real c = std::cos(angle), s = std::sin(angle);
    const Real across = 1000 * M_PIl * link.height * link.height / 4;  // per length
    const Row u = c * x_dot + s * y_dot, v = c * y_dot - s * x_dot;
    const Row p = (link.mass + link.along) * u, q = (link.mass + across * link.length) * v;
    const Row P_x = c * p - s * q, P_y = s * p + c * q;
    const Real l = link.length;
    momentum.row(0) += P_x;
    momentum.row(1) += P_y;
    momentum.row(2) += (link.inertia + across * l * l * l / 12) * turning + x * P_y - y * P_x;
    ahead(-link.length / 2);
    ++i;
  }
  const Eigen::Matrix<Real, 3, 1> r_dot(rate[0], rate[1], rate[2]);
  return momentum.leftCols<3>().partialPivLu().solve(-momentum.rightCols<3>() * r_dot);
}

/// Pose at time T by classical Runge-Kutta steps of 1 ms.
std::array<Real, 3> pose_by_shape(Real T) {
  const auto rate = [](Real t, const std::array<Real, 3>& g) {
    const Real s = std::sin(4 * t), c = std::cos(4 * t);
    const std::array<Real, 3> r = {0.6L * (1 - c), 0.7L * s * s * s,
                                   0.5L * std::sin(8 * t) * std::sin(8 * t)};
    const std::array<Real, 3> r_dot = {2.4L * s, 8.4L * s * s * c, 8 * std::sin(8 * t) * std::cos(8 * t)};
    const Eigen::Matrix<Real, 3, 1> eta = velocity_without_momentum(r, r_dot);
    return std::array<Real, 3>{std::cos(g[2]) * eta[0] - std::sin(g[2]) * eta[1],
                               std::sin(g[2]) * eta[0] + std::cos(g[2]) * eta[1], eta[2]};
  };
  const int steps = static_cast<int>(std::lround(T * 1000));
  const Real h = T / steps;
  std::array<Real, 3> g{};
  for (int n = 0; n < steps; ++n) {
    const auto ahead = [&](const std::array<Real, 3>& k, Real by) {
      return std::array<Real, 3>{g[0] + by * k[0], g[1] + by * k[1], g[2] + by * k[2]};
    };
    const Real t = n * h;
    const auto k1 = rate(t, g), k2 = rate(t + h / 2, ahead(k1, h / 2)),
               k3 = rate(t + h / 2, ahead(k2, h / 2)), k4 = rate(t + h, ahead(k3, h));
    for (std::size_t i = 0; i < 3; ++i) g[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }
  return g;
}

TEST(Fish, WithoutDragAndMomentumMovesByItsShapeAlone) {
  const SimulationResult result = simulate_scene(scene_of("fish/turn_of_shape"));
  ASSERT_TRUE(result.finished) << result.status;
  const std::array<Real, 3> g = pose_by_shape(6);
  EXPECT_GT(std::abs(g[2]), 0.1);  // nearly four cycles turn it
  // the scene's tolerance is 1e-13 of its sizes, some 1e-12 over 6 s
  EXPECT_NEAR(column(result, "x"), static_cast<double>(g[0]), 1e-11);
  EXPECT_NEAR(column(result, "y"), static_cast<double>(g[1]), 1e-11);
  EXPECT_NEAR(column(result, "theta"), static_cast<double>(g[2]), 1e-11);
}

// ---- a stiff fin

SimulationResult cruise_with(const std::string& fin) {
  return simulate_scene(read_scene_text(
      "anholon = 1\nname = \"stiff\"\nmodel = \"fish.toml\"\n" + fin +
          "motion = { r1 = \"0.15*tanh(2*t)^2*sin(9*t)\", r2 = \"0.25*tanh(2*t)^2*sin(9*t - 0.9)\", r3 = "
          "\"0.35*tanh(2*t)^2*sin(9*t - 1.8)\" }\nduration = 2\noutput_step = 1\nintegrator = { method = "
          "\"dopri5\", tolerance = 1e-10 }\n",
      testing::root + "/models/fish/stiff.scene.toml"));
}

// Drag and wake act. What a stiff fin bends is quasi-static, load over stiffness: the difference from a rigid
// fin falls like 1/EI, up to the next order.
TEST(Fish, TendsToTheOneWithARigidFinAsItsFinStiffens) {
  const SimulationResult rigid = cruise_with("modes = { fin = 0 }\n");
  ASSERT_TRUE(rigid.finished) << rigid.status;
  std::vector<double> apart;
  for (const char* EI : {"8", "80", "800"}) {
    const SimulationResult bending = cruise_with(fmt::format("parameters = {{ EI = {}, eta = 2e-4 }}\n", EI));
    ASSERT_TRUE(bending.finished) << bending.status;
    double difference = 0;
    for (const char* name : {"x", "y", "theta", "V_X", "V_Y", "Omega_Z"})
      difference = std::max(difference, std::abs(column(bending, name) - column(rigid, name)));
    apart.push_back(difference);
  }
  EXPECT_NEAR(apart[0] / apart[1], 10, 1);
  EXPECT_NEAR(apart[1] / apart[2], 10, 1);
  EXPECT_LT(apart[2], 1e-4);
}

}  // namespace
}  // namespace anholon::fish_test
