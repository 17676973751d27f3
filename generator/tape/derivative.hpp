// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Differentiation of a tape. Zero tangents are not nodes, so sparsity costs nothing.

#include <utility>
#include <vector>

#include "tape/expr.hpp"

namespace anholon {

/// Tangent of y = op(a, b) from the operands' tangents, over any scalar.
template <class S>
S tangent(Op op, const S& y, const S& a, const S& b, const S& da, const S& db) {
  switch (op) {
    case Op::add:
      return da + db;
    case Op::sub:
      return da - db;
    case Op::mul:
      return da * b + a * db;
    case Op::div:
      return (da - y * db) / b;
    case Op::neg:
      return -da;
    case Op::sqrt:
      return da / (S(2) * y);
    case Op::sin:
      return cos(a) * da;
    case Op::cos:
      return -(sin(a) * da);
    case Op::tan:
      return (S(1) + y * y) * da;
    case Op::asin:
      return da / sqrt(S(1) - a * a);
    case Op::acos:
      return -(da / sqrt(S(1) - a * a));
    case Op::atan2:
      return (b * da - a * db) / (a * a + b * b);
    case Op::exp:
      return y * da;
    case Op::log:
      return da / a;
    case Op::tanh:
      return (S(1) - y * y) * da;
    case Op::abs:
      return sign(a) * da;
    case Op::sign:
    case Op::sum_error:
    case Op::product_error:
    case Op::quotient_error:
    case Op::constant:
    case Op::input:
      break;
  }
  return S(0);
}

/// Derivatives of the roots along one direction of the inputs.
/// @param direction  (input node, its tangent); inputs that are not named stay fixed
std::vector<NodeId> directional_derivative(Tape& tape, const std::vector<NodeId>& roots,
                                           const std::vector<std::pair<NodeId, NodeId>>& direction);

/// d root / d x for an input node x.
NodeId derivative(Tape& tape, NodeId root, NodeId x);

}  // namespace anholon
