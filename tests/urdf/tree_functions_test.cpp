// SPDX-License-Identifier: GPL-2.0-or-later

// The derived functions against the numeric recursion on the mechanism as described, in double and in exact
// numbers.

#include "derive/tree_functions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_robot.hpp"
#include "optimise/tape/count.hpp"
#include "urdf/random_state.hpp"
#include "urdf/small_robots.hpp"

namespace anholon::tree_functions_test {
namespace {

using testing::random_state;
using testing::RandomState;
using testing::run;

/// Largest difference, in parts of the largest entry of the reference.
template <class S>
S error(const std::vector<S>& got, const std::vector<S>& reference) {
  using std::abs;
  EXPECT_EQ(got.size(), reference.size());
  S worst = S(0), scale = S(1);
  for (std::size_t i = 0; i < std::min(got.size(), reference.size()); ++i) {
    if (abs(got[i] - reference[i]) > worst) worst = abs(got[i] - reference[i]);
    if (abs(reference[i]) > scale) scale = abs(reference[i]);
  }
  return worst / scale;
}

/// Compares every function with the recursion; forward dynamics by putting its answer into the recursion.
template <class S>
void compare(const Mechanism<S>& mechanism, const Program& program, const RandomState<S>& x,
             const S& tolerance) {
  FreeDynamics<S> dynamics(mechanism);
  State<S> rest = x.state;
  rest.eta = {};
  for (S& rate : rest.r_dot) rate = S(0);
  const std::vector<S> zero(x.acceleration.size(), S(0));
  EXPECT_LT(
      error(run(program, "inverse_dynamics", x.inputs), dynamics.inverse_dynamics(x.state, x.acceleration)),
      tolerance);
  EXPECT_LT(error(run(program, "bias_forces", x.inputs), dynamics.inverse_dynamics(x.state, zero)),
            tolerance);
  EXPECT_LT(error(run(program, "gravity_forces", x.inputs), dynamics.inverse_dynamics(rest, zero)),
            tolerance);
  EXPECT_LT(error(run(program, "mass_matrix", x.inputs), dynamics.mass_matrix(x.state).entries()), tolerance);
  const std::vector<S> applied =
      dynamics.inverse_dynamics(x.state, run(program, "forward_dynamics", x.inputs));
  std::vector<S> expected(applied.size() - x.tau.size(), S(0));
  expected.insert(expected.end(), x.tau.begin(), x.tau.end());
  const std::vector<S> M = dynamics.mass_matrix(x.state).entries();
  S largest = S(1);  // forces are sums of terms that large
  for (const S& a : run(program, "forward_dynamics", x.inputs)) {
    using std::abs;
    if (abs(a) > largest) largest = abs(a);
  }
  EXPECT_LT(error(applied, expected), S(20) * largest * tolerance);
}

void verify(const Model& model, const TreeRequest& request = {}) {
  const auto derivation = derive_tree(model, request);
  const Program& program = derivation->program;
  ASSERT_EQ(program.functions.size(),
            request.functions.empty() ? standard_tree_functions().size() : request.functions.size());
  const MechanismDescription description = describe_mechanism(model);
  std::vector<double> parameters;
  std::vector<Exact> exact_parameters;
  for (const Parameter& p : model.parameters)
    parameters.push_back(p.value.to_double()), exact_parameters.push_back(p.value);
  const Mechanism<double> mechanism = mechanise<double>(description, parameters);
  std::mt19937 random(7);
  for (int i = 0; i < 20; ++i)
    compare(mechanism, program, random_state<double>(program, random, [](double v) { return v; }), 1e-13);
  const Mechanism<Exact> exact = mechanise<Exact>(description, exact_parameters);
  const auto in_exact = [](double v) { return Exact::from_double(v); };
  // compensated constants are two doubles, whose rests are handed on to first order: 1e-32, times the terms
  compare(exact, program, random_state<Exact>(program, random, in_exact), Exact::from_decimal("1e-30"));
  TreeRequest not_compensated = request;
  not_compensated.optimise = OptimiseFor::speed;
  const auto plain = derive_tree(model, not_compensated);
  compare(exact, plain->program, random_state<Exact>(plain->program, random, in_exact),
          Exact::from_decimal("1e-60"));
}

TEST(TreeFunctions, ArmWithEveryKindOfJoint) { verify(read_robot_text(testing::serial_arm(), "arm.urdf")); }
TEST(TreeFunctions, ArmWithMimic) { verify(read_robot_text(testing::arm(), "arm.urdf")); }
TEST(TreeFunctions, WithoutSearch) {
  TreeRequest request;
  request.search = false;
  verify(read_robot_text(testing::serial_arm(), "arm.urdf"), request);
}
TEST(TreeFunctions, FloatingWalker) {
  RobotOptions options;
  options.floating = true;
  verify(read_robot_text(testing::walker(), "walker.urdf", options));
}
TEST(TreeFunctions, FloatingArm) {
  RobotOptions options;
  options.floating = true;
  verify(read_robot_text(testing::arm(), "arm.urdf", options));
}
TEST(TreeFunctions, SymbolicInertia) {
  RobotOptions options;
  options.floating = true;
  options.symbolic_inertia = true;
  verify(read_robot_text(testing::walker(), "walker.urdf", options));
}

/// The functions beyond the standard ones, on a branching robot with a free base and one that mimics.
void verify_others(const Model& model) {
  TreeRequest request;
  request.functions = tree_function_names();
  const auto derivation = derive_tree(model, request);
  const Program& program = derivation->program;
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), std::vector<double>{});
  std::mt19937 random(5);
  const auto x = random_state<double>(program, random, [](double v) { return v; });
  FreeDynamics<double> dynamics(mechanism);
  const Matrix<double> M = dynamics.mass_matrix(x.state);
  const int n = M.rows();
  const auto as_matrix = [](const std::vector<double>& v, std::size_t from, int rows, int cols) {
    Matrix<double> m(rows, cols);
    for (int i = 0; i < rows * cols; ++i) m(i / cols, i % cols) = v[from + static_cast<std::size_t>(i)];
    return m;
  };

  const std::vector<double> factor = run(program, "mass_factor", x.inputs);
  const Matrix<double> L = as_matrix(factor, 0, n, n);
  Matrix<double> D(n, n);
  for (int i = 0; i < n; ++i) D(i, i) = factor[static_cast<std::size_t>(n * n + i)];
  EXPECT_LT(error((L.transposed() * D * L).entries(), M.entries()), 1e-13);
  Matrix<double> identity(n, n);
  for (int i = 0; i < n; ++i) identity(i, i) = 1;
  EXPECT_LT(error((M * as_matrix(run(program, "inverse_mass_matrix", x.inputs), 0, n, n)).entries(),
                  identity.entries()),
            1e-11);

  const auto energies = dynamics.energies(x.state);
  EXPECT_LT(error(run(program, "energies", x.inputs),
                  {energies.kinetic, energies.gravity, energies.elastic, energies.dissipated_power}),
            1e-13);
  std::vector<Mat3<double>> R;
  std::vector<Vec3<double>> p;
  dynamics.poses(x.state, R, p);
  std::vector<double> poses;
  for (std::size_t k = 0; k < R.size(); ++k) {
    poses.insert(poses.end(), R[k].m.begin(), R[k].m.end());
    for (int i = 0; i < 3; ++i) poses.push_back(p[k][i]);
  }
  EXPECT_LT(error(run(program, "forward_kinematics", x.inputs), poses), 1e-13);

  // momentum: sums over the bodies
  Recursion<double> recursion(mechanism);
  recursion.position(x.state);
  recursion.twists(x.state);
  Vec3<double> P, H, centre;
  double mass = 0;
  recursion.poses(x.state, R, p);
  for (std::size_t k = 0; k < R.size(); ++k) {
    const Body<double>& b = mechanism.bodies[k];
    const auto& m = recursion.motion(static_cast<int>(k));
    const Vec3<double> linear = R[k] * (b.mass * m.v + cross(m.w, b.first_moment));
    P += linear;
    H += R[k] * (cross(b.first_moment, m.v) + b.inertia * m.w) + cross(p[k], linear);
    centre += b.mass * p[k] + R[k] * b.first_moment;
    mass += b.mass;
  }
  centre = (1 / mass) * centre;
  H -= cross(centre, P);
  EXPECT_LT(error(run(program, "centroidal_momentum", x.inputs),
                  {P.x, P.y, P.z, H.x, H.y, H.z, centre.x, centre.y, centre.z}),
            1e-13);

  // the tips' twists and accelerations
  std::vector<double> velocity;
  for (const int c : free_components(mechanism.group)) velocity.push_back(x.state.eta[c]);
  velocity.insert(velocity.end(), x.state.r_dot.begin(), x.state.r_dot.end());
  Spatial<double> eta_dot;
  std::vector<double> r_ddot;
  scatter(mechanism, std::span<const double>(x.acceleration), eta_dot, r_ddot);
  recursion.accelerations(x.state, eta_dot, r_ddot, false);
  const std::vector<double> jacobians = run(program, "jacobians", x.inputs);
  std::size_t at = 0;
  for (std::size_t k = 0; k < mechanism.bodies.size(); ++k) {
    bool is_tip = true;
    for (const Body<double>& b : mechanism.bodies) is_tip = is_tip && b.parent != static_cast<int>(k);
    if (!is_tip) continue;
    const Matrix<double> J = as_matrix(jacobians, at, 6, n);
    at += static_cast<std::size_t>(6 * n);
    const auto& m = recursion.motion(static_cast<int>(k));
    const Mat3<double>& frame = mechanism.bodies[k].R_frame;
    const Vec3<double> v = transposed_times(frame, m.v), w = transposed_times(frame, m.w);
    EXPECT_LT(error(J * velocity, {v.x, v.y, v.z, w.x, w.y, w.z}), 1e-13);
    std::vector<double> rate = J * x.acceleration;
    for (std::size_t i = 0; i < 6; ++i) rate[i] += jacobians[at + i];
    at += 6;
    const Vec3<double> a = transposed_times(frame, m.a - cross(m.w, m.v)), wd = transposed_times(frame, m.wd);
    EXPECT_LT(error(rate, {a.x, a.y, a.z, wd.x, wd.y, wd.z}), 1e-13);
  }
  EXPECT_EQ(at, jacobians.size());
}

TEST(TreeFunctions, ALinkFixedToTheReferenceBodyHasAConstantJacobianAndNoBias) {
  RobotOptions options;
  options.floating = true;
  TreeRequest request;
  request.functions = {"jacobians"};
  const auto derivation = derive_tree(read_robot_text(testing::arm(), "arm.urdf", options), request);
  int seen = 0;
  for (const OutputBlock& b : derivation->program.functions.at(0).outputs) {
    if (b.name != "bias_mount" && b.name != "J_mount") continue;
    ++seen;
    for (const NodeId id : b.nodes) {
      EXPECT_TRUE(derivation->program.tape.is_constant(id)) << b.name;
      EXPECT_TRUE(b.name == "J_mount" || derivation->program.tape.is_zero(id));
    }
  }
  EXPECT_EQ(seen, 2);
}

TEST(TreeFunctions, OthersOfTheWalker) {
  RobotOptions options;
  options.floating = true;
  verify_others(read_robot_text(testing::walker(), "walker.urdf", options));
}
TEST(TreeFunctions, OthersOfTheArm) { verify_others(read_robot_text(testing::arm(), "arm.urdf")); }

TEST(TreeFunctions, RegressorTimesFiguresIsInverseDynamics) {
  RobotOptions options;
  options.floating = true;
  const Model model =
      read_robot_text(testing::walker(), "walker.urdf", options);  // no dampers, no fixed joints
  TreeRequest request;
  request.functions = {"inverse_dynamics", "regressor"};
  const auto derivation = derive_tree(model, request);
  std::mt19937 random(9);
  const auto x = random_state<double>(derivation->program, random, [](double v) { return v; });
  std::vector<double> figures;
  for (const BodyDescription& b : model.bodies) {
    const auto take = [&](const Expr& e) { figures.push_back(e.constant_value()->to_double()); };
    take(b.mass);
    for (const Expr& e : b.first_moment) take(e);
    for (const Expr& e : b.inertia) take(e);
  }
  const std::vector<double> Y = run(derivation->program, "regressor", x.inputs);
  const std::vector<double> forces = run(derivation->program, "inverse_dynamics", x.inputs);
  std::vector<double> product(forces.size(), 0.0);
  for (std::size_t i = 0; i < product.size(); ++i) {
    for (std::size_t j = 0; j < figures.size(); ++j) product[i] += Y[i * figures.size() + j] * figures[j];
  }
  EXPECT_LT(error(product, forces), 1e-13);
}

TEST(TreeFunctions, SearchNeverCostsOperations) {
  const Model model = read_robot_text(testing::walker(), "walker.urdf");
  TreeRequest plain;
  plain.search = false;
  const auto total = [](const TreeDerivation& d) {
    int sum = 0;
    for (const CandidateReport& c : d.candidates) sum += c.chosen ? c.operations : 0;
    return sum;
  };
  EXPECT_LE(total(*derive_tree(model)), total(*derive_tree(model, plain)));
}

TEST(TreeFunctions, TraceEndsWithWhatIsKeptAndChangesNothing) {
  const Model model = read_robot_text(testing::walker(), "walker.urdf");
  TreeRequest traced;
  traced.trace = true;
  const auto derivation = derive_tree(model, traced);
  const auto plain = derive_tree(model);
  for (std::size_t f = 0; f < plain->program.functions.size(); ++f) {
    for (std::size_t o = 0; o < plain->program.functions[f].outputs.size(); ++o)
      EXPECT_EQ(derivation->program.functions[f].outputs[o].nodes,
                plain->program.functions[f].outputs[o].nodes);
  }
  for (const CandidateReport& c : derivation->candidates) {
    if (!c.chosen) continue;
    int first = 0, last = 0;
    for (const PassReport& p : derivation->trace) {
      if (p.function != c.function) continue;
      if (p.pass == "as described") first = p.operations;
      last = p.operations;
    }
    EXPECT_EQ(last, c.operations) << c.function;
    EXPECT_GT(first, last) << c.function;
  }
}

TEST(TreeFunctions, SameProgramEveryTime) {
  const Model model = read_robot_text(testing::walker(), "walker.urdf");
  const auto a = derive_tree(model);
  const auto b = derive_tree(model);
  ASSERT_EQ(a->program.tape.size(), b->program.tape.size());
  for (std::size_t f = 0; f < a->program.functions.size(); ++f) {
    for (std::size_t o = 0; o < a->program.functions[f].outputs.size(); ++o)
      EXPECT_EQ(a->program.functions[f].outputs[o].nodes, b->program.functions[f].outputs[o].nodes);
  }
}

/// Robots that users point the tests at; their files are not part of the project.
class Robots : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(ANHOLON_ROBOTS) / (GetParam() + ".urdf");
    if (std::string(ANHOLON_ROBOTS).empty() || !std::filesystem::exists(file_))
      GTEST_SKIP() << "ANHOLON_ROBOTS has no " << GetParam();
  }
  [[nodiscard]] Model model(bool symbolic_inertia = false) const {
    RobotOptions options;
    options.symbolic_inertia = symbolic_inertia;
    options.floating = GetParam() != "ur5" && GetParam() != "iiwa" && GetParam() != "panda" &&
                       GetParam() != "double_pendulum";
    return read_robot(file_, options);
  }
  std::filesystem::path file_;
};

TEST_P(Robots, AgreeWithTheRecursion) { verify(model()); }

TEST_P(Robots, KeepTheirOperationCounts) {
  static const std::map<std::string, std::map<std::string, int>> reached = {
      {"ur5", {{"inverse_dynamics", 261}, {"mass_matrix", 76}, {"forward_dynamics", 394}}},
      {"iiwa", {{"inverse_dynamics", 392}, {"mass_matrix", 194}, {"forward_dynamics", 728}}},
      {"panda", {{"inverse_dynamics", 546}, {"mass_matrix", 314}, {"forward_dynamics", 1107}}},
      {"anymal_b", {{"inverse_dynamics", 1264}, {"mass_matrix", 513}, {"forward_dynamics", 2597}}},
      {"hyq", {{"inverse_dynamics", 1297}, {"mass_matrix", 546}, {"forward_dynamics", 2698}}},
      {"talos_reduced", {{"inverse_dynamics", 3366}, {"mass_matrix", 2921}, {"forward_dynamics", 7634}}},
      {"talos_full", {{"inverse_dynamics", 4520}, {"mass_matrix", 5015}, {"forward_dynamics", 9777}}}};
  const auto bounds = reached.find(GetParam());
  if (bounds == reached.end()) GTEST_SKIP() << "no bound is stated for " << GetParam();
  const auto derivation = derive_tree(model());
  for (const CandidateReport& c : derivation->candidates) {
    const auto bound = bounds->second.find(c.function);
    if (!c.chosen || bound == bounds->second.end()) continue;
    EXPECT_LE(c.operations, bound->second) << c.function << ": " << c.route;
  }
}

TEST_P(Robots, SymbolicInertiaCostsLittle) {
  const auto frozen = derive_tree(model());
  const auto symbolic = derive_tree(model(true));
  for (const Function& f : frozen->program.functions) {
    const auto chosen = [&](const TreeDerivation& d) {
      return std::ranges::find_if(d.candidates,
                                  [&](const auto& c) { return c.function == f.name && c.chosen; })
          ->operations;
    };
    EXPECT_LE(chosen(*symbolic), 1.03 * chosen(*frozen)) << f.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Robots,
                         ::testing::Values("double_pendulum", "ur5", "iiwa", "panda", "anymal_b", "hyq",
                                           "talos_reduced", "talos_full"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace anholon::tree_functions_test
