// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tree_loops.hpp"

#include <algorithm>
#include <stdexcept>

#include "optimise/tape/hoist.hpp"

namespace anholon {
namespace {

/// A number whose operations are counted and whose value is not kept.
struct Counted {
  OperationCount* count = nullptr;

  static Counted after(Op op, const Counted& x, const Counted& y) {
    OperationCount* const count = x.count != nullptr ? x.count : y.count;
    if (count != nullptr) count->add(op);
    return {count};
  }
  friend Counted operator+(const Counted& x, const Counted& y) { return after(Op::add, x, y); }
  friend Counted operator-(const Counted& x, const Counted& y) { return after(Op::sub, x, y); }
  friend Counted operator*(const Counted& x, const Counted& y) { return after(Op::mul, x, y); }
  friend Counted operator/(const Counted& x, const Counted& y) { return after(Op::div, x, y); }
  friend Counted operator-(const Counted& x) { return after(Op::neg, x, x); }
};

// Constants of the loops: zero and one. Counted ones are counted by what they meet, or by nobody where two
// meet.
template <class Real>
Real constant(long double value) {
  return Real(static_cast<int>(value));
}
template <>
Counted constant<Counted>(long double) {
  return {};
}

#include "tree_loops.inl"

int as_int(std::size_t size) { return static_cast<int>(size); }

template <class Real>
std::vector<std::vector<Real>> run_on(const TreeLoops& loops, std::vector<std::vector<Real>> from,
                                      const Real& nothing) {
  const std::size_t n = loops.parent.size();
  if (loops.kind == TreeLoops::Kind::regressor) {
    std::vector<Real> Y(static_cast<std::size_t>(loops.rows) * 10 * n, nothing);
    regressor_rows(as_int(n), loops.parent.data(), loops.row.data(), as_int(loops.component.size()),
                   loops.component.data(), loops.rows, from[0].data(), from[1].data(), Y.data());
    return {Y};
  }
  std::vector<Real> A = std::move(from[0]);
  std::vector<Real> D(n, nothing);
  factor_mass_matrix(as_int(n), loops.parent.data(), A.data(), D.data());
  if (loops.kind == TreeLoops::Kind::mass_factor) return {A, D};
  invert_mass_factor(as_int(n), loops.parent.data(), loops.end.data(), A.data(), D.data());
  return {A};
}

}  // namespace

std::vector<std::vector<Expr>> values_of(const TreeLoops& loops, const std::vector<std::vector<Expr>>& from) {
  return run_on<Expr>(loops, from, Expr(0));
}

OperationCount count_operations(const TreeLoops& loops) {
  OperationCount count;
  const std::size_t n = loops.parent.size();
  const Counted unit{&count};
  std::vector<std::vector<Counted>> from = {std::vector<Counted>(n * n, unit)};
  if (loops.kind == TreeLoops::Kind::regressor)
    from = {std::vector<Counted>(21 * n, unit), std::vector<Counted>(6 * n, unit)};
  run_on<Counted>(loops, std::move(from), unit);
  return count;
}

const Function& straight_line(const Program& program, const Function& function) {
  if (!function.loops) return function;
  const auto found = std::ranges::find(program.functions, function.loops->from, &Function::name);
  if (found == program.functions.end())
    throw std::logic_error("no function '" + function.loops->from + "' for the loops of '" + function.name +
                           "'");
  return *found;
}

OperationCount operations_per_call(const Program& program, const Function& function) {
  std::vector<NodeId> roots;
  for (const OutputBlock& b : straight_line(program, function).outputs)
    roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  std::vector<NodeId> parameters;
  for (const ParameterInfo& p : program.parameters) parameters.push_back(p.node);
  OperationCount count = operations_per_call(program.tape, roots, parameters);
  if (function.loops) count += count_operations(*function.loops);
  return count;
}

}  // namespace anholon
