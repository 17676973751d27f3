// SPDX-License-Identifier: GPL-2.0-or-later
//
// Shipped models against equations of motion that do not come from the reduction: the momentum equation of a
// nonholonomic system, the pole of an inverted pendulum, Newton's law for a whole car.
#include <gtest/gtest.h>

#include "contact/newtons_law.hpp"
#include "contact/program_values.hpp"
#include "describe/mechanise.hpp"
#include "reduce/samples.hpp"

namespace anholon::test::dynamics_test {
namespace {

Exact number(const char* text) { return Exact::from_decimal(text); }

// T = (M x'^2 + I theta'^2)/2 + m l x' theta' cos(theta), V = m g l cos(theta), wheels let go: the upright
// body falls as exp(lambda t) with lambda^2 = m g l M/(I M - (m l)^2), where M carries the wheels' spin.
TEST(TwoWheeledPendulum, FallsWithThePoleOfTheTextbook) {
  const WorkingDigits digits(60);
  const ProgramValues robot("two_wheeled_pendulum", {}, {"torque_driven_dynamics", "kinematics"});
  EXPECT_EQ(robot.derivation().reduction.ranks.m_locked, 5);  // both wheels say the same about side slip
  const Exact m = 20, l = number("0.4"), R = number("0.15"), g = number("9.81");
  const Exact M = m + Exact(2) * (number("1.5") + number("0.017") / (R * R));
  const Exact I = m * l * l + number("1.1");
  const Exact square = m * g * l * M / (I * M - m * m * l * l);
  const Inputs upright = {{"p", {Exact(0), Exact(0), R}}};
  const Inputs tilt = {{"R", {0, 0, 1, 0, 0, 0, -1, 0, 0}}};  // derivative of a turn about y
  const Values a = robot.derivative("torque_driven_dynamics", "eta_dot", upright, tilt);
  EXPECT_LT(abs(a[4] - square).to_double(), 1e-30);  // Omega_Y_dot; 60 digits are carried
  EXPECT_GT(square.to_double(), 1);
}

/// Momentum of the Roller Racer along its admissible direction, from a kinetic energy written by hand.
struct RollerRacer {
  const Exact d_1 = number("0.5"), d_2 = number("0.12"), m_1 = 8, J_1 = number("0.5"), m_2 = number("0.6"),
              J_2 = number("0.02");
  /// Gradient of the kinetic energy by (V_X, V_Y, Omega).
  [[nodiscard]] Values momentum(const Values& xi, const Exact& s, const Exact& rate) const {
    const Exact x = d_1 - d_2 * cos(s), y = -d_2 * sin(s);  // of the handlebar's mass centre
    const Exact u = xi[0] - xi[2] * y + d_2 * sin(s) * rate, v = xi[1] + xi[2] * x - d_2 * cos(s) * rate;
    return {m_1 * xi[0] + m_2 * u, m_1 * xi[1] + m_2 * v,
            J_1 * xi[2] + J_2 * (xi[2] + rate) + m_2 * (x * v - y * u)};
  }
  /// Neither axle slips, the joint at rest.
  [[nodiscard]] Values direction(const Exact& s) const { return {d_1 * cos(s) - d_2, 0, sin(s)}; }
};

Exact pairing(const Values& a, const Values& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// d/dt <dl/dxi, xi_q> = <dl/dxi, d xi_q/dt + [xi, xi_q]> (Bloch, Krishnaprasad, Marsden and Murray, 1996).
TEST(RollerRacer, ObeysTheNonholonomicMomentumEquation) {
  const WorkingDigits digits(60);
  const ProgramValues model("roller_racer", {}, {"kinematics", "forward_dynamics"});
  const RollerRacer racer;
  SampleSource source(7);
  for (int sample = 0; sample < 5; ++sample) {
    const auto draw = [&] { return source.uniform(Exact(-1), Exact(1)); };
    const Exact s = draw(), rate = draw(), acceleration = draw(), h = number("1e-20");
    const Inputs in = {{"r_a", {s}},
                       {"r_a_dot", {rate}},
                       {"r_a_ddot", {acceleration}},
                       {"nu", {draw()}},
                       {"g", {draw(), draw(), draw()}}};
    const Values xi = model("kinematics", "eta", in), xi_dot = model("forward_dynamics", "eta_dot", in);
    const auto p = [&](const Exact& step) {
      Values moved = xi;
      for (std::size_t i = 0; i < 3; ++i) moved[i] = xi[i] + step * xi_dot[i];
      const Exact there = s + step * rate;
      return pairing(racer.momentum(moved, there, rate + step * acceleration), racer.direction(there));
    };
    const Values q = racer.direction(s), ahead = racer.direction(s + h), behind = racer.direction(s - h);
    Values sum;
    for (std::size_t i = 0; i < 3; ++i) sum.push_back(rate * (ahead[i] - behind[i]) / (h + h));
    sum[0] = sum[0] + xi[1] * q[2] - xi[2] * q[1];  // bracket of se(2): translations turn, rotations commute
    sum[1] = sum[1] + xi[2] * q[0] - xi[0] * q[2];
    const Exact left = (p(h) - p(-h)) / (h + h), right = pairing(racer.momentum(xi, s, rate), sum);
    EXPECT_LT(abs(left - right).to_double(), 1e-30);  // differences with h = 1e-20 leave h^2
    EXPECT_GT(abs(left).to_double(), 1e-3);
  }
}

// Contact forces at any share of the load: their sum is the rate of momentum less the weight.
TEST(AckermannCar, ContactForcesObeyNewtonsLawForTheWholeCar) {
  const WorkingDigits digits(60);
  const ProgramValues car("ackermann_car", {}, {"kinematics", "forward_dynamics", "multipliers"});
  const Model& model = car.model();
  std::vector<Exact> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value);
  const Mechanism<Exact> mechanism = mechanise<Exact>(describe_mechanism(model), parameters);
  SampleSource source(11);
  for (int sample = 0; sample < 3; ++sample) {
    const auto draw = [&] { return source.uniform(Exact(-1), Exact(1)); };
    const Exact steer = draw() / Exact(2), rate = draw(), acceleration = draw();
    Inputs in = {{"r_a", {steer}},
                 {"r_a_dot", {rate}},
                 {"r_a_ddot", {acceleration}},
                 {"r_p", {draw(), draw(), draw(), draw()}},
                 {"nu", {Exact(10) * draw()}}};
    in["nu_dot"] = car("forward_dynamics", "nu_dot", in);
    in["lambda_stat"] = {Exact(100) * draw(), Exact(100) * draw(), Exact(100) * draw()};
    const Values eta = car("kinematics", "eta", in), spin = car("kinematics", "r_p_dot", in);
    const Values eta_dot = car("forward_dynamics", "eta_dot", in),
                 spin_dot = car("forward_dynamics", "r_p_ddot", in);
    const Values lambda = car("multipliers", "lambda", in);
    State<Exact> state;
    state.R = Mat3<Exact>::identity();
    for (int c = 0; c < 6; ++c) state.eta[c] = eta[static_cast<std::size_t>(c)];
    state.r = {steer}, state.r_dot = {rate};
    state.r.insert(state.r.end(), in["r_p"].begin(), in["r_p"].end());
    state.r_dot.insert(state.r_dot.end(), spin.begin(), spin.end());
    Values all = eta_dot;
    all.push_back(acceleration);
    all.insert(all.end(), spin_dot.begin(), spin_dot.end());
    const Vec3<Exact> rest =
        unbalanced_force(model, mechanism, state, all, lambda, [](const std::string& contact) {
          return std::size_t(contact == "front_left" ? 2 : contact == "front_right" ? 3 : 0);
        });
    for (int i = 0; i < 3; ++i)  // of a weight of 12 kN
      EXPECT_LT(abs(rest[i]).to_double(), 1e-12);
  }
}

}  // namespace
}  // namespace anholon::test::dynamics_test
