// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Programs built by hand on a tape, for the tests of emission.

#include <functional>
#include <string>
#include <vector>

#include "tape/expr.hpp"
#include "tape/interface.hpp"

namespace anholon::test {

/// Cart (x) with a pendulum (theta, 0 is down) under a force F. Inertia about the pivot m_p l^2.
/// @param swapped  makes the operands of sums and products in the other order, as another compiler would
inline Program cart_pendulum(bool swapped = false) {
  Program program;
  program.name_space = "cart_pendulum::standard";
  program.model = "cart_pendulum";
  program.scene = "standard";
  program.source_file = "cart_pendulum.toml";
  program.source_sha256 = std::string(64, 'a');
  program.notes = {"class: dynamic, m = 0", "state: r = (x, theta)"};
  Tape& tape = program.tape;
  const auto input = [&](const std::string& name) { return Expr(tape, tape.input(name)); };
  const auto parameter = [&](const std::string& name, const Exact& value, const std::string& unit,
                             const std::string& meaning) {
    const Expr x = input(name);
    program.parameters.push_back({name, unit, meaning, value, x.id(tape)});
    return x;
  };
  const Expr m_c = parameter("m_c", Exact::from_decimal("1"), "kg", "mass of the cart");
  const Expr m_p = parameter("m_p", Exact::from_decimal("0.1"), "kg", "mass of the bob");
  const Expr l = parameter("l", Exact::from_decimal("0.5"), "m", "pivot to bob");
  const Expr g = parameter("g", Exact::from_decimal("9.81"), "m/s^2", "gravity");
  const Expr unused =
      parameter("double", Exact::from_decimal("-3.25e-7"), "", "a keyword as a name; nobody reads it");
  const Expr x = input("x");
  const Expr theta = input("theta");
  const Expr x_dot = input("x_dot");
  const Expr theta_dot = input("theta_dot");
  const Expr F = input("F");
  (void)unused;
  program.inputs = {{"r", "m, rad", "x, theta", 2, 1, {x.id(tape), theta.id(tape)}},
                    {"r_dot", "m/s, rad/s", "their rates", 2, 1, {x_dot.id(tape), theta_dot.id(tape)}},
                    {"F", "N", "force on the cart", 1, 1, {F.id(tape)}}};

  const auto first = [&](const std::function<Expr()>& a, const std::function<Expr()>& b) {  // a + b
    if (!swapped) {
      const Expr u = a();
      const Expr v = b();
      return u + v;
    }
    const Expr v = b();
    const Expr u = a();
    return v + u;
  };

  tape.section("mass matrix");
  const Expr M_00 = first([&] { return m_c; }, [&] { return m_p; });
  const Expr M_01 = m_p * l * cos(theta);
  const Expr M_11 = m_p * l * l;
  tape.section("forces");
  const Expr f_0 = first([&] { return F; }, [&] { return m_p * l * theta_dot * theta_dot * sin(theta); });
  const Expr f_1 = -(m_p * g * l * sin(theta));
  tape.section("forward dynamics");
  const Expr determinant = first([&] { return M_00 * M_11; }, [&] { return -(M_01 * M_01); });
  const Expr x_ddot = first([&] { return M_11 * f_0; }, [&] { return -(M_01 * f_1); }) / determinant;
  const Expr theta_ddot = first([&] { return M_00 * f_1; }, [&] { return -(M_01 * f_0); }) / determinant;
  tape.section("energy");
  const Expr energy = first([&] { return M_00 * x_dot * x_dot / 2 + M_01 * x_dot * theta_dot; },
                            [&] { return M_11 * theta_dot * theta_dot / 2 - m_p * g * l * cos(theta); });

  const auto ids = [&](const std::vector<Expr>& entries) {
    std::vector<NodeId> result;
    for (const Expr& e : entries) result.push_back(e.id(tape));
    return result;
  };
  program.functions = {
      {"mass_matrix",
       "Inertia matrix M(r): kinetic energy T = 1/2 r_dot' M r_dot.",
       {{"M", "kg, kg m, kg m^2", "symmetric, every entry written", 2, 2, ids({M_00, M_01, M_01, M_11})}},
       ""},
      {"forward_dynamics",
       "Accelerations M(r) r_ddot = f(r, r_dot) + (F, 0).",
       {{"r_ddot", "m/s^2, rad/s^2", "", 2, 1, ids({x_ddot, theta_ddot})},
        {"lambda", "N", "no constraint", 0, 1, {}}},
       "M is regular everywhere while m_c > 0."},
      {"energies",
       "Kinetic plus potential energy.",
       {{"E", "J", "0 with theta = pi/2 at rest", 1, 1, ids({energy})}},
       ""}};
  return program;
}

/// Each operation of the table once, a sign, a constant output, an input passed through and awkward names.
inline Program every_operation() {
  Program program;
  program.name_space = "every_operation";
  program.model = "every_operation";
  Tape& tape = program.tape;
  const Expr a(tape, tape.input("a b"));
  const Expr b(tape, tape.input("namespace"));
  const Expr p(tape, tape.input("M_PI"));
  program.parameters = {{"M_PI", "", "a macro as a name \\", Exact::ratio(1, 3), p.id(tape)}};
  program.inputs = {{"class", "", "one\nline \\", 2, 1, {a.id(tape), b.id(tape)}}};
  const Expr third = Expr(1) / Expr(3);
  const std::vector<Expr> results = {a + b,
                                     a - b,
                                     a * b,
                                     a / (b + 3),
                                     -a,
                                     sqrt(a),
                                     sin(a),
                                     cos(b),
                                     tan(a),
                                     asin(a * third),
                                     acos(b / 5),
                                     atan2(a, b),
                                     exp(a),
                                     log(b),
                                     tanh(a),
                                     abs(a - b),
                                     sign(a - b),
                                     a,
                                     Expr(7) / 4,
                                     p * third,
                                     sqrt(p),
                                     a + (Expr(-3) / 7),
                                     sin(2 * a + p),
                                     sum_error(a, b),
                                     product_error(a, p),
                                     quotient_error(b, a),
                                     product_error(p, p),
                                     p,
                                     p + a};
  OutputBlock out{"class", "", "each operation", static_cast<int>(results.size()), 1, {}};
  for (const Expr& e : results) out.nodes.push_back(e.id(tape));
  program.functions = {{"sin", "Named like a function of <cmath>.", {out}, ""}};
  return program;
}

}  // namespace anholon::test
