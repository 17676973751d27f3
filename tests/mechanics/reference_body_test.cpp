// SPDX-License-Identifier: GPL-2.0-or-later
//
// Which body of a tree is its reference body, and in which order bodies and coordinates are numbered, is
// anybody's choice: motions, torques and contact forces stay what they are. Each robot is described twice,
// from two bodies that rigid bodies and joints connect; states and accelerations are carried over by
// homogeneous transforms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "check/evaluate_program.hpp"
#include "describe/read_model.hpp"
#include "mechanics/witness.hpp"

namespace anholon::reference_body_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

using Numbers = std::array<double, 3>;

/// A body behind its pose on the parent and a joint; `coordinate` is empty where it is fixed.
struct Part {
  std::string name;
  int parent;
  Numbers offset, turn_axis;  // the axis of `turn` is a coordinate axis
  double turn;
  Numbers axis;
  std::string coordinate, joint, rest;  // further keys of the joint, lines of the body
};

struct Robot {
  std::string name, head;  // up to the first body
  std::vector<Part> parts;
  std::string tail;  // behind the last body
  int other;         // the second reference body; all parts between are rigid
};
void PrintTo(const Robot& robot, std::ostream* stream) { *stream << robot.name; }

std::string list(const Numbers& v, double sign = 1) {
  return fmt::format("[{}, {}, {}]", sign * v[0], sign * v[1], sign * v[2]);
}
std::string turn_of(const Part& p, double sign) {
  const char axis = p.turn_axis[0] != 0 ? 'x' : p.turn_axis[1] != 0 ? 'y' : 'z';
  return fmt::format("rotation = {{ axis = \"{}\", angle = {} }}", axis, sign * p.turn);
}
std::string joint_of(const Part& p, double sign) {
  if (p.coordinate.empty()) return "joint = { kind = \"fixed\" }\n";
  return fmt::format("joint = {{ kind = \"revolute\", axis = {}, coordinate = \"{}\"{} }}\n",
                     list(p.axis, sign), p.coordinate, p.joint);
}
std::string opened(const std::string& name, const std::string& parent) {
  return fmt::format("[[body]]\nname = \"{}\"\n", name) +
         (parent.empty() ? "" : fmt::format("parent = \"{}\"\n", parent));
}

/// The bodies of a robot from part `at` on, depth first, without going back to `from`. An edge that is walked
/// from the child to the parent is undone: g_parent = g_child R(axis, -r) R(turn)^-1 T(offset)^-1.
/// @param last_first  order of the branches
void describe(const Robot& robot, int at, int from, bool last_first, std::string& text) {
  const auto part = [&](int i) -> const Part& { return robot.parts[static_cast<std::size_t>(i)]; };
  std::vector<int> next;
  for (int i = 0; i < static_cast<int>(robot.parts.size()); ++i) {
    if (i != from && (part(i).parent == at || part(at).parent == i)) next.push_back(i);
  }
  if (last_first) std::ranges::reverse(next);
  for (const int i : next) {
    const Part& p = part(i);
    if (p.parent == at) {
      text += opened(p.name, part(at).name) +
              fmt::format("pose = {{ translation = {}, {} }}\n", list(p.offset), turn_of(p, 1)) +
              joint_of(p, 1) + p.rest;
    } else {
      const Part& edge = part(at);
      text += opened(p.name + "_hinge", edge.name) + joint_of(edge, -1);
      text += opened(p.name + "_turned", p.name + "_hinge") +
              fmt::format("pose = {{ {} }}\n", turn_of(edge, -1)) + "joint = { kind = \"fixed\" }\n";
      text += opened(p.name, p.name + "_turned") +
              fmt::format("pose = {{ translation = {} }}\n", list(edge.offset, -1)) +
              "joint = { kind = \"fixed\" }\n" + p.rest;
    }
    describe(robot, i, at, last_first, text);
  }
}

Model described(const Robot& robot, int root, bool last_first) {
  std::string text = robot.head + opened(robot.parts[static_cast<std::size_t>(root)].name, "") +
                     robot.parts[static_cast<std::size_t>(root)].rest;
  describe(robot, root, -1, last_first, text);
  return read_model_text(text + robot.tail, robot.name + ".toml");
}

/// The other reference body along a motion of the first one.
Pose carried(const Robot& robot, const Model& model, const Path& motion) {
  std::vector<int> way;
  for (int i = robot.other; i > 0; i = robot.parts[static_cast<std::size_t>(i)].parent) way.push_back(i);
  Pose g = motion.g;
  for (auto i = way.rbegin(); i != way.rend(); ++i) {
    const Part& p = robot.parts[static_cast<std::size_t>(*i)];
    g = g * moved({p.offset[0], p.offset[1], p.offset[2]}) *
        turned({p.turn_axis[0], p.turn_axis[1], p.turn_axis[2]}, Real(p.turn));
    if (p.coordinate.empty()) continue;
    const auto c = std::ranges::find(model.coordinates, p.coordinate, &Coordinate::name);
    g = g * turned({p.axis[0], p.axis[1], p.axis[2]},
                   motion.r[static_cast<std::size_t>(c - model.coordinates.begin())]);
  }
  return g;
}

/// Twist of a moving frame in its own axes, and the rate of its components.
std::pair<std::array<Real, 6>, std::array<Real, 6>> twist(const Pose& g) {
  std::array<Real, 6> eta{}, eta_dot{};
  const auto w = angular_velocity(g), wd = angular_acceleration(g);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      eta[i] += g.R[k][i].x * g.p[k].d, eta[3 + i] += g.R[k][i].x * w[k];
      eta_dot[i] += g.R[k][i].x * g.p[k].dd + g.R[k][i].d * g.p[k].d, eta_dot[3 + i] += g.R[k][i].x * wd[k];
    }
  }
  return {eta, eta_dot};
}

/// A description with its program in double.
struct Runner {
  Model model;
  Partition partition;
  std::unique_ptr<Derivation> derivation;
  ProgramCaller<double> call;
  explicit Runner(Model m) : model(std::move(m)), partition(partition_of(model)) {
    DeriveRequest request;
    request.closed_forms = false;
    derivation = derive(model, request);
    call = interpreting_caller<double>(derivation->program, {});
  }
  [[nodiscard]] Evaluated<double> evaluate(const EvaluationInput<double>& input) const {
    return evaluate_program(model, *derivation, call, input);
  }
  [[nodiscard]] std::size_t index(const std::string& coordinate) const {
    return static_cast<std::size_t>(std::ranges::find(model.coordinates, coordinate, &Coordinate::name) -
                                    model.coordinates.begin());
  }
};

/// What a motion is, by the names of coordinates: velocities and accelerations of the first reference body
/// come first.
using Named = std::map<std::string, double>;

Named named(const Runner& of, const std::vector<double>& active, const char* prefix) {
  Named values;
  for (std::size_t i = 0; i < active.size(); ++i)
    values[prefix +
           of.model.coordinates[static_cast<std::size_t>(of.partition.active[i] - of.partition.n)].name] =
        active[i];
  return values;
}

State<Real> lengthened(const State<double>& s) {
  State<Real> l;
  for (std::size_t i = 0; i < 9; ++i) l.R.m[i] = s.R.m[i];
  for (int i = 0; i < 3; ++i) l.p[i] = s.p[i];
  for (int i = 0; i < 6; ++i) l.eta[i] = s.eta[i];
  l.r.assign(s.r.begin(), s.r.end()), l.r_dot.assign(s.r_dot.begin(), s.r_dot.end());
  return l;
}

class AnyReferenceBody : public testing::TestWithParam<Robot> {};

/// Accelerations of one description seen from another, by name; `motion` is that of the other reference body.
void compare(const Runner& from, const Runner& to, const std::vector<double>& have,
             const std::vector<double>& want, const std::array<Real, 6>& eta_dot, const char* what) {
  const auto components = free_components(to.model.group);
  double size = 1e-3;
  for (const double x : want) size = std::max(size, std::abs(x));
  const double bound =
      1e-11 * size;  // the bound: a few hundred roundings, in systems of condition 100
  for (std::size_t i = 0; i < components.size(); ++i)
    EXPECT_NEAR(have[i], static_cast<double>(eta_dot[static_cast<std::size_t>(components[i])]), bound)
        << what << ", eta_dot " << i;
  for (const Coordinate& c : from.model.coordinates)
    EXPECT_NEAR(have[components.size() + to.index(c.name)], want[components.size() + from.index(c.name)],
                bound)
        << what << ", " << c.name;
}

TEST_P(AnyReferenceBody, MovesAndPushesTheSame) {
  const Robot robot = GetParam();
  const Runner first(described(robot, 0, false));
  const Runner renumbered(described(robot, 0, true)), shifted(described(robot, robot.other, false)),
      both(described(robot, robot.other, true));
  ASSERT_EQ(first.model.coordinates.size(), both.model.coordinates.size());
  std::mt19937_64 rng(6);
  const auto uniform = [&](double bound) {
    return std::uniform_real_distribution<double>(-bound, bound)(rng);
  };
  const auto components = free_components(first.model.group);
  const std::size_t n = components.size();
  for (int sample = 0; sample < 10; ++sample) {
    EvaluationInput<double> input;
    input.state = rounded(random_position_and_velocity(first.model, rng));
    for (std::size_t i = 0; i < first.model.coordinates.size(); ++i) {
      if (!first.model.coordinates[i].is_angle) input.state.r[i] *= 0.2;  // deflections to 0.1 m
    }
    NamedValues<double> in = position_inputs(first.model, first.partition, input.state);
    for (const int a : first.partition.active)
      in["r_a_dot"].push_back(input.state.r_dot[static_cast<std::size_t>(a - first.partition.n)]);
    for (int k = 0; k < first.derivation->reduction.kernel.H.cols(); ++k) in["nu"].push_back(uniform(2));
    NamedValues<double> v = first.call("kinematics", in);  // admissible velocities
    for (std::size_t i = 0; i < n; ++i) input.state.eta[components[i]] = v["eta"][i];
    for (std::size_t i = 0; i < v["r_p_dot"].size(); ++i)
      input.state.r_dot[static_cast<std::size_t>(first.partition.passive[n + i] - first.partition.n)] =
          v["r_p_dot"][i];
    input.has_acceleration = input.has_torque = true;
    input.r_ddot.assign(first.model.coordinates.size(), 0);
    input.tau = input.r_ddot;
    for (const int a : first.partition.active) {
      input.r_ddot[static_cast<std::size_t>(a - first.partition.n)] = uniform(3);
      input.tau[static_cast<std::size_t>(a - first.partition.n)] = uniform(1);
    }
    const Evaluated<double> want = first.evaluate(input);
    const State<Real> state = lengthened(input.state);
    std::vector<Real> velocities = velocity(first.model.group, state);
    const auto along = [&](const std::vector<double>& acceleration) {
      return path(first.model.group, state, velocities,
                  std::vector<Real>(acceleration.begin(), acceleration.end()));
    };
    for (const Runner* other : {&renumbered, &shifted, &both}) {
      const bool is_shifted = other != &renumbered;
      const auto pose = [&](const std::vector<double>& acceleration) {
        const Path motion = along(acceleration);
        return is_shifted ? carried(robot, first.model, motion) : motion.g;
      };
      EvaluationInput<double> there = input;
      const Pose g = pose(want.acceleration);
      const auto [eta, eta_dot] = twist(g);
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) there.state.R.m[3 * i + k] = static_cast<double>(g.R[i][k].x);
        there.state.p[static_cast<int>(i)] = static_cast<double>(g.p[i].x);
      }
      for (std::size_t i = 0; i < 6; ++i) there.state.eta[static_cast<int>(i)] = static_cast<double>(eta[i]);
      for (const Coordinate& c : first.model.coordinates) {
        const std::size_t i = first.index(c.name), k = other->index(c.name);
        there.state.r[k] = input.state.r[i], there.state.r_dot[k] = input.state.r_dot[i];
        there.r_ddot[k] = input.r_ddot[i], there.tau[k] = input.tau[i];
      }
      const Evaluated<double> have = other->evaluate(there);
      compare(first, *other, have.acceleration, want.acceleration, eta_dot, "motion imposed");
      compare(first, *other, have.free_acceleration, want.free_acceleration,
              twist(pose(want.free_acceleration)).second, "torques imposed");
      const Named tau = named(*other, have.tau_a, "tau_");
      double size = 1e-3;
      for (const double x : want.tau_a) size = std::max(size, std::abs(x));
      for (const auto& [name, value] : named(first, want.tau_a, "tau_"))
        EXPECT_NEAR(tau.at(name), value, 1e-11 * size) << name;
      ASSERT_EQ(have.lambda.size(), want.lambda.size());
      size = 1e-3;
      for (const double x : want.lambda) size = std::max(size, std::abs(x));
      for (std::size_t i = 0; i < want.lambda.size(); ++i)
        EXPECT_NEAR(have.lambda[i], want.lambda[i], 1e-11 * size) << first.model.rows[i].name;
      EXPECT_NEAR(have.kinetic, want.kinetic, 1e-12 * want.kinetic);
    }
  }
}

const Numbers none = {0, 0, 0}, X = {1, 0, 0}, Y = {0, 1, 0}, Z = {0, 0, 1}, oblique = {0, -0.28, 0.96};
const std::string active = ", drive = \"active\"";

std::string of_cloud(std::size_t i) { return "inertia = " + inertia(cloud(i)) + "\n"; }
std::string of_plane(double mass, double x, double J) {
  return fmt::format("inertia = {{ mass = {}, com = [{}, 0, 0], about_com = {{ zz = {} }} }}\n", mass, x, J);
}
std::string of_beam(double L, double EI, int modes, const std::string& planes,
                    const std::string& deformation) {
  return fmt::format(
      "[body.beam]\nlength = {}\nmass_per_length = 0.8\nbending_stiffness = {}\nmodes = {}\nplanes = "
      "{}\ndeformation = "
      "\"{}\"\nmodal_damping = 0.03\nrange = [-0.1, 0.1]\n",
      L, EI, modes, planes, deformation);
}

INSTANTIATE_TEST_SUITE_P(
    Robots, AnyReferenceBody,
    testing::Values(
        Robot{"FreeTree",
              header("SE3", "gravity = [0.6, -3.1, -8.8]"),
              {{"base", -1, none, Z, 0, Z, "", "", of_cloud(0)},
               {"arm", 0, {0.2, -0.1, 0.3}, Z, 0.7, oblique, "a", active, of_cloud(1)},
               {"forearm", 1, {0.4, 0, 0.1}, X, -0.4, Y, "b", ", stiffness = 2, damping = 0.1", of_cloud(2)},
               {"tail", 0, {-0.3, 0.1, 0}, Y, 1.1, Z, "c", active, of_cloud(1)}},
              "",
              2},
        Robot{"CartWithATrailer",
              header("SE2"),
              {{"cart", -1, none, Z, 0, Z, "", "", of_plane(5, 0.08, 0.21)},
               {"hitched", 0, {-0.12, 0, 0}, Z, 0, Z, "r1", ", damping = 0.02", of_plane(2.5, -0.35, 0.06)},
               {"rotor", 0, none, Z, 0, Z, "r2", active, "inertia = { about_com = { zz = 0.05 } }\n"}},
              "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"cart\"\n"
              "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"hitched\"\npoint = [-0.4, 0, 0]\n",
              1},
        Robot{"SoftSnakeBoard",
              header("SE2"),
              {{"platform", -1, none, Z, 0, Z, "", "", of_plane(6, 0, 0.15)},
               {"rear_axle", 0, {-0.25, 0, 0}, Z, 0, Z, "r1", active, of_plane(0.5, 0, 0.012)},
               {"front_axle", 0, {0.25, 0, 0}, Z, 0, Z, "r2", "", of_plane(0.5, 0, 0.012)},
               {"hub", 0, none, Z, 0, Z, "r3", active, "inertia = { about_com = { zz = 0.004 } }\n"},
               {"beam_3", 3, none, Z, 0, Z, "", "", of_beam(0.5, 0.9, 2, "\"y\"", "quadratic")},
               {"beam_4", 3, none, Z, 3.14159, Z, "", "", of_beam(0.5, 0.9, 1, "\"y\"", "stiffened")}},
              "[[coupling]]\ncoordinate = \"r2\"\nequals = \"-r1\"\n"
              "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"rear_axle\"\n"
              "[[constraint]]\nkind = \"no_lateral_slip\"\nbody = \"front_axle\"\n",
              3},
        Robot{
            "SpacecraftWithBeams",
            header("SE3", "gravity = [0.6, -3.1, -8.8]"),
            {{"bus", -1, none, Z, 0, Z, "", "", of_cloud(0)},
             {"yoke", 0, {0.1, 0.2, -0.1}, X, 0.5, oblique, "a", active, of_cloud(1)},
             {"mast", 0, {-0.3, 0, 0}, Z, 0.9, Z, "", "", of_beam(0.9, 2, 1, "[\"y\", \"z\"]", "stiffened")},
             {"hand", 2, {0.05, 0, 0.02}, Y, 0.3, X, "b", "", of_cloud(2)},
             {"array", 1, {0, 0.2, 0}, Z, 1.2, Z, "", "", of_beam(0.7, 1.5, 2, "\"z\"", "stiffened")}},
            "",
            1}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace anholon::reference_body_test
