// SPDX-License-Identifier: GPL-2.0-or-later
//
// Tables and pictures on the pages of the flexible models:
//
//   flexible_figures rotating-beam [FOLDER]   frequencies over the speed of rotation, deflection in the
//                                             spin-up; with a folder also as
//                                             rotating_beam_frequencies.svg and rotating_beam_spin_up.svg
//   flexible_figures two-link-arm             frequencies for each number of modes, by three methods
//   flexible_figures modes [N]                operations and generation of the soft snake-board with
//                                             1..N modes a beam
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "derive/derive.hpp"
#include "emit/header.hpp"
#include "emit/write_file.hpp"
#include "mechanics/flexible_robots.hpp"
#include "simulate/svg_plot.hpp"

namespace {

using namespace anholon;
using namespace anholon::test;

double rounded(Real x) { return static_cast<double>(x); }

/// First frequency in the plane of rotation, units of sqrt(EI/(rhoA L^4)); none where the beam buckles.
double first_frequency(int modes, const std::string& deformation, double Omega) {
  const double omega = rounded(rotating(modes, deformation, static_cast<Real>(Omega))[0]);
  return omega > 0 ? omega : std::numeric_limits<double>::quiet_NaN();
}

void rotating_beam(const std::string& folder) {
  fmt::print(
      "first frequency of a beam that rotates at Omega, in its plane, units of sqrt(EI/(rhoA L^4))\n\n");
  fmt::print(
      "| Omega | stiffened, 5 modes | stiffened, 1 mode | quadratic, 1 mode | linear, 1 mode |\n"
      "| --- | --- | --- | --- | --- |\n");
  const auto text = [](double x) {
    return std::isnan(x) ? std::string("buckles") : fmt::format("{:.7f}", x);
  };
  for (const double Omega : {0.0, 2.0, 4.0, 8.0})
    fmt::print("| {:g} | {} | {} | {} | {} |\n", Omega, text(first_frequency(5, "stiffened", Omega)),
               text(first_frequency(1, "stiffened", Omega)), text(first_frequency(1, "quadratic", Omega)),
               text(first_frequency(1, "linear", Omega)));

  struct Manoeuvre {
    std::string name, deformation;
    int modes;
    double speed;
    double least_shown;  // m
  };
  const std::vector<Manoeuvre> manoeuvres = {{"4 rad/s, 1 mode", "stiffened", 1, 4, -10},
                                             {"4 rad/s, 3 modes", "stiffened", 3, 4, -10},
                                             {"6 rad/s, 3 modes", "stiffened", 3, 6, -10},
                                             {"4 rad/s, 1 mode, quadratic", "quadratic", 1, 4, -1}};
  fmt::print(
      "\ndeflection of the tip in the spin-up within 15 s, m\n\n| speed, modes | least | at t = 15 s |\n| "
      "--- | --- | --- |\n");
  std::vector<double> times;
  Panel tip{"deflection of the tip [m]", {}, true};
  for (const Manoeuvre& m : manoeuvres) {
    const auto path = spin_up(m.modes, m.deformation, m.speed);
    double least = 0;
    Curve curve{m.name, {}};
    times.clear();
    bool gone = false;
    for (std::size_t i = 0; i < path.size(); ++i) {
      least = std::min(least, path[i].second);
      gone = gone || path[i].second < m.least_shown;
      if (i % 10 != 0) continue;
      times.push_back(path[i].first);
      curve.values.push_back(gone ? std::numeric_limits<double>::quiet_NaN() : path[i].second);
    }
    fmt::print("| {} | {:.4f} | {:.4g} |\n", m.name, least, path.back().second);
    tip.curves.push_back(std::move(curve));
  }
  if (folder.empty()) return;

  std::vector<double> speeds;
  for (int i = 0; i <= 100; ++i) speeds.push_back(0.1 * i);
  Panel frequencies{"first frequency in the plane", {}, true};
  for (const auto& [name, deformation, modes] :
       {std::tuple{"stiffened, 5 modes", "stiffened", 5}, std::tuple{"stiffened, 1 mode", "stiffened", 1},
        std::tuple{"quadratic, 1 mode", "quadratic", 1}, std::tuple{"linear, 1 mode", "linear", 1}}) {
    Curve curve{name, {}};
    for (const double Omega : speeds) curve.values.push_back(first_frequency(modes, deformation, Omega));
    frequencies.curves.push_back(std::move(curve));
  }
  const std::filesystem::path to = folder;
  write_file(to / "rotating_beam_frequencies.svg",
             svg_plot("Rotating beam, units of sqrt(EI/(rhoA L^4))", "Omega", speeds, {frequencies}));
  write_file(to / "rotating_beam_spin_up.svg", svg_plot("Spin-up within 15 s", "t [s]", times, {tip}));
}

void two_link_arm() {
  fmt::print(
      "frequencies of the two-link arm at the elbow angle q2, rad/s: model and Ritz agree to all digits "
      "shown\n\n");
  fmt::print("| modes | q2 = 0 | | q2 = 0.7 | | q2 = 2.1 | |\n| --- | --- | --- | --- | --- | --- | --- |\n");
  const auto row = [](const std::string& name, const auto& frequencies_at) {
    fmt::print("| {} |", name);
    for (const Real q2 : {0.0L, 0.7L, 2.1L}) {
      const std::vector<Real> omega = frequencies_at(q2);
      fmt::print(" {:.9f} | {} |", rounded(omega[0]),
                 omega.size() > 1 ? fmt::format("{:.7f}", rounded(omega[1])) : std::string());
    }
    fmt::print("\n");
  };
  Real largest = 0;
  for (int n = 1; n <= 8; ++n)
    row(std::to_string(n), [&](Real q2) {
      const std::vector<Real> model = arm_of_model(n, q2), ritz = arm_by_ritz(n, q2);
      for (std::size_t i = 0; i < model.size(); ++i)
        largest = std::max(largest, std::abs(model[i] / ritz[i] - 1));
      return model;
    });
  row("3, shapes with a tip",
      [](Real q2) { return arm_of_model(3, q2, "tip = { mass = 1.41, inertia = 0.24 }"); });
  row("finite elements, 40", [](Real q2) { return arm_by_finite_elements(40, q2); });
  fmt::print("\nlargest relative difference of model and Ritz: {:.1e}\n", rounded(largest));
}

void modes_of_the_snakeboard(int most) {
  fmt::print(
      "soft snake-board with n modes in each beam: operations, and processor time of the whole header, s\n\n"
      "| n | quadratic: `reduced_dynamics` | `forward_dynamics` | s | stiffened: `reduced_dynamics` | "
      "`forward_dynamics` | s |\n| --- | --- | --- | --- | --- | --- | --- |\n");
  for (int n = 1; n <= most; ++n) {
    fmt::print("| {} |", n);
    for (const char* deformation : {"quadratic", "stiffened"}) {
      const std::clock_t start = std::clock();
      const Model model = snakeboard(n, deformation);
      const auto derivation = derive(model, DeriveRequest{});
      if (emit_header(derivation->program).empty()) std::abort();
      const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      std::map<std::string, int> operations;
      for (const CandidateReport& c : derivation->candidates) {
        if (c.chosen) operations[c.function] = c.operations;
      }
      fmt::print(" {} | {} | {:.1f} |", operations["reduced_dynamics"], operations["forward_dynamics"],
                 seconds);
      std::fflush(stdout);
    }
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "", argument = argc > 2 ? argv[2] : "";
  if (what == "rotating-beam") {
    rotating_beam(argument);
  } else if (what == "two-link-arm") {
    two_link_arm();
  } else if (what == "modes") {
    modes_of_the_snakeboard(argument.empty() ? 8 : std::clamp(std::atoi(argument.c_str()), 1, 30));
  } else {
    fmt::print(stderr, "usage: flexible_figures rotating-beam [FOLDER] | two-link-arm | modes [N]\n");
    return 2;
  }
  return 0;
}
