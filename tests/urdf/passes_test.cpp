// SPDX-License-Identifier: GPL-2.0-or-later

// Passes on mechanisms and on programs: the same values, and never more operations where that is promised.

#include <gtest/gtest.h>

#include <random>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_urdf.hpp"
#include "optimise/model/merge_fixed.hpp"
#include "optimise/model/regroup.hpp"
#include "optimise/model/rotate_leaves.hpp"
#include "optimise/model/slide_frames.hpp"
#include "optimise/tape/common_factors.hpp"
#include "optimise/tape/common_sums.hpp"
#include "optimise/tape/count.hpp"
#include "optimise/tape/opposite_differences.hpp"
#include "tape/interpret.hpp"
#include "urdf/small_robots.hpp"

namespace anholon {
namespace {

Mechanism<Exact> floating_arm() {
  UrdfOptions options;
  options.floating = true;
  return mechanise<Exact>(describe_mechanism(read_urdf_text(testing::arm(), "arm.urdf", options)),
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

}  // namespace
}  // namespace anholon
