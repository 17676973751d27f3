// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Random straight-line programs from a seed. What is random is a list of operations; from one list a tape can
// be made in several orders, as different compilers would make it.

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tape/expr.hpp"
#include "tape/interface.hpp"

namespace anholon::test {

/// Numbers that are the same with every standard library, unlike those of std::uniform_int_distribution.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }

 private:
  std::mt19937_64 engine_;
};

struct RandomOperation {
  Op op;
  std::size_t a, b;     // of the list: first parameters, then state inputs, then operations
  std::size_t section;  // ascending
};

struct RandomShape {
  std::size_t parameters = 4;
  std::size_t states = 6;
  std::size_t operations = 60;
  std::size_t sections = 5;
  std::size_t reach = 12;  // operands come from the last so many nodes, or are inputs
};

/// Operations that stay finite: no quotients but by 2 + sin^2, which the tape's folding leaves alone.
inline std::vector<RandomOperation> random_operations(const RandomShape& shape, Dice& dice) {
  std::vector<RandomOperation> list;
  const std::size_t inputs = shape.parameters + shape.states;
  const auto operand = [&](std::size_t size) {
    if (size == inputs || dice.below(4) == 0) return dice.below(inputs);
    const std::size_t reach = std::min(shape.reach, size - inputs);
    return size - 1 - dice.below(reach);
  };
  const Op ops[] = {Op::add, Op::sub, Op::mul, Op::add,  Op::sub, Op::mul,
                    Op::neg, Op::sin, Op::cos, Op::tanh, Op::abs};
  for (std::size_t i = 0; i < shape.operations; ++i) {
    const std::size_t size = inputs + list.size();
    const std::size_t section = i * shape.sections / shape.operations;
    list.push_back({ops[dice.below(std::size(ops))], operand(size), operand(size), section});
    // keep magnitudes near 1: every fourth value goes through a sine
    if (i % 4 == 3) list.push_back({Op::sin, inputs + list.size() - 1, 0, section});
  }
  return list;
}

/// @param backwards  makes the nodes of each section from its last one, operands on demand and right before
/// left
inline Program random_program(const RandomShape& shape, std::uint64_t seed, bool backwards = false) {
  Dice dice(seed);
  const std::vector<RandomOperation> list = random_operations(shape, dice);
  Program program;
  program.name_space = "random::standard";
  program.model = "random";
  Tape& tape = program.tape;
  std::vector<NodeId> nodes;
  for (std::size_t i = 0; i < shape.parameters; ++i) {
    const std::string name = "p_" + std::to_string(i);
    nodes.push_back(tape.input(name));
    program.parameters.push_back({name, "", "", Exact::ratio(static_cast<long>(i) + 1, 3), nodes.back()});
  }
  InputBlock state{"q", "", "", static_cast<int>(shape.states), 1, {}};
  for (std::size_t i = 0; i < shape.states; ++i) {
    nodes.push_back(tape.input("q_" + std::to_string(i)));
    state.nodes.push_back(nodes.back());
  }
  program.inputs = {state};
  const std::size_t inputs = nodes.size();
  constexpr auto not_made = static_cast<NodeId>(-1);
  nodes.resize(inputs + list.size(), not_made);
  const auto make = [&](const auto& self, std::size_t i) -> NodeId {
    if (nodes[i] != not_made) return nodes[i];
    const RandomOperation& o = list[i - inputs];
    const bool binary = info(o.op).arity == 2;
    const NodeId b = binary ? self(self, o.b) : 0;
    const NodeId a = self(self, o.a);
    return nodes[i] = tape.apply(o.op, a, b);
  };
  for (std::size_t begin = 0; begin < list.size();) {
    std::size_t end = begin;
    while (end < list.size() && list[end].section == list[begin].section) ++end;
    tape.section("part " + std::to_string(list[begin].section));
    for (std::size_t i = begin; i < end; ++i) make(make, inputs + (backwards ? end - 1 - (i - begin) : i));
    begin = end;
  }
  OutputBlock out{"y", "", "", 8, 1, {}};
  for (std::size_t i = 0; i < 8; ++i) out.nodes.push_back(nodes[nodes.size() - 1 - i]);
  OutputBlock early{"z", "", "", 2, 2, {}};
  for (std::size_t i = 0; i < 4; ++i) early.nodes.push_back(nodes[inputs + list.size() / 2 + i]);
  program.functions = {{"both", "Late and early values.", {out, early}, ""},
                       {"early", "Early values.", {early}, ""}};
  return program;
}

/// A chain of plane rotations by angles near q, six statements each, of which none can be left out.
inline Program long_program(int steps) {
  Program program;
  program.name_space = "rotations";
  program.model = "rotations";
  Tape& tape = program.tape;
  const NodeId p = tape.input("p");
  program.parameters = {{"p", "", "", Exact::ratio(1, 7), p}};
  const NodeId q = tape.input("q");
  const NodeId u = tape.input("u");
  program.inputs = {{"q", "rad", "", 1, 1, {q}}, {"u", "", "", 1, 1, {u}}};
  NodeId x = tape.constant(1);
  NodeId y = u;
  const NodeId c = tape.apply(Op::cos, tape.apply(Op::add, q, p));
  const NodeId s = tape.apply(Op::sin, tape.apply(Op::add, q, p));
  for (int i = 0; i < steps; ++i) {
    if (i % 100 == 0) tape.section("step " + std::to_string(i));
    const NodeId next = tape.apply(Op::sub, tape.apply(Op::mul, c, x), tape.apply(Op::mul, s, y));
    y = tape.apply(Op::add, tape.apply(Op::mul, s, x), tape.apply(Op::mul, c, y));
    x = next;
  }
  program.functions = {{"turn", "Turns (1, u) by steps (q + p).", {{"xy", "", "", 2, 1, {x, y}}}, ""}};
  return program;
}

/// Turns a vector by each of some angles and by their halves.
inline Program turns(int angles) {
  Program program;
  program.name_space = "turns";
  program.model = "turns";
  Tape& tape = program.tape;
  InputBlock r{"r", "rad", "angles", angles, 1, {}};
  for (int i = 0; i < angles; ++i) r.nodes.push_back(tape.input("r[" + std::to_string(i) + "]"));
  Expr x(tape, tape.constant(1));
  Expr y(tape, tape.constant(0));
  for (const NodeId id : r.nodes) {
    for (const Expr& angle : {Expr(tape, id), Expr(tape, id) / Expr(2)}) {
      const Expr next = cos(angle) * x - sin(angle) * y;
      y = sin(angle) * x + cos(angle) * y;
      x = next;
    }
  }
  program.inputs = {r};
  program.functions = {{"turn", "", {{"xy", "", "", 2, 1, {x.id(tape), y.id(tape)}}}, ""}};
  return program;
}

}  // namespace anholon::test
