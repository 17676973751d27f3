// SPDX-License-Identifier: GPL-2.0-or-later
//
// Contacts that begin: plastic impacts in closed form, what is lost, what motors add, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulate/simulation.hpp"
#include "simulate/written_scene.hpp"

namespace anholon::contact_switch_test {
namespace {

using testing::two_bodies;
using testing::written_scene;

/// Value of a column at the last row not later than t, or behind a switch at t.
double value(const SimulationResult& result, const std::string& column, double t, bool after) {
  const auto at =
      std::ranges::find_if(result.columns, [&](const std::string& c) { return c.starts_with(column); });
  EXPECT_NE(at, result.columns.end()) << column;
  double found = NAN;
  for (const auto& row : result.rows) {
    if (row[0] > t + 1e-12) break;
    if (row[0] < t - 1e-12 || after || !std::isfinite(found))
      found = row[static_cast<std::size_t>(at - result.columns.begin())];
  }
  return found;
}

constexpr double rounding = 1e-13;  // relative to numbers of order one; the integrator adds 1e-12 at most

// Two masses on a line meet at 4 and -1 m/s and stay together.
TEST(ContactSwitch, TwoBodiesThatLatchKeepTheirMomentumAndLoseHalfDvMDv) {
  const SimulationResult result = simulate_scene(written_scene(two_bodies, R"(
duration = 1
output_step = 0.25
integrator = { method = "dopri5", tolerance = 1e-12 }
contact_sets = { open = [], latched = ["latch"] }
phase = [{ contacts = "open" }, { start = 0.5, contacts = "latched" }]
initial = { coordinates = { r1 = 2.5 }, velocities = { V_X = 4, r1 = -5 } }
)"));
  ASSERT_TRUE(result.finished) << result.status;
  const double v = (2 * 4.0 + 3 * -1.0) / 5, lost = 0.5 * (2 * 3 / 5.0) * 25;  // reduced mass
  EXPECT_NEAR(value(result, "V_X", 0.25, true), 4, 10 * rounding);
  EXPECT_NEAR(value(result, "V_X", 0.5, true), v, 10 * rounding);
  EXPECT_NEAR(value(result, "dot(r1)", 0.5, true), 0, 10 * rounding);
  EXPECT_NEAR(value(result, "V_X", 1, true), v, 10 * rounding);
  EXPECT_NEAR(value(result, "r1", 1, true), 0, 1e-11);  // 2.5 m at 5 m/s; tolerance of the integration
  ASSERT_EQ(result.switches.size(), 1U);
  const ContactSwitch& at = result.switches[0];
  EXPECT_EQ(at.from, "open");
  EXPECT_EQ(at.to, "latched");
  EXPECT_NEAR(at.lost, lost, 100 * rounding);
  EXPECT_NEAR(at.work, 0, rounding);
  const double dv_1 = v - 4, dv_2 = v + 1;
  EXPECT_NEAR(at.lost, 0.5 * (2 * dv_1 * dv_1 + 3 * dv_2 * dv_2), 100 * rounding);
  ASSERT_EQ(at.impulses.size(), 1U);
  EXPECT_NEAR(at.impulses[0].second, 3 * dv_2, 100 * rounding);  // on the second body, along r1
  EXPECT_LT(result.energy_balance, 1e-12);                       // what is lost is counted as dissipated
}

// The same line, but the second body moves as a motor wills: it keeps its motion relative to the first one
// when that is stopped, and the motor pays.
TEST(ContactSwitch, MotorsKeepTheirMotionAndTheirImpulsesWork) {
  const std::string stop = two_bodies.substr(0, two_bodies.find("[[constraint]]")) +
                           "[[constraint]]\nname = \"stop\"\nrow = \"V_X\"\n";
  const SimulationResult result = simulate_scene(written_scene(stop, R"(
duration = 1
output_step = 0.5
integrator = { method = "dopri5", tolerance = 1e-12 }
drive = { r1 = "motion" }
motion = { r1 = "2*t" }
contact_sets = { open = [], stopped = ["stop"] }
phase = [{ contacts = "open" }, { start = 0.5, contacts = "stopped" }]
initial = { velocities = { V_X = 4 } }
)"));
  ASSERT_TRUE(result.finished) << result.status;
  ASSERT_EQ(result.switches.size(), 1U);
  EXPECT_NEAR(value(result, "V_X", 0.5, true), 0, rounding);
  EXPECT_NEAR(value(result, "dot(r1)", 0.5, true), 2, rounding);
  EXPECT_NEAR(result.switches[0].lost, 0.5 * 5 * 16, 1000 * rounding);
  EXPECT_NEAR(result.switches[0].work, 3 * -4.0 * 2, 1000 * rounding);  // impulse 3 (2 - 6) Ns, at 2 m/s
  EXPECT_LT(result.energy_balance, 1e-12);
}

// A rod that flies and spins is caught at its end: angular momentum about the end stays.
TEST(ContactSwitch, RodThatIsCaughtAtItsEndKeepsItsAngularMomentumAboutIt) {
  const std::string rod = R"(anholon = 1
name = "rod"
group = "SE2"
[[body]]
name = "rod"
inertia = { mass = 1.5, about_com = { zz = 0.08 } }
[[constraint]]
name = "pin"
kind = "point"
body = "rod"
point = [0.4, 0, 0]
)";
  const std::string motion = R"(
duration = 1
output_step = 0.5
integrator = { method = "dopri5", tolerance = 1e-12 }
contact_sets = { free = [], pinned = ["pin"] }
phase = [{ contacts = "free" }, { start = 0.5, contacts = "pinned" }]
initial = { velocities = { V_X = 0.3, V_Y = 1.1, Omega_Z = 0.9 } }
)";
  const SimulationResult result = simulate_scene(written_scene(rod, motion));
  ASSERT_TRUE(result.finished) << result.status;
  const double v_y = 1.1 * std::cos(0.45) - 0.3 * std::sin(0.45);  // body axes turn by 0.45 rad on the way
  const double turn = (0.08 * 0.9 - 1.5 * 0.4 * v_y) / (0.08 + 1.5 * 0.16);
  EXPECT_NEAR(value(result, "Omega_Z", 0.5, true), turn, 1e-11);
  EXPECT_NEAR(value(result, "V_Y", 0.5, true), -0.4 * turn, 1e-11);
  EXPECT_LT(result.energy_balance, 1e-12);
  EXPECT_LT(result.position_residual, 1e-13);

  try {
    simulate_scene(written_scene(rod, motion + "continuous = 1e-6\n"));
    FAIL() << "the jump was accepted";
  } catch (const ModelError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("scene.toml:9:"), std::string::npos) << text;
    EXPECT_NE(text.find("at t = 0.5 s the velocities jump by 0."), std::string::npos) << text;
    EXPECT_NE(text.find("the scene allows 1e-06; make the motion arrive"), std::string::npos) << text;
  }
}

// Letting go changes no velocity.
TEST(ContactSwitch, ContactsThatEndLeaveTheVelocitiesAlone) {
  const SimulationResult result = simulate_scene(written_scene(two_bodies, R"(
duration = 1
integrator = { method = "dopri5", tolerance = 1e-12 }
contact_sets = { open = [], latched = ["latch"] }
continuous = 1e-12
phase = [{ contacts = "latched" }, { start = 0.5, contacts = "open" }]
initial = { velocities = { V_X = 4 } }
)"));
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_EQ(result.switches[0].lost, 0);
  EXPECT_NEAR(value(result, "V_X", 1, true), 4, 10 * rounding);
}

// A wheel that is off the ground cannot be put on it by words.
TEST(ContactSwitch, RefusesAContactThatIsNotThere) {
  const std::string ball = R"(anholon = 1
name = "ball"
group = "SE3"
[[body]]
name = "ball"
inertia = { mass = 1, about_com = { xx = 0.1, yy = 0.1, zz = 0.1 } }
[[constraint]]
name = "ground"
kind = "ellipsoid"
body = "ball"
semi_axes = [0.2, 0.2, 0.2]
)";
  try {
    simulate_scene(written_scene(ball, R"(
duration = 1
contact_sets = { free = [], down = ["ground"] }
phase = [{ contacts = "free" }, { start = 0.5, contacts = "down" }]
initial = { pose = { translation = [0, 0, 1.2] }, velocities = { V_Z = -1 } }
)"));
    FAIL() << "the contact was accepted";
  } catch (const ModelError& error) {
    EXPECT_NE(
        std::string(error.what()).find("at t = 0.5 s a contact of 'down' closes 0.5 m from where it holds"),
        std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace anholon::contact_switch_test
