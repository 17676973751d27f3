// SPDX-License-Identifier: GPL-2.0-or-later
//
// Rolling bodies whose motion is known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/program_values.hpp"

namespace anholon::test::rolling_test {
namespace {

const std::vector<std::string> wanted = {"kinematics", "reduced_velocities", "forward_dynamics"};

Exact decimal(const char* text) { return Exact::from_decimal(text); }

TEST(BallOnIncline, AcceleratesWithFiveSeventhsOfTheSlopesGravity) {
  const WorkingDigits digits(40);
  const ProgramValues ball("ball_on_incline", {}, wanted);
  const Values V_dot = ball("forward_dynamics", "eta_dot", {});
  const Exact expected = Exact(5) / Exact(7) * decimal("9.81") * sin(decimal("0.3"));
  EXPECT_LT(abs(V_dot[0] - expected).to_double(), 1e-30);  // 40 digits, a few operations
  EXPECT_LT(abs(V_dot[2]).to_double(), 1e-30);
}

/// A disc as it rolls, in axes that lean with it but do not spin: x ahead, y along the axle.
class Disc {
 public:
  explicit Disc(bool hoop) : program_("rolling_disc", parameters(hoop), wanted) {
    m = decimal("1.5"), R = decimal("0.4"), g = decimal("9.81");
    J_d = hoop ? decimal("0.12") : decimal("0.06");  // m R^2/2, m R^2/4
    J_a = J_d + J_d;
  }
  /// Rates of (Omega_x, Omega_z) of the leaning axes at a lean about x.
  /// @param Omega  of the disc, in the leaning axes
  [[nodiscard]] std::array<Exact, 2> rates(const Exact& lean, const std::array<Exact, 3>& Omega) const {
    const Inputs in = state(lean, Omega);
    const Values eta_dot = program_("forward_dynamics", "eta_dot", in);
    const Exact spin =
        Omega[1] - Omega[2] * sin(lean) / cos(lean);  // against the leaning axes, whose x stays level
    return {eta_dot[3] + spin * Omega[2], eta_dot[5] - spin * Omega[0]};
  }
  Exact m, R, g, J_d, J_a;

 private:
  static ParameterValues parameters(bool hoop) {
    return {{"J_d", decimal(hoop ? "0.12" : "0.06")}, {"J_a", decimal(hoop ? "0.24" : "0.12")}};
  }
  [[nodiscard]] Inputs state(const Exact& lean, const std::array<Exact, 3>& Omega) const {
    const Exact c = cos(lean), s = sin(lean);
    Inputs in = {{"R", {1, 0, 0, 0, c, -s, 0, s, c}}};
    // V = -Omega x (point of contact), which lies at -R z of the leaning axes
    in["eta"] = {R * Omega[1], -R * Omega[0], 0, Omega[0], Omega[1], Omega[2]};
    in["nu"] = program_("reduced_velocities", "nu", in);
    return in;
  }
  ProgramValues program_;
};

/// Upright rolling at the rate w obeys (J_d + m R^2) a'' = m g R a + (J_a + m R^2) w b', J_d b'' = -J_a w a'
/// in lean a and heading b; so s^2 (J_d + m R^2) = m g R - (J_a + m R^2) J_a w^2 / J_d.
class UprightRolling : public ::testing::TestWithParam<bool> {};

TEST_P(UprightRolling, HasTheEigenvaluesAndTheStabilityLimitOfTheClosedForm) {
  const WorkingDigits digits(50);
  const Disc disc(GetParam());
  const Exact h = decimal("1e-15");  // differences err by h^2 times third derivatives
  const auto slope = [&](const Exact& w, int which) {
    const auto at = [&](const Exact& x) {
      return disc.rates(which == 0 ? x : Exact(0), {which == 1 ? x : Exact(0), w, which == 2 ? x : Exact(0)});
    };
    const auto up = at(h), down = at(-h);
    return std::array<Exact, 2>{(up[0] - down[0]) / (h + h), (up[1] - down[1]) / (h + h)};
  };
  const auto square =
      [&](const Exact& w) {  // s^2 of the lean: its own stiffness and the loop through the heading
        return slope(w, 0)[0] + slope(w, 2)[0] * slope(w, 1)[1];
      };
  const Exact inertia = disc.m * disc.R * disc.R;
  for (const char* rate : {"0", "1.7", "2.859", "6", "-4"}) {
    SCOPED_TRACE(rate);
    const Exact w = decimal(rate);
    const Exact closed = (disc.m * disc.g * disc.R - (disc.J_a + inertia) * disc.J_a * w * w / disc.J_d) /
                         (disc.J_d + inertia);
    EXPECT_LT(abs(square(w) - closed).to_double(), 1e-25);
    EXPECT_LT(abs(slope(w, 1)[0]).to_double(), 1e-25);  // no damping
    EXPECT_LT(abs(slope(w, 0)[1]).to_double(), 1e-25);
  }
  const Exact limit = sqrt(disc.g / (Exact(GetParam() ? 4 : 3) * disc.R));
  EXPECT_LT(abs(square(limit)).to_double(), 1e-25);
  EXPECT_LT(square(limit * decimal("1.001")).to_double(), 0);
  EXPECT_GT(square(limit * decimal("0.999")).to_double(), 0);
}

INSTANTIATE_TEST_SUITE_P(DiscAndHoop, UprightRolling, ::testing::Bool());

/// At a constant lean a and heading rate b' the disc rolls in a circle if the moments about the point of
/// contact balance: (J_a + m R^2) W b' cos a - J_d b'^2 cos a sin a + m g R sin a = 0, W the rate about the
/// axle.
TEST(RollingDisc, TurnsSteadilyAtTheRateOfTheClosedForm) {
  const WorkingDigits digits(50);
  const Disc disc(false);
  for (const char* angle : {"0.1", "0.6", "1.2"}) {
    SCOPED_TRACE(angle);
    const Exact a = decimal(angle), turn = decimal("1.3");
    const Exact about_axle = (disc.J_d * turn * turn * cos(a) * sin(a) - disc.m * disc.g * disc.R * sin(a)) /
                             ((disc.J_a + disc.m * disc.R * disc.R) * turn * cos(a));
    const auto rates = disc.rates(a, {0, about_axle, turn * cos(a)});
    EXPECT_LT(abs(rates[0]).to_double(), 1e-40);
    EXPECT_LT(abs(rates[1]).to_double(), 1e-40);
  }
}

}  // namespace
}  // namespace anholon::test::rolling_test
