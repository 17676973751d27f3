// SPDX-License-Identifier: GPL-2.0-or-later
//
// Known motions of flexible robots: frequencies of clamped and rotating beams, the spin-up manoeuvre, an arm
// whose flexible link carries another one, chains of links that stand for a beam.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "describe/beam.hpp"
#include "describe/read_model.hpp"
#include "mechanics/flexible_robots.hpp"

namespace anholon::flexible_models_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

// ---- clamped and rotating beams

TEST(ClampedBeam, HasItsFrequenciesTo14Digits) {
  const std::array<const char*, 3> known = {"3.516015268500151", "22.034491564666766", "61.69721441354909"};
  for (int i = 1; i <= 3; ++i) {
    const Exact b = clamped_mode(i).b;
    const Exact omega = b * b;
    EXPECT_LT(abs(omega / Exact::from_decimal(known[static_cast<std::size_t>(i - 1)]) - Exact(1)),
              Exact::from_decimal("2e-16"));  // the figures have 16 digits
  }
}

TEST(RotatingBeam, WithOneModeStiffensBySquares) {
  const Real omega = 3.516015268500151L;
  for (const Real Omega : {0.5L, 2.0L, 10.0L}) {
    const Real stiffened = rotating(1, "stiffened", Omega)[0];
    EXPECT_NEAR(static_cast<double>(stiffened * stiffened - omega * omega - 0.193336374L * Omega * Omega), 0,
                1e-9 * static_cast<double>(omega * omega + Omega * Omega))
        << "Omega " << static_cast<double>(Omega);
    const Real quadratic = rotating(1, "quadratic", Omega)[0];
    EXPECT_NEAR(static_cast<double>(quadratic * std::abs(quadratic)),
                static_cast<double>(omega * omega - Omega * Omega), 1e-13 * 112);  // omega has 16 digits
    EXPECT_NEAR(static_cast<double>(rotating(1, "linear", Omega)[0]), static_cast<double>(omega), 1e-14);
  }
}

TEST(RotatingBeam, WithFiveModesHasTheFrequenciesOfTheLiterature) {
  EXPECT_NEAR(static_cast<double>(rotating(5, "stiffened", 2)[0]), 3.6218034, 1e-6);
  EXPECT_NEAR(static_cast<double>(rotating(5, "stiffened", 4)[0]), 3.8978372, 1e-6);
  EXPECT_NEAR(static_cast<double>(rotating(5, "stiffened", 8)[0]), 4.6594719, 1e-6);
}

TEST(RotatingBeam, LagsInTheSpinUpAsKaneAndWuHaugFound) {
  const auto lowest = [](const std::vector<std::pair<double, double>>& path) {
    return std::ranges::min_element(path, {}, &std::pair<double, double>::second)->second;
  };
  EXPECT_NEAR(lowest(spin_up(1, "stiffened", 4)), -0.5379, 5e-5);  // the figures have four digits
  EXPECT_NEAR(lowest(spin_up(3, "stiffened", 4)), -0.5345, 5e-5);
  const auto fast = spin_up(3, "stiffened", 6);  // twice the first natural frequency: still bounded
  EXPECT_GT(lowest(fast), -1.0);
  EXPECT_LT(std::abs(fast.back().second), 0.1);
  EXPECT_LT(lowest(spin_up(1, "quadratic", 4)),
            -8.0);  // longer than the beam itself: the linear field runs away
}

// ---- an arm whose flexible link carries another

TEST(TwoLinkFlexibleArm, HasTheFrequenciesOfRitzThatFallTowardsThoseOfFiniteElements) {
  for (const Real q2 : {0.0L, 0.7L, 2.1L}) {
    const std::vector<Real> limit = arm_by_finite_elements(40, q2);  // first one within 1e-8 of the limit
    Real before[2] = {1e9L, 1e9L}, with_four = 0;
    for (int n = 1; n <= 8; ++n) {
      const std::vector<Real> have = arm_of_model(n, q2), want = arm_by_ritz(n, q2);
      for (std::size_t i = 0; i < have.size(); ++i)
        EXPECT_NEAR(static_cast<double>(have[i] / want[i]), 1, 1e-9) << n << " modes, frequency " << i + 1;
      for (std::size_t i = 0; i < std::min<std::size_t>(2, have.size()); ++i) {
        EXPECT_LT(have[i], before[i]) << n << " modes";
        EXPECT_GT(have[i], limit[i] * (1 - 1e-7L)) << n << " modes";
        before[i] = have[i];
      }
      if (n == 4) with_four = have[0] / limit[0] - 1;
    }
    // Free ends have no moment and no shear, a loaded tip has both: the error falls like 1/n only.
    EXPECT_LT(before[0] / limit[0] - 1, 0.6L * with_four);
    // Shapes of a beam with a body at its end do better; the ratios are those of elbow and forearm at q2 = 0.
    const std::vector<Real> loaded = arm_of_model(3, q2, "tip = { mass = 1.41, inertia = 0.24 }");
    EXPECT_LT(loaded[0] / limit[0] - 1, 1e-6L);  // eight free-ended modes are a thousand times farther away
    EXPECT_GT(loaded[0], limit[0] * (1 - 1e-7L));
  }
}

// ---- chains of links

// Springs EI n/L in the middles of n segments: each halving of the segments divides the error of the
// frequencies by four, of the cantilever and with a body at the tip that hangs on the chain.
TEST(Chain, HasTheFrequenciesOfTheBeamWithOrderTwo) {
  const auto chain = [](int n, const std::string& load) {
    return read_model_text(
        fmt::format(
            "anholon = 1\nname = \"chain\"\ngroup = \"fixed\"\n[[body]]\nname = \"ground\"\n[[body]]\nname = "
            "\"beam\"\nparent = \"ground\"\njoint = {{ kind = \"fixed\" }}\n[body.chain]\nlength = 1\n"
            "mass_per_length = 1\nbending_stiffness = 1\nsegments = {}\n{}",
            n, load),
        "chain.toml");
  };
  // A body of mu = 0.5 and kappa = 0.1 at the tip: modes of the beam with that tip have b^2 as frequencies.
  const std::string load =
      "[[body]]\nname = \"load\"\nparent = \"beam\"\njoint = { kind = \"fixed\" }\n"
      "inertia = { mass = 0.5, about_com = { zz = 0.1 } }\n";
  for (const bool loaded : {false, true}) {
    for (int mode = 1; mode <= 3; ++mode) {
      const Exact b =
          (loaded ? clamped_mode(mode, Exact::ratio(1, 2), Exact::ratio(1, 10)) : clamped_mode(mode)).b;
      const Real omega = std::strtold((b * b).decimal(25).c_str(), nullptr);
      Real before = 0;
      for (const int n : {8, 16, 32, 64}) {
        const std::vector<Real> rest(static_cast<std::size_t>(n), 0);
        const Real error =
            small_motion(chain(n, loaded ? load : ""), rest, rest)[static_cast<std::size_t>(mode - 1)] /
                omega -
            1;
        if (before != 0 && n > 16) {  // the next term of the expansion, relative: a few (mode/n)^2
          EXPECT_NEAR(static_cast<double>(before / error), 4, 0.3) << loaded << " mode " << mode << ", " << n;
        }
        before = error;
      }
      EXPECT_LT(std::abs(before), 3e-3L) << loaded << " mode " << mode;
    }
  }
}

}  // namespace
}  // namespace anholon::flexible_models_test
