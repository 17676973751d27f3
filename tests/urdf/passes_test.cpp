// SPDX-License-Identifier: GPL-2.0-or-later

// Passes on mechanisms and on programs: the same values, and never more operations where that is promised.

#include <gtest/gtest.h>

#include <random>

#include "anholon/composite.hpp"
#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_robot.hpp"
#include "optimise/model/align_parallel.hpp"
#include "optimise/model/merge_fixed.hpp"
#include "optimise/model/regroup.hpp"
#include "optimise/model/rotate_leaves.hpp"
#include "optimise/model/slide_frames.hpp"
#include "optimise/tape/common_factors.hpp"
#include "optimise/tape/common_sums.hpp"
#include "optimise/tape/count.hpp"
#include "optimise/tape/gather_parameters.hpp"
#include "optimise/tape/hoist.hpp"
#include "optimise/tape/opposite_differences.hpp"
#include "tape/interpret.hpp"
#include "urdf/small_robots.hpp"

namespace anholon::passes_test {
namespace {

Mechanism<Exact> floating_arm() {
  RobotOptions options;
  options.floating = true;
  return mechanise<Exact>(describe_mechanism(read_robot_text(testing::arm(), "arm.urdf", options)),
                          std::vector<Exact>{});
}

/// Forces at one state, base wrench first.
std::vector<Exact> forces(const Mechanism<Exact>& m) {
  State<Exact> state;
  std::vector<Exact> acceleration;
  for (int i = 0; i < 6; ++i)
    state.eta[i] = Exact::ratio(3 * i - 7, 5), acceleration.push_back(Exact::ratio(2 * i - 5, 3));
  for (int i = 0; i < m.coordinates; ++i) {
    state.r.push_back(Exact::ratio(i + 2, 7));
    state.r_dot.push_back(Exact::ratio(2 - i, 3));
    acceleration.push_back(Exact::ratio(i - 4, 2));
  }
  return FreeDynamics<Exact>(m).inverse_dynamics(state, acceleration);
}

void expect_same(const std::vector<Exact>& a, const std::vector<Exact>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(abs(a[i] - b[i]), Exact::from_decimal("1e-80")) << i;
}

TEST(ModelPasses, MergingKeepsForces) {
  Mechanism<Exact> m = floating_arm();
  const std::vector<Exact> before = forces(m);
  EXPECT_EQ(merge_fixed(m), 2);
  EXPECT_EQ(m.bodies.size(), 8U);
  expect_same(forces(m), before);
}

TEST(ModelPasses, SlidingKeepsForces) {
  for (const SlideTowards towards : {SlideTowards::tips, SlideTowards::base}) {
    Mechanism<Exact> m = floating_arm();
    const std::vector<Exact> before = forces(m);
    EXPECT_GT(slide_frames(m, towards), 2);
    expect_same(forces(m), before);
  }
}

/// A chain of three parallel joints, each of whose frames stands a quarter turn from the one before; the last
/// names its axis otherwise.
Mechanism<Exact> parallel_chain() {
  Mechanism<Exact> m;
  m.group = GroupKind::SE3;
  m.coordinates = 3;
  m.gravity = {0, 0, Exact::from_decimal("-9.81")};
  for (int k = 0; k < 4; ++k) {
    Body<Exact> b;
    b.name = "link " + std::to_string(k);
    b.parent = k - 1;
    b.kind = k == 0 ? JointKind::fixed : JointKind::revolute;
    b.coordinate = k - 1;
    b.axis = k == 3 ? 2 : 1;
    b.p = {Exact::ratio(k, 3), Exact::ratio(1, 4), Exact::ratio(-k, 5)};
    if (k == 2) b.R = {{0, 0, 1, 0, 1, 0, -1, 0, 0}};
    if (k == 3) b.R = {{0, 1, 0, 0, 0, 1, 1, 0, 0}};
    b.mass = Exact(k + 1);
    b.first_moment = {Exact::ratio(1, 2), Exact::ratio(-1, 3), Exact::ratio(k, 7)};
    b.inertia = {{5, 0, -1, 0, Exact(4 + k), 1, -1, 1, 6}};
    m.bodies.push_back(b);
  }
  return m;
}

TEST(ModelPasses, AligningParallelJointsKeepsForces) {
  Mechanism<Exact> m = parallel_chain();
  const std::vector<Exact> before = forces(m);
  EXPECT_EQ(align_parallel(m), 2);
  expect_same(forces(m), before);
  for (const Body<Exact>& b : m.bodies) EXPECT_EQ(b.axis, 1) << b.name;
}

TEST(ModelPasses, ParallelJointsInCommonAxesGiveTheSameMassMatrix) {
  Mechanism<Exact> m = parallel_chain();
  m.bodies.push_back(m.bodies[3]);  // a second branch, and a joint across
  m.bodies.back().parent = 2;
  m.bodies.back().axis = 0;
  m.bodies.back().coordinate = 3;
  m.coordinates = 4;
  State<Exact> state;
  for (int i = 0; i < 4; ++i) state.r.push_back(Exact::ratio(2 * i - 3, 5)), state.r_dot.emplace_back(0);
  const std::vector<Exact> expected = FreeDynamics<Exact>(m).mass_matrix(state).entries();
  EXPECT_EQ(align_parallel(m), 2);
  for (const bool regrouped : {false, true}) {
    if (regrouped) regroup(m);
    RigidTree<Exact> tree(m);
    tree.position(state.r);
    EXPECT_TRUE(JointFrames<Exact>(tree).is_parallel(2) && JointFrames<Exact>(tree).is_parallel(3));
    EXPECT_FALSE(JointFrames<Exact>(tree).is_parallel(1) || JointFrames<Exact>(tree).is_parallel(4));
    expect_same(composite_mass_matrix(tree).entries(), expected);
  }
}

TEST(ModelPasses, TurningTipsKeepsForcesAndClearsAMoment) {
  Mechanism<Exact> m = floating_arm();
  merge_fixed(m);
  const std::vector<Exact> before = forces(m);
  EXPECT_EQ(rotate_leaves(m), 2);  // the tool and the finger
  expect_same(forces(m), before);
  for (const Body<Exact>& b : m.bodies) {
    if (b.name != "seven") continue;
    EXPECT_TRUE(b.first_moment[(b.axis + 2) % 3].is_zero());
  }
}

TEST(ModelPasses, RegroupingKeepsForcesAndEmptiesBodies) {
  Mechanism<Exact> m = floating_arm();
  merge_fixed(m);
  const std::vector<Exact> before = forces(m);
  regroup(m);
  expect_same(forces(m), before);
  for (std::size_t k = 1; k < m.bodies.size(); ++k) {
    const Body<Exact>& b = m.bodies[k];
    if (b.kind != JointKind::revolute) continue;
    EXPECT_TRUE(b.mass.is_zero() && b.first_moment[b.axis].is_zero()) << b.name;
  }
}

/// A random program that is rich in sums, products with common factors and differences of both signs.
std::vector<NodeId> random_roots(Tape& tape, std::mt19937& random) {
  std::vector<NodeId> nodes;
  for (int i = 0; i < 5; ++i) nodes.push_back(tape.input("x" + std::to_string(i)));
  nodes.push_back(tape.constant(Exact::from_decimal("0.37")));
  nodes.push_back(tape.constant(Exact::from_decimal("-2.1")));
  for (int i = 0; i < 60; ++i) {
    std::uniform_int_distribution<std::size_t> pick(0, nodes.size() - 1);
    constexpr std::array ops = {Op::add, Op::sub, Op::sub, Op::mul, Op::add, Op::mul};
    const Op op = ops[pick(random) % ops.size()];
    const NodeId a = nodes[pick(random)];
    const NodeId b = nodes[pick(random)];
    nodes.push_back(tape.apply(op, a, b));
    if (op == Op::sub) nodes.push_back(tape.apply(op, b, a));
  }
  return {nodes.end() - 12, nodes.end()};
}

template <class Pass>
void check_pass(const Pass& pass) {
  std::mt19937 random(11);
  int gain = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Tape tape;
    const std::vector<NodeId> before = random_roots(tape, random);
    const std::vector<NodeId> after = pass(tape, before);
    gain += count_operations(tape, before).total() - count_operations(tape, after).total();
    EXPECT_LE(count_operations(tape, after).total(), count_operations(tape, before).total());
    std::vector<Exact> inputs;
    for (int i = 0; i < 5; ++i) inputs.push_back(Exact::ratio(static_cast<int>(random() % 19) - 9, 7));
    const auto x = interpret<Exact>(tape, before, inputs);
    const auto y = interpret<Exact>(tape, after, inputs);
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_LT(abs(x[i] - y[i]), Exact::from_decimal("1e-90") * (Exact(1) + abs(x[i])));
  }
  EXPECT_GT(gain, 0);
}

TEST(TapePasses, OppositeDifferences) {
  check_pass([](Tape& t, const std::vector<NodeId>& r) { return merge_opposite_differences(t, r); });
}
TEST(TapePasses, CommonFactors) {
  check_pass([](Tape& t, const std::vector<NodeId>& r) { return extract_common_factors(t, r); });
}
TEST(TapePasses, CommonSums) {
  check_pass([](Tape& t, const std::vector<NodeId>& r) { return share_common_sums(t, r); });
}

TEST(TapePasses, GatheredParametersOfAllKinds) {
  check_pass([](Tape& t, const std::vector<NodeId>& r) { return gather_parameters(t, r, {}); });
}
TEST(TapePasses, GatheredParametersCostNothingPerCall) {
  Tape tape;
  const NodeId a = tape.input("a"), b = tape.input("b"), x = tape.input("x"), y = tape.input("y");
  const NodeId sum = tape.apply(Op::sub, tape.apply(Op::sub, x, a), tape.apply(Op::sub, y, b));      // 3
  const NodeId product = tape.apply(Op::mul, a, tape.apply(Op::mul, y, tape.apply(Op::mul, b, x)));  // 3
  const std::vector<NodeId> before = {sum, product};
  const std::vector<NodeId> after = gather_parameters(tape, before, {a, b});
  EXPECT_EQ(operations_per_call(tape, before, {a, b}).total(), 6);
  EXPECT_EQ(operations_per_call(tape, after, {a, b}).total(), 4);
  const std::vector<Exact> inputs = {Exact::ratio(3, 7), Exact(5), Exact::ratio(-2, 3), Exact(11)};
  expect_same(interpret<Exact>(tape, after, inputs), interpret<Exact>(tape, before, inputs));
}

}  // namespace
}  // namespace anholon::passes_test
