// SPDX-License-Identifier: GPL-2.0-or-later
//
// Fluids around bodies and beams: added mass against the Lagrangian of the fluid's kinetic energy, drag,
// resistance and wake against forces at hand-written points, whose velocities are those of the points' paths.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "anholon/free_dynamics.hpp"
#include "check/evaluate_program.hpp"
#include "derive/derive.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "mechanics/beam_shapes.hpp"
#include "mechanics/energy_witness.hpp"
#include "mechanics/witness.hpp"

namespace anholon::fluid_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

Vec3<Moving> axis(Real x, Real y, Real z) { return {Moving(x), Moving(y), Moving(z)}; }

/// Twist of a frame in its own axes, by the rates of its pose.
std::array<Hyper, 6> twist(const Frame& g) {
  Mat3<Hyper> R, R_dot;
  for (std::size_t i = 0; i < 9; ++i) R.m[i] = g.R.m[i].x, R_dot.m[i] = g.R.m[i].d;
  const Mat3<Hyper> W = R.transposed() * R_dot;
  const Vec3<Hyper> v = transposed_times(R, Vec3<Hyper>{g.p.x.d, g.p.y.d, g.p.z.d});
  return {v.x, v.y, v.z, W(2, 1), W(0, 2), W(1, 0)};
}

using Matrix6 = std::array<std::array<Real, 6>, 6>;

/// Full, symmetric and positive definite.
const Matrix6& kirchhoff() {
  static const Matrix6 M = {{{2.1L, 0.3L, -0.2L, 0.1L, 0.4L, -0.3L},
                             {0.3L, 3.2L, 0.5L, -0.2L, 0.15L, 0.25L},
                             {-0.2L, 0.5L, 2.7L, 0.35L, -0.1L, 0.2L},
                             {0.1L, -0.2L, 0.35L, 0.9L, 0.05L, -0.15L},
                             {0.4L, 0.15L, -0.1L, 0.05L, 1.1L, 0.1L},
                             {-0.3L, 0.25L, 0.2L, -0.15L, 0.1L, 0.8L}}};
  return M;
}
std::string text_of(const Matrix6& M) {
  std::string text;
  for (const auto& row : M) {
    std::string numbers;
    for (const Real x : row) numbers += fmt::format("{}{:.2f}", numbers.empty() ? "" : ", ", x);
    text += fmt::format("{}[{}]", text.empty() ? "" : ", ", numbers);
  }
  return "[" + text + "]";
}
Hyper energy(const Matrix6& M, const std::array<Hyper, 6>& V) {
  Hyper twice = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) twice = twice + Hyper(M[i][j]) * V[i] * V[j];
  }
  return Hyper(0.5L) * twice;
}

Hyper energy_of(const Cloud& cloud, const Frame& g) {
  Hyper T = 0;
  for (const auto& [m, x, y, z] : cloud) {
    const Vec3<Moving> at = g.p + g.R * axis(x, y, z);
    T = T + Hyper(0.5L * Real(m)) * (at.x.d * at.x.d + at.y.d * at.y.d + at.z.d * at.z.d);
  }
  return T;
}
Hyper weight(const std::array<Real, 3>& gravity, Real m, const Vec3<Moving>& at) {
  return Hyper(m) * (Hyper(gravity[0]) * at.x.x + Hyper(gravity[1]) * at.y.x + Hyper(gravity[2]) * at.z.x);
}

/// Mass matrix and forces at 100 states, less those of a description that leaves something out: 1e-13 in
/// double (some hundred operations of half an ulp, 1.1e-16) and 1e-16 in long double (of 5.4e-20), where the
/// difference of two descriptions costs what is common to them; the second sees what double's rounding hides.
void expect_dynamics(const std::string& text, const std::string& without, const Lagrangian& lagrangian) {
  const Model model = read_model_text(text, "witness.toml");
  const MechanismDescription description = describe_mechanism(model);
  const Mechanism<double> in_double = mechanise<double>(description, {});
  const Mechanism<Real> in_long_double = mechanise<Real>(description, {});
  FreeDynamics<double> dynamics(in_double);
  FreeDynamics<Real> long_dynamics(in_long_double);
  std::optional<Mechanism<Real>> rest;
  if (!without.empty())
    rest = mechanise<Real>(describe_mechanism(read_model_text(without, "without.toml")), {});
  DeriveRequest request;
  request.functions = {"kinematics", "reduced_velocities", "free_dynamics", "energies"};
  request.closed_forms = false;
  const auto derivation = derive(model, request);
  const auto call = interpreting_caller<double>(derivation->program, {});

  std::mt19937_64 rng(20260203);
  BlockErrors errors, long_errors;
  for (int sample = 0; sample < 100; ++sample) {
    const State<Real> s = random_position_and_velocity(model, rng);
    std::array<Real, 6> eta{};
    for (int i = 0; i < 6; ++i) eta[static_cast<std::size_t>(i)] = s.eta[i];
    LagrangianDynamics want = dynamics_of(lagrangian, s.R, {s.p.x, s.p.y, s.p.z}, eta, s.r, s.r_dot);
    if (rest) {
      FreeDynamics<Real> of_rest(*rest);
      const Matrix<Real> M = of_rest.mass_matrix(s);
      const std::vector<Real> force = of_rest.forces(s);
      for (std::size_t i = 0; i < force.size(); ++i) {
        want.force[i] += force[i];
        for (std::size_t j = 0; j < force.size(); ++j)
          want.M[i][j] += M(static_cast<int>(i), static_cast<int>(j));
      }
    }
    EvaluationInput<double> input;
    input.state = rounded(s);
    add_dynamics(errors, "double", 6, want.M, want.force, dynamics.mass_matrix(input.state),
                 dynamics.forces(input.state));
    add_dynamics(long_errors, "long double", 6, want.M, want.force, long_dynamics.mass_matrix(s),
                 long_dynamics.forces(s));
    const Evaluated<double> e = evaluate_program(model, *derivation, call, input);
    add_dynamics(errors, "program", 6, want.M, want.force, e.M, e.force);
    const auto energies = long_dynamics.energies(s);
    errors.add("energies of the program", {energies.kinetic + energies.gravity},
               std::vector{e.kinetic + e.gravity});
    Real T = 0;  // v M v / 2 with the witness's M
    const std::vector<Real> v = velocity(model.group, s);
    for (std::size_t i = 0; i < v.size(); ++i) {
      for (std::size_t j = 0; j < v.size(); ++j) T += v[i] * want.M[i][j] * v[j] / 2;
    }
    long_errors.add("kinetic energy", {T}, std::vector{energies.kinetic});
  }
  errors.expect_below(1e-13L);
  long_errors.expect_below(1e-16L);
}

// A base, a slide with Kirchhoff's full matrix about a point, on it a hinge with an added mass at its origin
// and a line of sections, both about oblique axes; gravity, and buoyancy away from the mass centres.
TEST(AddedMass, HasTheDynamicsOfTheFluidsKineticEnergy) {
  const std::array<Real, 3> gravity = {0.6L, -3.1L, -8.8L};
  const std::string bodies =
      header("SE3", "gravity = [0.6, -3.1, -8.8]") + body("base", "", cloud(0)) +
      body("slide", "base", cloud(1),
           "pose = { translation = [0.2, 0.1, 0], rotation = { axis = \"z\", angle = 0.8 } }\n"
           "joint = { kind = \"prismatic\", axis = [0, -0.6, 0.8], coordinate = \"x\", range = [-1, 1] }") +
      body("hinge", "slide", cloud(2),
           "pose = { translation = [0, 0.3, -0.1], rotation = { axis = \"x\", angle = -0.5 } }\n"
           "joint = { kind = \"revolute\", axis = [\"2/3\", \"2/3\", \"-1/3\"], coordinate = \"b\" }") +
      body("fin", "hinge", {},  // merged with the hinge before anything is derived
           "pose = { translation = [0.1, 0, -0.2], rotation = { axis = \"y\", angle = 0.9 } }\n"
           "joint = { kind = \"fixed\" }");
  const std::string fluids = fmt::format(
      "[[fluid]]\nbody = \"slide\"\npoint = [0.1, -0.2, 0.3]\nadded_mass = {}\n"
      "[[fluid]]\nbody = \"hinge\"\nadded_mass = [0.5, 1.5, 0, 0.2, 0, 0.4]\n"
      "[[fluid]]\nbody = \"base\"\npoint = [0.05, 0.1, -0.15]\ndisplaced_mass = 1.7\n"
      "[[fluid]]\nbody = \"fin\"\nfrom = [-0.2, 0, 0.1]\nto = [0.3, 0, 0.1]\nsections = 3\n"
      "profile = \"1 - x^2/2\"\nadded_mass = [0, 1.2, 0.7]\ndisplaced_mass = 0.8\n",
      text_of(kirchhoff()));
  const auto rule = gauss_legendre(3);
  expect_dynamics(bodies + fluids, "", [&](const Frame& g, const std::vector<Moving>& r) {
    const Frame slide = g * moved_by(axis(0.2L, 0.1L, 0)) * turned_about(axis(0, 0, 1), Moving(0.8L)) *
                        moved_by({Moving(0), Moving(-0.6L) * r[0], Moving(0.8L) * r[0]});
    const Frame hinge = slide * moved_by(axis(0, 0.3L, -0.1L)) * turned_about(axis(1, 0, 0), Moving(-0.5L)) *
                        turned_about(axis(2 / 3.0L, 2 / 3.0L, -1 / 3.0L), r[1]);
    const Frame fin = hinge * moved_by(axis(0.1L, 0, -0.2L)) * turned_about(axis(0, 1, 0), Moving(0.9L));
    Hyper L = energy_of(cloud(0), g) + energy_of(cloud(1), slide) + energy_of(cloud(2), hinge);
    for (const auto& [frame, masses] :
         {std::pair(g, cloud(0)), std::pair(slide, cloud(1)), std::pair(hinge, cloud(2))}) {
      for (const auto& [m, x, y, z] : masses) L = L + weight(gravity, m, frame.p + frame.R * axis(x, y, z));
    }
    L = L + energy(kirchhoff(), twist(slide * moved_by(axis(0.1L, -0.2L, 0.3L))));
    Matrix6 diagonal{};
    diagonal[0][0] = 0.5L, diagonal[1][1] = 1.5L, diagonal[3][3] = 0.2L, diagonal[5][5] = 0.4L;
    L = L + energy(diagonal, twist(hinge));
    L = L + weight(gravity, -1.7L, g.p + g.R * axis(0.05L, 0.1L, -0.15L));
    for (const auto& [s, w] : rule) {
      const Frame section = fin * moved_by(axis(-0.2L + 0.5L * s, 0, 0.1L));
      const Real share = w * 0.5L * (1 - s * s / 2);
      Matrix6 across{};
      across[1][1] = 1.2L * share, across[2][2] = 0.7L * share;
      L = L + energy(across, twist(section)) + weight(gravity, -0.8L * share, section.p);
    }
    return L;
  });
}

// Sections of a beam turn with its slopes and, where it is stiffened, come nearer to its root. The beam's own
// kinetic energy is that of the tests of compliant trees and is taken off by the same description without
// fluid.
TEST(AddedMass, OfABeamFollowsItsSections) {
  for (const std::string deformation : {"quadratic", "stiffened"}) {
    const std::string bodies =
        header("SE3", "gravity = [0.6, -3.1, -8.8]") + body("base", "", cloud(0)) +
        body("tail", "base", {},
             "pose = { translation = [0.2, -0.1, 0.3], rotation = { axis = \"z\", angle = 0.7 } }\n"
             "joint = { kind = \"revolute\", axis = [0, -0.28, 0.96], coordinate = \"a\" }\n"
             "[body.beam]\nlength = 0.8\nmass_per_length = 0.01\nbending_stiffness = 1.4\nmodes = 2\n"
             "planes = [\"y\", \"z\"]\nrange = [-0.5, 0.5]\ndeformation = \"" +
                 deformation + "\"\n") +
        body("tip", "tail", {}, "joint = { kind = \"fixed\" }");
    const std::string fluids = fmt::format(
        "[[fluid]]\nbody = \"tail\"\nfrom = 0.25\nsections = 2\nadded_mass = [0.1, 1.2, 0.7]\nprofile = \"2 "
        "- "
        "x\"\n[[fluid]]\nbody = \"tip\"\nadded_mass = {}\n",
        text_of(kirchhoff()));
    const std::array<Cantilever, 2> shapes = {Cantilever(1), Cantilever(2)};
    const auto shortening_at = [&](Real s) {  // of a tip deflection of 1, over the length
      Matrix6 result{};
      for (const auto& [x, w] : gauss_legendre(20)) {
        for (std::size_t j = 0; j < 2; ++j) {
          for (std::size_t l = 0; l < 2; ++l)
            result[j][l] += w * s * shapes[j].slope(x * s) * shapes[l].slope(x * s) / 1.6L;
        }
      }
      return result;
    };
    struct Section {
      Real s, share;
      Matrix6 shortening;
    };
    std::vector<Section> sections;
    for (const auto& [x, w] : gauss_legendre(2)) {
      const Real s = 0.25L + 0.75L * x;
      sections.push_back({s, w * 0.75L * 0.8L * (2 - x), shortening_at(s)});
    }
    const Section tip = {1, 0, shortening_at(1)};
    expect_dynamics(bodies + fluids, bodies, [&](const Frame& g, const std::vector<Moving>& r) {
      const Frame root = g * moved_by(axis(0.2L, -0.1L, 0.3L)) * turned_about(axis(0, 0, 1), Moving(0.7L)) *
                         turned_about(axis(0, -0.28L, 0.96L), r[0]);
      const auto at = [&](const Section& section) {
        Vec3<Moving> place = axis(0.8L * section.s, 0, 0), turn;
        for (std::size_t plane = 0; plane < 2; ++plane) {
          for (std::size_t j = 0; j < 2; ++j) {
            const Moving& e = r[1 + 2 * plane + j];
            const Moving slope = Moving(shapes[j].slope(section.s) / 0.8L) * e;
            place[plane == 0 ? 1 : 2] = place[plane == 0 ? 1 : 2] + Moving(shapes[j].at(section.s)) * e;
            turn[plane == 0 ? 2 : 1] = turn[plane == 0 ? 2 : 1] + (plane == 0 ? slope : -slope);
            for (std::size_t l = 0; l < 2 && deformation == "stiffened"; ++l)
              place.x = place.x - Moving(section.shortening[j][l]) * e * r[1 + 2 * plane + l];
          }
        }
        return root * moved_by(place) * turned_by(turn);
      };
      Hyper T = energy(kirchhoff(), twist(at(tip)));
      for (const Section& section : sections) {
        Matrix6 across{};
        across[0][0] = 0.1L * section.share, across[1][1] = 1.2L * section.share;
        across[2][2] = 0.7L * section.share;
        T = T + energy(across, twist(at(section)));
      }
      return T;
    });
  }
}

// ---- forces of points

Vector world(const Pose& frame, const Vector& components) {
  Pose turn = frame;
  turn.p = Vector();
  return turn * components;
}
/// Velocity of a frame's origin and its angular velocity, in its own axes.
std::array<Real, 6> own_velocity(const Pose& frame) {
  const auto w = angular_velocity(frame);
  std::array<Real, 6> v{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      v[i] += frame.R[c][i].x * frame.p[c].d;
      v[3 + i] += frame.R[c][i].x * w[c];
    }
  }
  return v;
}

/// A free base with an oblique hinge; forces act at `points`, of the base (first) and of the hinge.
Witness base_and_hinge(const std::string& fluids, const std::vector<Vector>& on_base,
                       const std::vector<Vector>& on_hinge) {
  Witness w;
  w.description = header("SE3") + body("base", "", cloud(0)) +
                  body("hinge", "base", cloud(1),
                       "pose = { translation = [0.2, 0.1, 0], rotation = { axis = \"z\", angle = 0.8 } }\n"
                       "joint = { kind = \"revolute\", axis = [0, -0.6, 0.8], coordinate = \"b\" }") +
                  fluids;
  const auto hinge = [](const Pose& g, const std::vector<Jet>& r) {
    return g * moved({0.2L, 0.1L, 0}) * turned({0, 0, 1}, 0.8L) * turned({0, -0.6L, 0.8L}, r[0]);
  };
  w.masses = [hinge](const Pose& g, const std::vector<Jet>& r) {
    std::vector<MassPoint> points;
    add(points, g, cloud(0)), add(points, hinge(g, r), cloud(1));
    return points;
  };
  w.loaded_frames = [=](const Pose& g, const std::vector<Jet>& r) {
    std::vector<Pose> frames;
    for (const Vector& p : on_base) frames.push_back(g * moved(p));
    for (const Vector& p : on_hinge) frames.push_back(hinge(g, r) * moved(p));
    return frames;
  };
  return w;
}

/// Loads by a law of a frame's own velocity, which gives force and torque in its axes; all of them dissipate.
using Law = std::function<std::array<Real, 6>(std::size_t frame, const std::array<Real, 6>& v)>;
void load(Witness& w, const Law& law, GroupKind group, bool dissipates) {
  w.loads = [law](const Sample&, const std::vector<Pose>& frames) {
    std::vector<Load> loads;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const std::array<Real, 6> F = law(i, own_velocity(frames[i]));
      loads.push_back({world(frames[i], {F[0], F[1], F[2]}), world(frames[i], {F[3], F[4], F[5]})});
    }
    return loads;
  };
  if (!dissipates) return;
  w.dissipated_power = [law, group, frames_at = w.loaded_frames](const Sample& sample) {
    const State<Real>& s = sample.state;
    const std::vector<Real> v = velocity(group, s);
    const Path moving = path(group, s, v, std::vector<Real>(v.size(), 0));
    Real power = 0;
    std::size_t i = 0;
    for (const Pose& frame : frames_at(moving.g, moving.r)) {
      const std::array<Real, 6> at = own_velocity(frame), F = law(i++, at);
      for (std::size_t c = 0; c < 6; ++c) power -= F[c] * at[c];
    }
    return power;
  };
}

TEST(Drag, IsQuadraticAlongEachAxisAndDissipates) {
  std::vector<Vector> sections;
  for (const auto& [x, weight] : gauss_legendre(4)) sections.emplace_back(0.1L, -0.3L + 0.5L * x, 0.2L);
  Witness w = base_and_hinge(
      "[[fluid]]\nbody = \"base\"\npoint = [0.1, 0, -0.2]\ndrag = [1.5, 2, 0.5, 0.1, 0.2, 0.3]\n"
      "[[fluid]]\nbody = \"hinge\"\nfrom = [0.1, -0.3, 0.2]\nto = [0.1, 0.2, 0.2]\nprofile = \"1 + x\"\n"
      "drag = [0.4, 3, 2]\n",
      {{0.1L, 0, -0.2L}}, sections);
  const auto rule = gauss_legendre(4);
  load(
      w,
      [rule](std::size_t frame, const std::array<Real, 6>& v) {
        std::array<Real, 6> k = {1.5L, 2, 0.5L, 0.1L, 0.2L, 0.3L}, F{};
        if (frame > 0) {
          const auto& [x, weight] = rule[frame - 1];
          const Real share = weight * 0.5L * (1 + x);
          k = {0.4L * share, 3 * share, 2 * share, 0, 0, 0};
        }
        for (std::size_t i = 0; i < 6; ++i) F[i] = -k[i] * std::abs(v[i]) * v[i];
        return F;
      },
      GroupKind::SE3, true);
  expect_mechanics_of(w);
}

// Resistive force theory on a rigid rod of length l along x, integrated by hand about its middle:
// F = -l c v, torque = -l^3/12 (0, c_z Omega_y, c_y Omega_z).
TEST(Resistance, OfARodIsThatOfTheIntegral) {
  Witness w = base_and_hinge(
      "[[fluid]]\nbody = \"base\"\npoint = [0.3, 0.1, 0]\nresistance = [0.5, 0.5, 0.5, 0.2, 0, 0.1]\n"
      "[[fluid]]\nbody = \"hinge\"\nfrom = [-0.2, 0.1, 0]\nto = [0.6, 0.1, 0]\nsections = 2\n"
      "resistance = [0.7, 1.4, 1.3]\n",
      {{0.3L, 0.1L, 0}}, {{0.2L, 0.1L, 0}});
  load(
      w,
      [](std::size_t frame, const std::array<Real, 6>& v) {
        std::array<Real, 6> c = {0.5L, 0.5L, 0.5L, 0.2L, 0, 0.1L}, F{};
        const Real l = 0.8L;
        if (frame > 0) c = {0.7L * l, 1.4L * l, 1.3L * l, 0, 1.3L * l * l * l / 12, 1.4L * l * l * l / 12};
        for (std::size_t i = 0; i < 6; ++i) F[i] = -c[i] * v[i];
        return F;
      },
      GroupKind::SE3, true);
  expect_mechanics_of(w);
}

// Resistance is linear in the velocities of the sections as their momenta are: with equal figures its force
// is minus the mass matrix of the added mass, which has a witness above, times the velocities.
TEST(Resistance, AlongABeamActsOnItsSections) {
  const std::string bodies =
      header("SE3") + body("base", "", cloud(0)) +
      body("tail", "base", {},
           "pose = { translation = [0.2, -0.1, 0.3], rotation = { axis = \"z\", angle = 0.7 } }\n"
           "joint = { kind = \"revolute\", axis = [0, -0.28, 0.96], coordinate = \"a\" }\n"
           "[body.beam]\nlength = 0.8\nmass_per_length = 0.3\nbending_stiffness = 1.4\nmodes = 2\n"
           "planes = [\"y\", \"z\"]\nrange = [-0.5, 0.5]\n");
  const auto mechanism_with = [&](const std::string& fluid) {
    return mechanise<Real>(describe_mechanism(read_model_text(bodies + fluid, "tail.toml")), {});
  };
  const std::string place = "[[fluid]]\nbody = \"tail\"\nto = 0.9\nsections = 3\nprofile = \"1 + x\"\n";
  const Mechanism<Real> bare = mechanism_with(""),
                        heavy = mechanism_with(place + "added_mass = [0.4, 1.1, 0.8]\n"),
                        slow = mechanism_with(place + "resistance = [0.4, 1.1, 0.8]\n");
  FreeDynamics<Real> of_bare(bare), of_heavy(heavy), of_slow(slow);
  const Model model = read_model_text(bodies, "tail.toml");
  std::mt19937_64 rng(20260204);
  BlockErrors errors;
  for (int sample = 0; sample < 100; ++sample) {
    const State<Real> s = random_position_and_velocity(model, rng);
    const std::vector<Real> v = velocity(GroupKind::SE3, s);
    const Matrix<Real> with = of_heavy.mass_matrix(s), without = of_bare.mass_matrix(s);
    const std::vector<Real> force = of_slow.forces(s), inertial = of_bare.forces(s);
    std::vector<Real> want(v.size(), 0), have;
    Real power = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      for (std::size_t j = 0; j < v.size(); ++j) {
        const int row = static_cast<int>(i), column = static_cast<int>(j);
        want[i] -= (with(row, column) - without(row, column)) * v[j];
      }
      power -= want[i] * v[i];
      have.push_back(force[i] - inertial[i]);
    }
    errors.add("resistance", want, have);
    errors.add("dissipated power", {power}, std::vector{of_slow.energies(s).dissipated_power});
  }
  errors.expect_below(1e-16L);  // differences of forces some hundred times larger, of half an ulp of 5.4e-20
}

TEST(Wake, PushesForwardByHalfItsEnergyPerLengthAndTakesItsMomentum) {
  Witness w = base_and_hinge(
      "[[fluid]]\nbody = \"base\"\npoint = [-0.4, 0.1, 0]\nwake = { added_mass = [0.8, 0.5], forward = \"x\" "
      "}\n[[fluid]]\nbody = \"hinge\"\npoint = [0.7, 0, 0]\nwake = { added_mass = [0.6, 0], forward = \"-x\" "
      "}\n",
      {{-0.4L, 0.1L, 0}}, {{0.7L, 0, 0}});
  load(
      w,
      [](std::size_t frame, const std::array<Real, 6>& v) {
        const Real m_y = frame == 0 ? 0.8L : 0.6L, m_z = frame == 0 ? 0.5L : 0, sign = frame == 0 ? 1 : -1;
        const Real u = sign * v[0];
        return std::array<Real, 6>{
            sign * (m_y * v[1] * v[1] + m_z * v[2] * v[2]) / 2, -m_y * u * v[1], -m_z * u * v[2], 0, 0, 0};
      },
      GroupKind::SE3, false);
  expect_mechanics_of(w);
}

// A straight slender body that moves steadily at an incidence: added mass gives Munk's couple and no force,
// the wake the lift m u w; together they act at the nose, where the added mass grows (Jones 1946).
TEST(Wake, GivesASlenderBodyTheLiftOfJonesAtItsNose) {
  const Model model = read_model_text(
      header("SE3") + body("body", "", cloud(0)) +
          "[[fluid]]\nbody = \"body\"\nfrom = [-0.6, 0, 0]\nto = [0.4, 0, 0]\nadded_mass = [0, 1.3, 0]\n"
          "[[fluid]]\nbody = \"body\"\npoint = [-0.6, 0, 0]\nwake = { added_mass = [1.3, 0], forward = \"x\" "
          "}\n",
      "slender.toml");
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), {});
  FreeDynamics<double> dynamics(mechanism);
  State<double> s;
  const double u = 2, v = 0.3;
  s.eta.linear = {u, v, 0};
  const std::vector<double> f = dynamics.forces(s);  // at constant V nothing else needs a force
  const double m = 1.3;
  EXPECT_NEAR(f[0], m * v * v / 2, 1e-15);
  EXPECT_NEAR(f[1], -m * u * v, 1e-15);
  EXPECT_NEAR(f[5] - 0.4 * f[1], 0, 1e-15);  // moment about the nose at x = 0.4: a few roundings of 0.8
}

// Velocities of the point in a written force, in the axes of the body and of the world.
TEST(LocalVelocity, IsThatOfThePointInTheAxesOfTheForce) {
  Witness w = base_and_hinge(
      "[[force]]\nbody = \"base\"\npoint = [0.1, 0.2, 0.3]\ndissipative = true\n"
      "force = [\"-2*v_x\", \"-3*v_y*sqrt(v_y^2 + v_z^2 + 1e-4)\", 0]\ntorque = [0, 0, \"-0.5*omega_z\"]\n"
      "[[force]]\nbody = \"hinge\"\npoint = [0.4, 0, -0.1]\naxes = \"world\"\n"
      "force = [\"-1*v_y\", \"1*v_x - 2*v_z\", 0]\ntorque = [\"1*omega_y\", 0, \"-1*omega_x*v_x\"]\n",
      {{0.1L, 0.2L, 0.3L}}, {{0.4L, 0, -0.1L}});
  w.loads = [](const Sample&, const std::vector<Pose>& frames) {
    const std::array<Real, 6> v = own_velocity(frames[0]);
    const Vector drag = {-2 * v[0], -3 * v[1] * std::sqrt(v[1] * v[1] + v[2] * v[2] + 1e-4L), 0};
    const auto turn = angular_velocity(frames[1]);
    const Vector& p = frames[1].p;
    return std::vector<Load>{{world(frames[0], drag), world(frames[0], {0, 0, -0.5L * v[5]})},
                             {{-p[1].d, p[0].d - 2 * p[2].d, 0}, {turn[1], 0, -turn[0] * p[0].d}}};
  };
  w.dissipated_power = [frames_at = w.loaded_frames](const Sample& sample) {
    const std::vector<Real> rates = velocity(GroupKind::SE3, sample.state);
    const Path moving = path(GroupKind::SE3, sample.state, rates, std::vector<Real>(rates.size(), 0));
    const std::array<Real, 6> v = own_velocity(frames_at(moving.g, moving.r)[0]);
    return 2 * v[0] * v[0] + 3 * v[1] * v[1] * std::sqrt(v[1] * v[1] + v[2] * v[2] + 1e-4L) +
           0.5L * v[5] * v[5];
  };
  expect_mechanics_of(w);
}

// ---- a body in an ideal fluid

/// Lamb's integrals alpha_i = abc int_0^inf dx/((a_i^2 + x) sqrt((a^2 + x)(b^2 + x)(c^2 + x))), by x =
/// s^2/(1 - s^2).
std::array<Real, 3> lamb_integrals(const std::array<Real, 3>& a) {
  std::array<Real, 3> alpha{};
  for (const auto& [s, w] : gauss_legendre(200)) {
    const Real rest = 1 - s * s, x = s * s / rest;
    const Real root = std::sqrt((a[0] * a[0] + x) * (a[1] * a[1] + x) * (a[2] * a[2] + x));
    for (std::size_t i = 0; i < 3; ++i)
      alpha[i] += w * 2 * s / (rest * rest) * a[0] * a[1] * a[2] / ((a[i] * a[i] + x) * root);
  }
  return alpha;
}

struct Ellipsoid {
  std::array<Real, 3> added, added_inertia, inertia;
  Real mass;
};
/// Lamb, Hydrodynamics, 6th ed., arts. 114 and 115; of the density of the fluid.
Ellipsoid ellipsoid(const std::array<Real, 3>& a, Real density) {
  const std::array<Real, 3> alpha = lamb_integrals(a);
  Ellipsoid e{};
  e.mass = density * 4 * M_PIl / 3 * a[0] * a[1] * a[2];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const Real b2 = a[j] * a[j], c2 = a[k] * a[k];
    e.added[i] = e.mass * alpha[i] / (2 - alpha[i]);
    e.inertia[i] = e.mass * (b2 + c2) / 5;
    const Real turn = alpha[k] - alpha[j];
    e.added_inertia[i] = e.mass / 5 * (b2 - c2) * (b2 - c2) * turn / (2 * (b2 - c2) + (b2 + c2) * -turn);
  }
  return e;
}

// A ball has half its mass; of the prolate spheroid a = 2 b the integrals have a closed form (art. 114).
TEST(Ellipsoid, HasTheInertiaCoefficientsOfBallAndSpheroid) {
  const Real apart = 1e-7L;  // of two axes, so that no quotient is 0/0; changes the rest by as much
  const Ellipsoid ball = ellipsoid({1, 1 + apart, 1 - apart}, 1);
  for (const Real m : ball.added) EXPECT_NEAR(static_cast<double>(m / ball.mass), 0.5, 1e-6);
  const Ellipsoid egg = ellipsoid({2, 1 + apart, 1 - apart}, 1);
  const Real e = std::sqrt(3.0L) / 2, root = std::log((1 + e) / (1 - e)), rest = (1 - e * e) / (e * e * e);
  const Real alpha = 2 * rest * (root / 2 - e), beta = 1 / (e * e) - rest * root / 2;
  const Real turn =
      std::pow(e, 4) * (beta - alpha) / ((2 - e * e) * (2 * e * e - (2 - e * e) * (beta - alpha)));
  EXPECT_NEAR(static_cast<double>(egg.added[0] / egg.mass), static_cast<double>(alpha / (2 - alpha)), 1e-6);
  EXPECT_NEAR(static_cast<double>(egg.added[1] / egg.mass), static_cast<double>(beta / (2 - beta)), 1e-6);
  EXPECT_NEAR(static_cast<double>(egg.added_inertia[1] / egg.inertia[1]), static_cast<double>(turn), 1e-6);
}

// Neutrally buoyant under gravity, so that nothing but the fluid's pressure acts: T, the impulse and its
// moment about the world's origin stay what they are. Classical Runge-Kutta in long double, by
// steps of 1 ms; its error over 10 s is some 3e-13 of the motion, by steps of 2.5 ms it is 1e-11.
TEST(Ellipsoid, KeepsItsEnergyAndItsImpulses) {
  const Ellipsoid e = ellipsoid({0.5L, 0.3L, 0.2L}, 1000);
  const auto list = [](const std::array<Real, 3>& x) {
    return fmt::format("{:.20g}, {:.20g}, {:.20g}", x[0], x[1], x[2]);
  };
  const std::string text =
      header("SE3", "gravity = [0, 0, -9.81]") +
      fmt::format(
          "[[body]]\nname = \"ellipsoid\"\ninertia = {{ mass = {:.20g}, about_com = "
          "{{ xx = {:.20g}, yy = {:.20g}, zz = {:.20g} }} }}\n[[fluid]]\nbody = "
          "\"ellipsoid\"\nadded_mass = [{}, {}]\ndisplaced_mass = {:.20g}\n",
          e.mass, e.inertia[0], e.inertia[1], e.inertia[2], list(e.added), list(e.added_inertia), e.mass);
  const Mechanism<Real> mechanism =
      mechanise<Real>(describe_mechanism(read_model_text(text, "ellipsoid.toml")), {});
  FreeDynamics<Real> dynamics(mechanism);
  using Twelve = std::array<Real, 18>;  // R, p, V, Omega
  const auto state = [](const Twelve& y) {
    State<Real> s;
    for (std::size_t i = 0; i < 9; ++i) s.R.m[i] = y[i];
    for (int i = 0; i < 3; ++i) s.p[i] = y[static_cast<std::size_t>(9 + i)];
    for (int i = 0; i < 6; ++i) s.eta[i] = y[static_cast<std::size_t>(12 + i)];
    return s;
  };
  const Matrix<Real> M = dynamics.mass_matrix(state({1, 0, 0, 0, 1, 0, 0, 0, 1}));  // of every pose
  const auto rate = [&](const Twelve& y) {
    const State<Real> s = state(y);
    const std::vector<Real> f = dynamics.forces(s);
    const Mat3<Real> R_dot = s.R * skew(s.eta.angular);
    const Vec3<Real> p_dot = s.R * s.eta.linear;
    Twelve d{};
    for (std::size_t i = 0; i < 9; ++i) d[i] = R_dot.m[i];
    for (int i = 0; i < 3; ++i) d[static_cast<std::size_t>(9 + i)] = p_dot[i];
    for (int i = 0; i < 6; ++i)  // axes of symmetry: M is diagonal
      d[static_cast<std::size_t>(12 + i)] = f[static_cast<std::size_t>(i)] / M(i, i);
    return d;
  };
  struct Kept {
    Real T;
    Vec3<Real> P, H;
  };
  const auto kept = [&](const Twelve& y) {  // written here from Lamb's coefficients alone
    const State<Real> s = state(y);
    Vec3<Real> p, h;
    Real T = 0;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      p[i] = (e.mass + e.added[k]) * s.eta.linear[i];
      h[i] = (e.inertia[k] + e.added_inertia[k]) * s.eta.angular[i];
      T += (p[i] * s.eta.linear[i] + h[i] * s.eta.angular[i]) / 2;
    }
    return Kept{T, s.R * p, s.R * h + cross(s.p, s.R * p)};
  };
  Twelve y = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.3L, -0.2L, 0.5L, 0.4L, 0.15L, -0.1L, 0.7L, 1.1L, -0.5L};
  const Kept start = kept(y);
  const Real h = 0.001L;
  const auto ahead = [](const Twelve& at, const Twelve& k, Real by) {
    Twelve r = at;
    for (std::size_t i = 0; i < r.size(); ++i) r[i] += by * k[i];
    return r;
  };
  double turned = 0;
  for (int step = 0; step < 10000; ++step) {
    const Twelve k1 = rate(y), k2 = rate(ahead(y, k1, h / 2)), k3 = rate(ahead(y, k2, h / 2)),
                 k4 = rate(ahead(y, k3, h));
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    turned = std::max(turned, static_cast<double>(std::abs(y[1])));
  }
  EXPECT_GT(turned, 0.5);  // it tumbles
  const Kept end = kept(y);
  const auto size = [](const Vec3<Real>& v) { return std::sqrt(dot(v, v)); };
  EXPECT_LT(static_cast<double>(std::abs(end.T - start.T) / start.T), 1e-12);
  EXPECT_LT(static_cast<double>(size(end.P - start.P) / size(start.P)), 1e-12);
  EXPECT_LT(static_cast<double>(size(end.H - start.H) / size(start.H)), 1e-12);
}

}  // namespace
}  // namespace anholon::fluid_test
