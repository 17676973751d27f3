// SPDX-License-Identifier: GPL-2.0-or-later
#include "mechanics/flexible_robots.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "mechanics/beam_shapes.hpp"

namespace anholon::test {
namespace {

using Column = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// Mass and stiffness of the coordinates that are not driven, at rest relative to the motion of the driven
/// ones: the forces of what is shipped are linear in the modes, so that differences give the stiffness
/// exactly.
struct SmallMotion {
  Square M, K;
};
SmallMotion matrices_of_small_motion(const Model& model, const std::vector<Real>& r,
                                     const std::vector<Real>& r_dot) {
  std::vector<Real> parameters;
  for (const Parameter& p : model.parameters)
    parameters.push_back(std::strtold(p.value.decimal(30).c_str(), nullptr));
  const Mechanism<Real> mechanism = mechanise<Real>(describe_mechanism(model), parameters);
  FreeDynamics<Real> dynamics(mechanism);
  State<Real> state;
  state.r = r, state.r_dot = r_dot;
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    if (model.coordinates[i].drive == Drive::passive) free.push_back(i);
  }
  const Matrix<Real> M = dynamics.mass_matrix(state);
  const std::vector<Real> rest = dynamics.forces(state);
  const auto n = static_cast<Eigen::Index>(free.size());
  SmallMotion small{Square(n, n), Square(n, n)};
  for (Eigen::Index j = 0; j < n; ++j) {
    State<Real> moved = state;
    const Real step = 0.5L;  // a power of two: no rounding
    moved.r[free[static_cast<std::size_t>(j)]] += step;
    const std::vector<Real> force = dynamics.forces(moved);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t row = free[static_cast<std::size_t>(i)];
      small.K(i, j) = (rest[row] - force[row]) / step;
      small.M(i, j) = M(static_cast<int>(row), static_cast<int>(free[static_cast<std::size_t>(j)]));
    }
  }
  return small;
}

struct Arm {
  Real L = 0.9L, rhoA = 0.55L, EI = 16, m_e = 0.3L, J_e = 0.0008L, m = 0.4L, c = 0.42L, J = 0.025L;
};

/// Adds the kinetic energy of elbow and forearm for a tip that deflects by `v` and turns by `turn` per
/// coordinate.
void add_tip(Square& M, const Arm& arm, Real q2, const Column& v, const Column& turn) {
  M += arm.m_e * v * v.transpose() + (arm.J_e + arm.J) * turn * turn.transpose();
  const Column x = -arm.c * std::sin(q2) * turn;  // of the forearm's mass centre
  const Column y = v + arm.c * std::cos(q2) * turn;
  M += arm.m * (x * x.transpose() + y * y.transpose());
}

}  // namespace

std::vector<Real> frequencies(const Square& K, const Square& M) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Square> solver(K, M, Eigen::EigenvaluesOnly);
  std::vector<Real> omega;
  for (const Real square : solver.eigenvalues())
    omega.push_back(square < 0 ? -std::sqrt(-square) : std::sqrt(square));
  return omega;
}

Model model_with(const std::string& name, const std::vector<std::pair<std::string, std::string>>& changes) {
  std::ostringstream text;
  text << std::ifstream(fmt::format("{}/models/{}/{}.toml", ANHOLON_SOURCE_DIR, name, name)).rdbuf();
  std::string changed = text.str();
  for (const auto& [from, to] : changes) {
    const std::size_t at = changed.find(from);
    if (at == std::string::npos) throw std::invalid_argument(fmt::format("{} has no '{}'", name, from));
    changed.replace(at, from.size(), to);
  }
  return read_model_text(changed, name + ".toml");
}

std::string modes(int n, const std::string& prefix) {
  std::string names;
  for (int i = 1; i <= n; ++i) names += fmt::format("{}\"{}{}\"", i == 1 ? "" : ", ", prefix, i);
  return fmt::format("modes = {}\ncoordinates = [{}]", n, names);
}

std::vector<Real> small_motion(const Model& model, const std::vector<Real>& r,
                               const std::vector<Real>& r_dot) {
  const SmallMotion small = matrices_of_small_motion(model, r, r_dot);
  return frequencies(small.K, small.M);
}

std::vector<Real> rotating(int n, const std::string& deformation, Real Omega) {
  const std::string text = fmt::format(
      "anholon = 1\nname = \"unit\"\ngroup = \"fixed\"\n[[body]]\nname = \"ground\"\n[[body]]\nname = "
      "\"beam\"\n"
      "parent = \"ground\"\njoint = {{ kind = \"revolute\", axis = [0, 0, 1], coordinate = \"a\", drive = "
      "\"active\" }}\n"
      "[body.beam]\nlength = 1\nmass_per_length = 1\nbending_stiffness = 1\nmodes = {}\ndeformation = "
      "\"{}\"\n",
      n, deformation);
  const Model model = read_model_text(text, "unit.toml");
  std::vector<Real> r(static_cast<std::size_t>(n) + 1, 0), r_dot = r;
  r_dot[0] = Omega;
  return small_motion(model, r, r_dot);
}

std::vector<std::pair<double, double>> spin_up(int n, const std::string& deformation, double speed) {
  const Model model =
      model_with("rotating_beam", {{"modes             = 3", ""},
                                   {"coordinates       = [\"e1\", \"e2\", \"e3\"]", modes(n, "e")},
                                   {"\"stiffened\"", "\"" + deformation + "\""}});
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), parameters);
  FreeDynamics<double> dynamics(mechanism);
  const double T = 15, w = 2 * M_PI / T;
  const auto count = static_cast<std::size_t>(n);
  const auto acceleration = [&](double t, const std::vector<double>& y) {
    State<double> s;
    s.r = {speed / T * (t * t / 2 + (std::cos(w * t) - 1) / (w * w))};
    s.r_dot = {speed / T * (t - std::sin(w * t) / w)};
    s.r.insert(s.r.end(), y.begin(), y.begin() + n);
    s.r_dot.insert(s.r_dot.end(), y.begin() + n, y.end());
    const Matrix<double> M = dynamics.mass_matrix(s);
    const std::vector<double> force = dynamics.forces(s);
    std::vector<double> rate(y.begin() + n, y.end());
    for (std::size_t i = 1; i <= count; ++i) {  // the mass matrix of the modes is diagonal
      const int k = static_cast<int>(i);
      rate.push_back((force[i] - M(k, 0) * speed / T * (1 - std::cos(w * t))) / M(k, k));
    }
    return rate;
  };
  std::vector<double> y(2 * count, 0.0);
  const auto moved = [&](const std::vector<double>& k, double h) {
    std::vector<double> z = y;
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += h * k[i];
    return z;
  };
  std::vector<std::pair<double, double>> path = {{0, 0}};
  const double h = 5e-3;
  for (double t = 0; t < T - h / 2; t += h) {
    const auto k1 = acceleration(t, y), k2 = acceleration(t + h / 2, moved(k1, h / 2)),
               k3 = acceleration(t + h / 2, moved(k2, h / 2)), k4 = acceleration(t + h, moved(k3, h));
    double tip = 0;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    for (std::size_t i = 0; i < count; ++i) tip += y[i];
    path.emplace_back(t + h, tip);
  }
  return path;
}

std::vector<Real> arm_of_model(int n, Real q2, const std::string& ends) {
  const Model model =
      model_with("two_link_flexible_arm",
                 {{"modes             = 2", ends}, {"coordinates       = [\"e1\", \"e2\"]", modes(n, "e")}});
  std::vector<Real> r(static_cast<std::size_t>(n) + 2, 0), r_dot = r;
  r[0] = 0.3L;
  r.back() = q2;
  return small_motion(model, r, r_dot);
}

std::vector<Real> arm_by_ritz(int n, Real q2) {
  const Arm arm;
  Square M = Square::Zero(n, n), K = Square::Zero(n, n);
  std::vector<Cantilever> shapes;
  for (int j = 1; j <= n; ++j) shapes.emplace_back(j);
  Column f(n), curvature(n), slope(n);
  for (const auto& [s, w] : test::gauss_legendre(60)) {
    for (int j = 0; j < n; ++j) {
      f(j) = shapes[static_cast<std::size_t>(j)].at(s);
      curvature(j) = shapes[static_cast<std::size_t>(j)].curvature(s) / (arm.L * arm.L);
    }
    M += w * arm.L * arm.rhoA * f * f.transpose();
    K += w * arm.L * arm.EI * curvature * curvature.transpose();
  }
  for (int j = 0; j < n; ++j) {
    f(j) = shapes[static_cast<std::size_t>(j)].at(1);
    slope(j) = shapes[static_cast<std::size_t>(j)].slope(1) / arm.L;
  }
  add_tip(M, arm, q2, f, slope);
  return frequencies(K, M);
}

std::vector<Real> arm_by_finite_elements(int elements, Real q2) {
  const Arm arm;
  const Real h = arm.L / elements;
  const int n = 2 * elements;
  Square M = Square::Zero(n + 2, n + 2), K = M;
  Square m(4, 4), k(4, 4);
  m << 156, 22 * h, 54, -13 * h, 22 * h, 4 * h * h, 13 * h, -3 * h * h, 54, 13 * h, 156, -22 * h, -13 * h,
      -3 * h * h, -22 * h, 4 * h * h;
  k << 12, 6 * h, -12, 6 * h, 6 * h, 4 * h * h, -6 * h, 2 * h * h, -12, -6 * h, 12, -6 * h, 6 * h, 2 * h * h,
      -6 * h, 4 * h * h;
  for (int e = 0; e < elements; ++e) {
    M.block(2 * e, 2 * e, 4, 4) += arm.rhoA * h / 420 * m;
    K.block(2 * e, 2 * e, 4, 4) += arm.EI / (h * h * h) * k;
  }
  M = Square(M.bottomRightCorner(n, n)), K = Square(K.bottomRightCorner(n, n));  // clamped at the root
  Column v = Column::Zero(n), turn = Column::Zero(n);
  v(n - 2) = 1, turn(n - 1) = 1;
  add_tip(M, arm, q2, v, turn);
  return frequencies(K, M);
}

Model snakeboard(int n, const std::string& deformation) {
  std::vector<std::pair<std::string, std::string>> changes;
  for (const char* beam : {"re3", "re4"})
    changes.emplace_back(
        fmt::format("deformation       = \"quadratic\"\ncoordinates       = [\"{}\"]", beam),
        fmt::format("deformation = \"{}\"\n{}", deformation, modes(n, fmt::format("{}_", beam))));
  return model_with("soft_snakeboard", changes);
}

}  // namespace anholon::test
