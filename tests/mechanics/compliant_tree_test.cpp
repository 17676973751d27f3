// SPDX-License-Identifier: GPL-2.0-or-later
//
// Compliant bodies anywhere in the tree, against a Lagrangian written down from the displacement field:
// quadrature over the beams, rotation of the stations by Rodrigues' formula, derivatives by hyper-dual
// numbers. The field is p = p_0 + p_1 + p_2 by orders of the modal coordinates; with w_i the velocity of the
// part p_i in the beam's axes, a body's kinetic energy has per mass
//   quadratic  |w_0 + w_1|^2 / 2                 linear  that without |Omega x p_1|^2 / 2
//   stiffened  |w_0 + w_1|^2 / 2 + w_0 . w_2
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "mechanics/beam_shapes.hpp"
#include "mechanics/energy_witness.hpp"
#include "mechanics/witness.hpp"

namespace anholon::compliant_tree_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

struct Beam {
  Real L, rhoA, rhoJ;
  std::string planes;
  int bending, torsion, axial;
  [[nodiscard]] std::size_t modes() const {
    return planes.size() * static_cast<std::size_t>(bending) + static_cast<std::size_t>(torsion + axial);
  }
  [[nodiscard]] std::string text(const std::string& deformation) const {
    std::string list;
    for (const char plane : planes) list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", plane);
    std::string text = fmt::format(
        "[body.beam]\nlength = {:.20g}\nmass_per_length = {:.20g}\nbending_stiffness = 1.4\nmodes = "
        "{}\nplanes = [{}]\n"
        "deformation = \"{}\"\nrange = [-0.5, 0.5]\n",
        L, rhoA, bending, list, deformation);
    if (rhoJ > 0) text += fmt::format("polar_inertia = {:.20g}\n", rhoJ);
    if (torsion > 0) text += fmt::format("torsion_modes = {}\ntorsion_stiffness = 0.8\n", torsion);
    if (axial > 0) text += fmt::format("axial_modes = {}\naxial_stiffness = 30\n", axial);
    return text;
  }
};

/// Sine of fixed-free rods: 1 at the end.
Real rod(int i, Real s) { return (i % 2 == 1 ? 1 : -1) * std::sin((i - 0.5L) * M_PIl * s); }
Real rod_slope(int i, Real s) {
  return (i % 2 == 1 ? 1 : -1) * (i - 0.5L) * M_PIl * std::cos((i - 0.5L) * M_PIl * s);
}

const std::vector<std::pair<Real, Real>>& rule() {
  static const auto points = gauss_legendre(20);  // exact for the products of these shapes to 1e-30
  return points;
}

/// Shapes of a beam at s, in units of the length.
struct Section {
  Real s = 0;
  std::vector<Real> f, slope, torsion, axial;
  std::vector<std::vector<Real>> shortening;  // int_0^s f_j' f_l'
  Section(const Beam& beam, const std::vector<Cantilever>& shapes, Real at) : s(at) {
    for (const Cantilever& c : shapes) f.push_back(c.at(s)), slope.push_back(c.slope(s));
    for (int i = 1; i <= beam.torsion; ++i) torsion.push_back(rod(i, s));
    for (int i = 1; i <= beam.axial; ++i) axial.push_back(rod(i, s));
    shortening.assign(f.size(), std::vector<Real>(f.size(), 0));
    for (std::size_t j = 0; j < f.size(); ++j) {
      for (std::size_t l = 0; l < f.size(); ++l) {
        for (const auto& [x, w] : rule())
          shortening[j][l] += w * s * shapes[j].slope(x * s) * shapes[l].slope(x * s);
      }
    }
  }
};

/// Displacement of a point by orders, and the rotation vector of the section.
struct Displacement {
  Vec3<Moving> first, second, turn;
  Displacement(const Beam& beam, const Section& at, Real y, Real z, const Moving* r) {
    std::size_t next = 0;
    Moving shortened, twist;
    for (const char plane : beam.planes) {
      Moving deflection, slope;
      for (std::size_t j = 0; j < at.f.size(); ++j) {
        deflection = deflection + Moving(at.f[j]) * r[next + j];
        slope = slope + Moving(at.slope[j] / beam.L) * r[next + j];
        for (std::size_t l = 0; l < at.f.size(); ++l)
          shortened = shortened + Moving(at.shortening[j][l] / (2 * beam.L)) * r[next + j] * r[next + l];
      }
      next += at.f.size();
      first[plane == 'y' ? 1 : 2] = deflection;
      turn[plane == 'y' ? 2 : 1] = plane == 'y' ? slope : -slope;
    }
    for (const Real shape : at.torsion) twist = twist + Moving(shape) * r[next++];
    for (const Real shape : at.axial) first.x = first.x + Moving(shape) * r[next++];
    turn.x = twist;
    first.y = first.y - Moving(z) * twist;
    first.z = first.z + Moving(y) * twist;
    const Moving half = Moving(0.5L) * twist * twist;
    second = {-shortened, -(half * Moving(y)), -(half * Moving(z))};
  }
};

Vec3<Hyper> rate(const Vec3<Moving>& v) { return {v.x.d, v.y.d, v.z.d}; }
Vec3<Hyper> value(const Vec3<Moving>& v) { return {v.x.x, v.y.x, v.z.x}; }

struct BeamOfPoints {
  Beam beam;
  std::vector<Cantilever> shapes;
  std::vector<std::pair<Section, Real>> sections;  // with mass
  explicit BeamOfPoints(const Beam& b) : beam(b) {
    for (int j = 1; j <= b.bending; ++j) shapes.emplace_back(j);
    for (const auto& [s, w] : rule()) sections.emplace_back(Section(b, shapes, s), b.rhoA * b.L * w);
  }
  [[nodiscard]] Frame station(Real s, const Moving* r, const std::string& deformation) const {
    const Displacement d(beam, Section(beam, shapes, s), 0, 0, r);
    Vec3<Moving> at = Vec3<Moving>{Moving(beam.L * s), 0, 0} + d.first;
    if (deformation == "stiffened") at += d.second;
    return moved_by(at) * turned_by(d.turn);
  }
  [[nodiscard]] Hyper lagrangian(const Frame& g, const Moving* r, const std::string& deformation,
                                 const std::array<Real, 3>& gravity) const {
    Mat3<Hyper> R, R_dot;
    for (std::size_t i = 0; i < 9; ++i) R.m[i] = g.R.m[i].x, R_dot.m[i] = g.R.m[i].d;
    const Mat3<Hyper> W = R.transposed() * R_dot;
    const Vec3<Hyper> v = transposed_times(R, rate(g.p));
    const Vec3<Hyper> fall = transposed_times(R, Vec3<Hyper>{gravity[0], gravity[1], gravity[2]});
    Hyper L = 0;
    const Real offset = std::sqrt(beam.rhoJ / beam.rhoA);  // four points have the polar inertia rhoJ
    for (const auto& [section, mass] : sections) {
      for (int corner = 0; corner < (offset > 0 ? 4 : 1); ++corner) {
        const Real y = corner == 0 ? offset : corner == 1 ? -offset : 0;
        const Real z = corner == 2 ? offset : corner == 3 ? -offset : 0;
        const Hyper m = mass / (offset > 0 ? 4 : 1);
        const Displacement d(beam, section, y, z, r);
        const Vec3<Hyper> p0 = {beam.L * section.s, y, z};
        const Vec3<Hyper> w0 = v + W * p0;
        const Vec3<Hyper> turned = W * value(d.first);
        const Vec3<Hyper> w1 = turned + rate(d.first);
        const Vec3<Hyper> w2 = W * value(d.second) + rate(d.second);
        Hyper twice = dot(w0 + w1, w0 + w1);
        if (deformation == "linear") twice = twice - dot(turned, turned);
        if (deformation == "stiffened") twice = twice + Hyper(2) * dot(w0, w2);
        Vec3<Hyper> at = p0 + value(d.first);
        if (deformation == "stiffened") at += value(d.second);
        L = L + m * (Hyper(0.5L) * twice + dot(fall, at));
      }
    }
    const Hyper weight = beam.rhoA * beam.L;
    return L + weight * dot(Vec3<Hyper>{gravity[0], gravity[1], gravity[2]}, value(g.p)) + -elastic(r);
  }
  [[nodiscard]] Hyper elastic(const Moving* r) const {
    Hyper energy = 0;
    std::size_t next = 0;
    for (std::size_t plane = 0; plane < beam.planes.size(); ++plane, next += shapes.size()) {
      for (const auto& [s, w] : rule()) {
        Hyper curvature = 0;
        for (std::size_t j = 0; j < shapes.size(); ++j)
          curvature = curvature + Hyper(shapes[j].curvature(s)) * r[next + j].x;
        energy = energy + Hyper(1.4L * w / (2 * beam.L * beam.L * beam.L)) * curvature * curvature;
      }
    }
    const auto rods = [&](int count, Real stiffness) {
      for (const auto& [s, w] : rule()) {
        Hyper strain = 0;
        for (int i = 1; i <= count; ++i)
          strain = strain + Hyper(rod_slope(i, s)) * r[next + static_cast<std::size_t>(i - 1)].x;
        energy = energy + Hyper(stiffness * w / (2 * beam.L)) * strain * strain;
      }
      next += static_cast<std::size_t>(count);
    };
    rods(beam.torsion, 0.8L);
    rods(beam.axial, 30);
    return energy;
  }
};

Hyper lagrangian_of(const Cloud& cloud, const Frame& g, const std::array<Real, 3>& gravity) {
  Hyper L = 0;
  for (const auto& [m, x, y, z] : cloud) {
    const Vec3<Moving> at = g.p + g.R * Vec3<Moving>{Moving(Real(x)), Moving(Real(y)), Moving(Real(z))};
    L = L + Hyper(m) * (Hyper(0.5L) * dot(rate(at), rate(at)) +
                        dot(Vec3<Hyper>{gravity[0], gravity[1], gravity[2]}, value(at)));
  }
  return L;
}

/// Large: deflections to half a metre or half a radian, rates to 2 a second.
State<Real> random_state(std::size_t coordinates, std::mt19937_64& rng) {
  const auto uniform = [&](double bound) {
    return static_cast<Real>(std::uniform_real_distribution<double>(-bound, bound)(rng));
  };
  State<Real> s;
  std::array<Real, 4> q{};
  Real norm = 0;
  for (Real& x : q) x = uniform(1), norm += x * x;
  for (Real& x : q) x /= std::sqrt(norm);
  const auto [w, x, y, z] = q;
  s.R.m = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
           2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
           2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  for (int i = 0; i < 3; ++i) s.p[i] = uniform(1);
  for (int i = 0; i < 6; ++i) s.eta[i] = uniform(2);
  for (std::size_t i = 0; i < coordinates; ++i) s.r.push_back(uniform(0.5)), s.r_dot.push_back(uniform(2));
  return s;
}

struct Case {
  const char* name;
  const char* deformation;
  Beam first;   // behind a hinge on the base
  Beam second;  // on a hinge at station 0.6 of the first, without modes: a rigid rod
};
void PrintTo(const Case& c, std::ostream* stream) { *stream << c.name; }

class CompliantTree : public testing::TestWithParam<Case> {};

// base -- hinge a -- first beam -- at 0.6: hinge b -- second beam -- at its tip: a load
//                              \-- at its tip: a load
TEST_P(CompliantTree, HasTheDynamicsOfItsLagrangian) {
  const Case c = GetParam();
  const std::array<Real, 3> gravity = {0.6L, -3.1L, -8.8L};
  const auto axis = [](Real x, Real y, Real z) { return Vec3<Moving>{Moving(x), Moving(y), Moving(z)}; };
  const std::string text =
      header("SE3", "gravity = [0.6, -3.1, -8.8]") + body("base", "", cloud(0)) +
      body("first", "base", cloud(1),
           "pose = { translation = [0.2, -0.1, 0.3], rotation = { axis = \"z\", angle = 0.7 } }\n"
           "joint = { kind = \"revolute\", axis = [0, -0.28, 0.96], coordinate = \"a\" }\n" +
               c.first.text(c.deformation)) +
      body("second", "first", {},
           "station = 0.6\npose = { translation = [0.05, 0.02, -0.04], rotation = { axis = \"x\", angle = "
           "0.4 } }\n"
           "joint = { kind = \"revolute\", axis = [0.6, 0, 0.8], coordinate = \"b\" }\n" +
               c.second.text(c.deformation)) +
      body("load", "first", cloud(2), "joint = { kind = \"fixed\" }\n") +
      body("far_load", "second", cloud(1),
           "pose = { translation = [0.1, 0, 0.05] }\njoint = { kind = \"fixed\" }\n");
  const BeamOfPoints first(c.first), second(c.second);
  const Lagrangian lagrangian = [&](const Frame& g, const std::vector<Moving>& r) {
    const Moving* modes = r.data() + 1;
    const Moving* further = modes + c.first.modes() + 1;
    const Frame root = g * moved_by(axis(0.2L, -0.1L, 0.3L)) * turned_about(axis(0, 0, 1), Moving(0.7L)) *
                       turned_about(axis(0, -0.28L, 0.96L), r[0]);
    const Frame elbow = root * first.station(0.6L, modes, c.deformation) *
                        moved_by(axis(0.05L, 0.02L, -0.04L)) * turned_about(axis(1, 0, 0), Moving(0.4L)) *
                        turned_about(axis(0.6L, 0, 0.8L), modes[c.first.modes()]);
    Frame end = elbow * moved_by(axis(c.second.L, 0, 0));
    if (c.second.modes() > 0) end = elbow * second.station(1, further, c.deformation);
    return lagrangian_of(cloud(0), g, gravity) + lagrangian_of(cloud(1), root, gravity) +
           first.lagrangian(root, modes, c.deformation, gravity) +
           second.lagrangian(elbow, further, c.deformation, gravity) +
           lagrangian_of(cloud(2), root * first.station(1, modes, c.deformation), gravity) +
           lagrangian_of(cloud(1), end * moved_by(axis(0.1L, 0, 0.05L)), gravity);
  };
  const Model model = read_model_text(text, "witness.toml");
  ASSERT_EQ(model.coordinates.size(), 2 + c.first.modes() + c.second.modes());
  const MechanismDescription description = describe_mechanism(model);
  const Mechanism<double> in_double = mechanise<double>(description, {});
  const Mechanism<Real> in_long_double = mechanise<Real>(description, {});
  FreeDynamics<double> dynamics(in_double);
  FreeDynamics<Real> long_dynamics(in_long_double);

  std::mt19937_64 rng(20260101);
  BlockErrors errors, long_errors;
  for (int sample = 0; sample < 4; ++sample) {
    State<Real> s = random_state(model.coordinates.size(), rng);
    std::array<Real, 6> eta{};
    for (int i = 0; i < 6; ++i) eta[static_cast<std::size_t>(i)] = s.eta[i];
    const LagrangianDynamics want = dynamics_of(lagrangian, s.R, {s.p.x, s.p.y, s.p.z}, eta, s.r, s.r_dot);
    const State<double> d = rounded(s);
    add_dynamics(errors, "double", 6, want.M, want.force, dynamics.mass_matrix(d), dynamics.forces(d));
    add_dynamics(long_errors, "long double", 6, want.M, want.force, long_dynamics.mass_matrix(s),
                 long_dynamics.forces(s));
  }
  errors.expect_below(1e-12L);       // a thousand operations of half an ulp of 1.1e-16
  long_errors.expect_below(1e-15L);  // of 5.4e-20; sees wrong terms that double's rounding would hide
}

/// Mass matrix and forces of a description, by the names of its velocities.
std::map<std::string, Real> named_dynamics(const std::string& text,
                                           const std::map<std::string, std::pair<Real, Real>>& at) {
  const Model model = read_model_text(text, "tree.toml");
  const Mechanism<Real> mechanism = mechanise<Real>(describe_mechanism(model), {});
  FreeDynamics<Real> dynamics(mechanism);
  State<Real> s;
  std::vector<std::string> names;
  for (int i = 0; i < 6; ++i) s.eta[i] = 0.3L + 0.2L * i, names.push_back(fmt::format("eta{}", i));
  for (const Coordinate& c : model.coordinates) {
    s.r.push_back(at.at(c.name).first), s.r_dot.push_back(at.at(c.name).second);
    names.push_back(c.name);
  }
  const Matrix<Real> M = dynamics.mass_matrix(s);
  const std::vector<Real> force = dynamics.forces(s);
  std::map<std::string, Real> result;
  for (std::size_t i = 0; i < names.size(); ++i) {
    result[names[i]] = force[i];
    for (std::size_t j = 0; j < names.size(); ++j)
      result[names[i] + " " + names[j]] = M(static_cast<int>(i), static_cast<int>(j));
  }
  return result;
}

TEST(CompliantTreeNumbering, DoesNotMatter) {
  const auto limb = [](const std::string& side) {
    return body(
        side, "base", cloud(1),
        fmt::format("joint = {{ kind = \"revolute\", axis = [0, 0.6, 0.8], coordinate = \"a_{}\" }}\n",
                    side) +
            fmt::format("[body.beam]\nlength = 0.7\nmass_per_length = 0.9\nbending_stiffness = 2\nmodes = 2\n"
                        "planes = [\"y\", \"z\"]\nrange = [-0.1, 0.1]\n"));
  };
  const auto hand = [](const std::string& side) {
    return body(
        "hand_" + side, side, cloud(2),
        fmt::format("joint = {{ kind = \"revolute\", axis = [1, 0, 0], coordinate = \"b_{}\" }}\n", side));
  };
  const std::string base = header("SE3", "gravity = [0, 0, -9.81]") + body("base", "", cloud(0));
  const std::map<std::string, std::pair<Real, Real>> at = {
      {"a_left", {0.4L, 1}},        {"a_right", {-0.7L, -0.6L}}, {"b_left", {1.1L, 0.3L}},
      {"b_right", {0.2L, -1.2L}},   {"left_e1", {0.1L, 0.5L}},   {"left_e2", {-0.05L, 0.8L}},
      {"left_e3", {0.08L, -1}},     {"left_e4", {0.02L, 0.4L}},  {"right_e1", {-0.1L, 0.7L}},
      {"right_e2", {0.03L, -0.9L}}, {"right_e3", {0.06L, 0.2L}}, {"right_e4", {-0.04L, 1.1L}}};
  const auto one = named_dynamics(base + limb("left") + hand("left") + limb("right") + hand("right"), at);
  const auto other = named_dynamics(base + limb("right") + limb("left") + hand("left") + hand("right"), at);
  ASSERT_EQ(one.size(), other.size());
  Real size = 0;
  for (const auto& [name, value] : one) size = std::max(size, std::abs(value));
  for (const auto& [name, value] : one)
    EXPECT_NEAR(static_cast<double>(value), static_cast<double>(other.at(name)),
                1e-16 * static_cast<double>(size))
        << name;
}

const Beam in_plane{0.8L, 0.9L, 0, "y", 2, 0, 0}, in_space{0.8L, 0.9L, 0, "yz", 1, 0, 0},
    full{0.8L, 0.9L, 0.05L, "zy", 2, 1, 1}, rod_only{0.5L, 0.7L, 0, "y", 0, 0, 0},
    finger{0.5L, 0.7L, 0.02L, "y", 1, 1, 0};

INSTANTIATE_TEST_SUITE_P(
    Orders, CompliantTree,
    testing::Values(Case{"QuadraticInPlaneCarriesARod", "quadratic", in_plane, rod_only},
                    Case{"StiffenedInPlaneCarriesARod", "stiffened", in_plane, rod_only},
                    Case{"LinearInPlaneCarriesARod", "linear", in_plane, rod_only},
                    Case{"QuadraticInSpaceCarriesABeam", "quadratic", in_space, in_plane},
                    Case{"StiffenedInSpaceCarriesABeam", "stiffened", in_space, in_plane},
                    Case{"LinearInSpaceCarriesABeam", "linear", in_space, in_plane},
                    Case{"QuadraticWithTorsionAndStretch", "quadratic", full, finger},
                    Case{"StiffenedWithTorsionAndStretch", "stiffened", full, finger},
                    Case{"LinearWithTorsionAndStretch", "linear", full, finger}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace anholon::compliant_tree_test
