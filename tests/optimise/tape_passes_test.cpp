// SPDX-License-Identifier: GPL-2.0-or-later
// Passes on the tape: what is needed, in which order, what is computed ahead, and what it costs.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "emit/random_program.hpp"
#include "optimise/tape/count.hpp"
#include "optimise/tape/dead_code.hpp"
#include "optimise/tape/hoist.hpp"
#include "optimise/tape/order.hpp"
#include "tape/expr.hpp"

namespace anholon::tape_passes_test {
namespace {

std::vector<NodeId> roots_of(const Program& program) {
  std::vector<NodeId> roots;
  for (const Function& f : program.functions) {
    for (const OutputBlock& o : f.outputs) roots.insert(roots.end(), o.nodes.begin(), o.nodes.end());
  }
  return roots;
}

std::vector<NodeId> parameters_of(const Program& program) {
  std::vector<NodeId> nodes;
  for (const ParameterInfo& p : program.parameters) nodes.push_back(p.node);
  return nodes;
}

class EveryNodeOrder : public ::testing::TestWithParam<NodeOrder> {};
INSTANTIATE_TEST_SUITE_P(Orders, EveryNodeOrder,
                         ::testing::Values(NodeOrder::levels, NodeOrder::depth_first, NodeOrder::lifetimes));

TEST_P(EveryNodeOrder, PutsEveryOperandBeforeItsUser) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const Program program = test::random_program({}, seed);
    const std::vector<NodeId> roots = roots_of(program);
    const EmissionOrder order = emission_order(program.tape, roots, {}, GetParam());
    std::set<NodeId> done;
    for (const NodeId id : program.tape.reachable(roots)) {
      if (info(program.tape.node(id).op).arity == 0) done.insert(id);
    }
    for (const NodeId id : order.nodes) {
      const Node& n = program.tape.node(id);
      EXPECT_TRUE(done.contains(n.a));
      EXPECT_TRUE(info(n.op).arity < 2 || done.contains(n.b));
      EXPECT_TRUE(done.insert(id).second) << "twice";
    }
    for (const NodeId root : roots) EXPECT_TRUE(done.contains(root));
    EXPECT_EQ(done.size(), program.tape.reachable(roots).size()) << "more than is needed";
  }
}

TEST_P(EveryNodeOrder, DoesNotDependOnTheOrderOfCreationWithinASection) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const Program forwards = test::random_program({}, seed, false);
    const Program backwards = test::random_program({}, seed, true);
    const auto keys = [](const Program& program) {
      std::vector<StructuralKey> result;
      for (const NodeId id : emission_order(program.tape, roots_of(program), {}, GetParam()).nodes) {
        result.push_back(program.tape.key(id));
      }
      return result;
    };
    EXPECT_EQ(keys(forwards), keys(backwards));
  }
}

TEST(EmissionOrder, KeepsSectionsInTheirOrderBehindTheSinesWhereItIsToBeRead) {
  const Program program = test::random_program({}, 7);
  const EmissionOrder order = emission_order(program.tape, roots_of(program));
  for (std::size_t i = order.sincos + 1; i < order.nodes.size(); ++i) {
    EXPECT_LE(program.tape.section_of(order.nodes[i - 1]), program.tape.section_of(order.nodes[i]));
  }
}

/// Values alive between two operations, at most.
std::size_t most_alive(const Tape& tape, const std::vector<NodeId>& order, NodeId root) {
  std::map<NodeId, std::size_t> last;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Node& n = tape.node(order[i]);
    last[n.a] = i;
    if (info(n.op).arity == 2) last[n.b] = i;
  }
  last[root] = order.size();
  std::size_t most = 0;
  std::multiset<std::size_t> alive;  // last uses of what is there
  for (std::size_t i = 0; i < order.size(); ++i) {
    alive.erase(alive.begin(), alive.upper_bound(i));
    alive.insert(last[order[i]]);
    most = std::max(most, alive.size());
  }
  return most;
}

TEST(EmissionOrder, ByLifetimesKeepsOneValueForEachLevelOfABalancedSum) {
  Tape tape;
  std::vector<Expr> terms;
  for (int i = 0; i < 64; ++i) {
    const Expr x(tape, tape.input("x" + std::to_string(i)));
    terms.push_back(x * x);
  }
  while (terms.size() > 1) {
    tape.section("sum of " + std::to_string(terms.size()));
    std::vector<Expr> next;
    for (std::size_t i = 0; i < terms.size(); i += 2) next.push_back(terms[i] + terms[i + 1]);
    terms = next;
  }
  const NodeId root = terms[0].id(tape);
  const auto alive = [&](NodeOrder order) {
    return most_alive(tape, emission_order(tape, {root}, {}, order).nodes, root);
  };
  EXPECT_EQ(alive(NodeOrder::lifetimes), 7U);  // log2(64) + 1, the least there is (Sethi and Ullman 1970)
  EXPECT_EQ(alive(NodeOrder::levels), 64U);
}

TEST(EmissionOrder, PutsTheSinesOfTheInputsFirstSineAndCosineOfOneArgumentTogether) {
  Tape tape;
  const Expr a(tape, tape.input("a"));
  const Expr b(tape, tape.input("b"));
  tape.section("one");
  const Expr product = a * b;
  tape.section("two");
  const Expr y = cos(b) * sin(a + b) + sin(b) * product + cos(a) * sin(sin(a) * b);
  const EmissionOrder order = emission_order(tape, {y.id(tape)});
  const std::vector<NodeId> expected = {sin(a).id(tape), cos(a).id(tape),  sin(b).id(tape),
                                        cos(b).id(tape), (a + b).id(tape), sin(a + b).id(tape)};
  ASSERT_EQ(order.sincos, expected.size());
  EXPECT_EQ(std::vector<NodeId>(order.nodes.begin(), order.nodes.begin() + 6), expected);
  EXPECT_EQ(order.nodes[6], product.id(tape));
}

TEST(NeededNodes, StopAtWhatIsGiven) {
  Tape tape;
  const Expr a(tape, tape.input("a"));
  const Expr b(tape, tape.input("b"));
  const Expr inner = a * b;
  const Expr outer = inner + b;
  const auto nodes = needed_nodes(tape, {outer.id(tape)}, {inner.id(tape)});
  EXPECT_EQ(nodes, (std::vector<NodeId>{b.id(tape), inner.id(tape), outer.id(tape)}));
  EXPECT_TRUE(needed_nodes(tape, {}).empty());
}

TEST(Count, SharesNodesAndPutsEachOperationInItsClass) {
  Tape tape;
  const Expr a(tape, tape.input("a"));
  const Expr b(tape, tape.input("b"));
  const Expr s = sin(a);
  const Expr y = s * b + s * b * sqrt(b) - cos(a) / b;
  const Expr z = -(s * b) * exp(a);  // neg(s b exp a), one negation
  const OperationCount count = count_operations(tape, {y.id(tape), z.id(tape), y.id(tape)});
  OperationCount expected;
  expected.additions = 2;
  expected.multiplications = 3;
  expected.divisions = 1;
  expected.negations = 1;
  expected.roots = 1;
  expected.sines = 1;
  expected.cosines = 1;
  expected.other = 1;
  EXPECT_EQ(count, expected);
  EXPECT_EQ(count.total(), 6);
  EXPECT_EQ(count.trigonometric(), 2);
  EXPECT_EQ(count.statements(), 11);
  EXPECT_EQ(count.text(), "2 add, 3 mul, 1 div, 1 neg, 1 sqrt, 1 sin, 1 cos, 1 other");
  EXPECT_EQ(OperationCount().text(), "none");
}

TEST(Count, IsTheNumberOfOrderedOperations) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Program program = test::random_program({}, seed);
    const std::vector<NodeId> roots = roots_of(program);
    EXPECT_EQ(static_cast<std::size_t>(count_operations(program.tape, roots).statements()),
              emission_order(program.tape, roots).nodes.size());
  }
}

TEST(Hoist, TakesTheLargestExpressionsOfParametersAlone) {
  Tape tape;
  const Expr m(tape, tape.input("m"));
  const Expr l(tape, tape.input("l"));
  const Expr unused(tape, tape.input("unused"));
  const Expr q(tape, tape.input("q"));
  const Expr ml = m * l;
  const Expr inertia = ml * l;
  const Expr y = inertia * q + m * sin(q) + Expr(3) * q;
  const Expr constant = sqrt(m) * 2;
  const Hoisted hoisted = hoist(tape, {y.id(tape), constant.id(tape), tape.constant(5)},
                                {m.id(tape), l.id(tape), unused.id(tape)});
  EXPECT_EQ(hoisted.parameters, std::vector<NodeId>{m.id(tape)}) << "l is only used inside";
  EXPECT_EQ((std::set<NodeId>(hoisted.values.begin(), hoisted.values.end())),
            (std::set<NodeId>{inertia.id(tape), constant.id(tape)}));
}

TEST(Hoist, LeavesNothingThatDependsOnParametersAlone) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    const Program program = test::random_program({}, seed);
    const std::vector<NodeId> roots = roots_of(program);
    const std::vector<NodeId> parameters = parameters_of(program);
    const Hoisted hoisted = hoist(program.tape, roots, parameters);
    std::vector<NodeId> given = hoisted.values;
    given.insert(given.end(), hoisted.parameters.begin(), hoisted.parameters.end());
    const std::set<NodeId> known(given.begin(), given.end());
    std::unordered_map<NodeId, bool> has_state;
    for (const NodeId id : needed_nodes(program.tape, roots, given)) {
      const Node& n = program.tape.node(id);
      const bool is_parameter = std::find(parameters.begin(), parameters.end(), id) != parameters.end();
      EXPECT_TRUE(!is_parameter || known.contains(id)) << "a parameter that is not prepared";
      if (known.contains(id) || info(n.op).arity == 0) {
        has_state[id] = n.op == Op::input && !is_parameter;
        continue;
      }
      has_state[id] = has_state[n.a] || (info(n.op).arity == 2 && has_state[n.b]);
      EXPECT_TRUE(has_state[id]);
    }
  }
}

}  // namespace
}  // namespace anholon::tape_passes_test
