// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/count.hpp"

#include <fmt/format.h>

#include <unordered_set>
#include <utility>

#include "optimise/tape/dead_code.hpp"

namespace anholon {

void OperationCount::add(Op op) {
  switch (info(op).cost) {
    case CostClass::none:
      break;
    case CostClass::addition:
      ++additions;
      break;
    case CostClass::multiplication:
      ++multiplications;
      break;
    case CostClass::division:
      ++divisions;
      break;
    case CostClass::negation:
      ++negations;
      break;
    case CostClass::root:
      ++roots;
      break;
    case CostClass::trigonometric:
      ++(op == Op::sin ? sines : cosines);
      break;
    case CostClass::other:
      ++other;
      break;
    case CostClass::compensation:  // without fused multiplications; what is rounded is there already
      additions += op == Op::sum_error ? 5 : op == Op::product_error ? 10 : 12;
      multiplications += op == Op::sum_error ? 0 : op == Op::product_error ? 6 : 7;
      divisions += op == Op::quotient_error ? 1 : 0;
      break;
  }
}

OperationCount& OperationCount::operator+=(const OperationCount& count) {
  additions += count.additions;
  multiplications += count.multiplications;
  divisions += count.divisions;
  negations += count.negations;
  roots += count.roots;
  sines += count.sines;
  cosines += count.cosines;
  other += count.other;
  return *this;
}

std::string OperationCount::text() const {
  std::string text;
  const std::pair<int, const char*> parts[] = {
      {additions, "add"}, {multiplications, "mul"}, {divisions, "div"}, {negations, "neg"},
      {roots, "sqrt"},    {sines, "sin"},           {cosines, "cos"},   {other, "other"}};
  for (const auto& [number, name] : parts) {
    if (number > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", number, name);
  }
  return text.empty() ? "none" : text;
}

OperationCount count_operations(const Tape& tape, const std::vector<NodeId>& roots,
                                const std::vector<NodeId>& given) {
  const std::unordered_set<NodeId> free(given.begin(), given.end());
  OperationCount count;
  for (const NodeId id : needed_nodes(tape, roots, given)) {
    if (!free.contains(id)) count.add(tape.node(id).op);
  }
  return count;
}

}  // namespace anholon
