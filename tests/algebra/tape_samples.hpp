// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Small tapes for the tests of algebra, and their exact values.

#include <random>
#include <string>
#include <vector>

#include "tape/expr.hpp"
#include "tape/interpret.hpp"

namespace anholon::test {

inline Expr input(Tape& tape, const std::string& name) { return {tape, tape.input(name)}; }

/// Random rationals a / 1000, one for each input of the tape, none of them small.
inline std::vector<Exact> random_point(const Tape& tape, std::mt19937_64& rng) {
  std::vector<Exact> point;
  for (std::size_t i = 0; i < tape.inputs().size(); ++i) {
    point.push_back(Exact::ratio(200 + static_cast<long>(rng() % 2600), rng() % 2 == 0 ? 1000 : -1000));
  }
  return point;
}

inline std::vector<Exact> values(const Tape& tape, const std::vector<NodeId>& roots,
                                 const std::vector<Exact>& point) {
  return interpret<Exact>(tape, roots, point);
}

using Matrix = std::vector<std::vector<NodeId>>;

inline Matrix matrix(Tape& tape, const std::vector<std::vector<Expr>>& rows) {
  Matrix result;
  for (const auto& row : rows) {
    auto& ids = result.emplace_back();
    for (const Expr& e : row) ids.push_back(e.id(tape));
  }
  return result;
}

inline std::vector<NodeId> entries(const Matrix& m) {
  std::vector<NodeId> result;
  for (const auto& row : m) result.insert(result.end(), row.begin(), row.end());
  return result;
}

/// The node as a formula with every bracket written, to compare structures.
inline std::string text(const Tape& tape, NodeId id) {
  const Node& n = tape.node(id);
  if (n.op == Op::constant) return tape.value(id).decimal(12);
  if (n.op == Op::input) return tape.inputs()[n.a];
  if (info(n.op).arity == 1) return std::string(info(n.op).name) + "(" + text(tape, n.a) + ")";
  const char* sign = n.op == Op::add   ? " + "
                     : n.op == Op::sub ? " - "
                     : n.op == Op::mul ? "*"
                     : n.op == Op::div ? "/"
                                       : ",";
  return "(" + text(tape, n.a) + sign + text(tape, n.b) + ")";
}

/// |x| < 1e-60: zero but for the rounding of 128 digits.
inline bool vanishes(const Exact& x) { return abs(x) < Exact::from_decimal("1e-60"); }

}  // namespace anholon::test
