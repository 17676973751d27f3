// SPDX-License-Identifier: GPL-2.0-or-later
// The shipped flapping wing: its balance of energy, and its twist of small amplitude against the oscillator
// of one degree of freedom that it then is.

#include <cmath>
#include <complex>
#include <fstream>
#include <sstream>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "simulate/columns.hpp"

namespace anholon::flapping_wing_test {
namespace {

TEST(FlappingWing, BalancesItsEnergyAndLiftsItself) {
  const SimulationResult result = simulate_scene(testing::scene_of("flapping_wing/take_off"));
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_LT(result.energy_balance, 1e-9);
  EXPECT_GT(testing::column(result, "p_Z"), 0);
}

/// The shipped wing on a root that stands still.
Model on_a_fixed_root() {
  std::ostringstream text;
  text << std::ifstream(testing::root + "/models/flapping_wing/flapping_wing.toml").rdbuf();
  std::string changed = text.str();
  const std::string group = "group   = \"SE3\"";
  const std::size_t at = changed.find(group);
  EXPECT_NE(at, std::string::npos);
  changed.replace(at, group.size(), "group = \"fixed\"");
  return read_model_text(changed, "wing.toml");
}

// Twist theta of the left wing while it sweeps by phi = a sin(omega t), a small. A point of the plate at x up
// the chord and y along the span moves across the wing by y phi - x theta, with its mass centre at x = -d;
// lift and drag are of higher order. So
//   J theta'' + b theta' + (k + m g d) theta = -P phi'',   J = int x^2 dm, P = -int x y dm, air included;
// after the transient theta is the imaginary part of P omega^2 a exp(i omega t)/(k + m g d - J omega^2 + i b
// omega).
TEST(FlappingWing, TwistsLikeAnOscillatorForSmallAmplitudes) {
  const Model model = on_a_fixed_root();
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), parameters);
  FreeDynamics<double> dynamics(mechanism);
  ASSERT_EQ(model.coordinates.size(), 3U);  // flap, twist_l, twist_r
  const double m = 5e-5, S = 0.05, c = 0.018, d = 0.006, k = 6e-4, b = 1.5e-6, rho = 1.2;
  const double air = rho * M_PI * c * c / 4 * S;
  const double J = m * (c * c / 12 + d * d) + air * d * d + rho * M_PI * std::pow(c, 4) / 128 * S;
  const double P = (m + air) * d * S / 2;
  const double omega = 2 * M_PI * 32;

  const double a = 1e-7;
  State<double> s;
  s.r = {0, 0, 0}, s.r_dot = {a * omega, 0, 0};
  const auto rate = [&](double t, const std::array<double, 2>& y) {
    s.r = {a * std::sin(omega * t), y[0], 0};
    s.r_dot = {a * omega * std::cos(omega * t), y[1], 0};
    const Matrix<double> M = dynamics.mass_matrix(s);
    const std::vector<double> f = dynamics.forces(s);
    const double flap_ddot = -a * omega * omega * std::sin(omega * t);
    return std::array<double, 2>{y[1], (f[1] - M(1, 0) * flap_ddot) / M(1, 1)};
  };
  const double stiffness = k + m * 9.81 * d;  // the wing hangs from its axis
  const std::complex<double> response =
      P * omega * omega * a / std::complex<double>(stiffness - J * omega * omega, b * omega);
  // Transients decay like exp(-b t/(2 J)): to 1e-6 at `start`. Steps of a 400th of a period are a 100th of
  // the free period; their error is some 1e-8.
  std::array<double, 2> y{};
  const double h = 2 * M_PI / omega / 400;
  double worst = 0;
  const double start = 6 * 2 * J / b * std::log(10.0);
  double t = 0;
  for (int n = 0; t < start + 2 * M_PI / omega; ++n, t = n * h) {
    if (t > start) {
      const double want = (response * std::exp(std::complex<double>(0, omega * t))).imag();
      worst = std::max(worst, std::abs(y[0] - want) / std::abs(response));
    }
    const auto ahead = [&](const std::array<double, 2>& slope, double by) {
      return std::array<double, 2>{y[0] + by * slope[0], y[1] + by * slope[1]};
    };
    const auto k1 = rate(t, y), k2 = rate(t + h / 2, ahead(k1, h / 2)),
               k3 = rate(t + h / 2, ahead(k2, h / 2)), k4 = rate(t + h, ahead(k3, h));
    for (std::size_t i = 0; i < 2; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }
  EXPECT_LT(worst, 1e-5);
}

}  // namespace
}  // namespace anholon::flapping_wing_test
