// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The operations of a tape, in one table: name, arity, C++ text, cost class and value over any scalar.

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "tape/rounding_errors.hpp"

namespace anholon {

enum class Op : std::uint8_t {
  constant,
  input,
  add,
  sub,
  mul,
  div,
  neg,
  sqrt,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan2,
  exp,
  log,
  tanh,
  abs,
  sign,
  sum_error,  // what rounding leaves of a + b, a b and a / b: zero over exact scalars
  product_error,
  quotient_error
};

/// How an operation is counted in reports: additions and multiplications apart from everything else.
enum class CostClass : std::uint8_t {
  none,
  addition,
  multiplication,
  division,
  negation,
  root,
  trigonometric,
  other,
  compensation  // several additions and multiplications each
};

struct OpInfo {
  Op op;
  std::string_view name;
  int arity;
  std::string_view cpp;  // {0}, {1}: operands
  CostClass cost;
};

inline constexpr std::array op_table = {
    OpInfo{Op::constant, "constant", 0, "", CostClass::none},
    OpInfo{Op::input, "input", 0, "", CostClass::none},
    OpInfo{Op::add, "add", 2, "{0} + {1}", CostClass::addition},
    OpInfo{Op::sub, "sub", 2, "{0} - {1}", CostClass::addition},
    OpInfo{Op::mul, "mul", 2, "{0} * {1}", CostClass::multiplication},
    OpInfo{Op::div, "div", 2, "{0} / {1}", CostClass::division},
    OpInfo{Op::neg, "neg", 1, "-{0}", CostClass::negation},
    OpInfo{Op::sqrt, "sqrt", 1, "sqrt({0})", CostClass::root},
    OpInfo{Op::sin, "sin", 1, "sin({0})", CostClass::trigonometric},
    OpInfo{Op::cos, "cos", 1, "cos({0})", CostClass::trigonometric},
    OpInfo{Op::tan, "tan", 1, "tan({0})", CostClass::other},
    OpInfo{Op::asin, "asin", 1, "asin({0})", CostClass::other},
    OpInfo{Op::acos, "acos", 1, "acos({0})", CostClass::other},
    OpInfo{Op::atan2, "atan2", 2, "atan2({0}, {1})", CostClass::other},
    OpInfo{Op::exp, "exp", 1, "exp({0})", CostClass::other},
    OpInfo{Op::log, "log", 1, "log({0})", CostClass::other},
    OpInfo{Op::tanh, "tanh", 1, "tanh({0})", CostClass::other},
    OpInfo{Op::abs, "abs", 1, "abs({0})", CostClass::other},
    OpInfo{Op::sign, "sign", 1, "sign({0})", CostClass::other},
    OpInfo{Op::sum_error, "sum_error", 2, "sum_error({0}, {1})", CostClass::compensation},
    OpInfo{Op::product_error, "product_error", 2, "product_error({0}, {1})", CostClass::compensation},
    OpInfo{Op::quotient_error, "quotient_error", 2, "quotient_error({0}, {1})", CostClass::compensation},
};

constexpr const OpInfo& info(Op op) { return op_table[static_cast<std::size_t>(op)]; }

template <class S>
S sign(const S& x) requires std::is_floating_point_v<S> {
  return x > 0 ? S(1) : x < 0 ? S(-1) : S(0);
}

/// Value of an operation over any scalar; `b` is ignored by unary operations.
template <class S>
S apply(Op op, const S& a, const S& b) {
  using std::abs, std::acos, std::asin, std::atan2, std::cos, std::exp, std::log, std::sin, std::sqrt,
      std::tan, std::tanh;
  switch (op) {
    case Op::add:
      return a + b;
    case Op::sub:
      return a - b;
    case Op::mul:
      return a * b;
    case Op::div:
      return a / b;
    case Op::neg:
      return -a;
    case Op::sqrt:
      return sqrt(a);
    case Op::sin:
      return sin(a);
    case Op::cos:
      return cos(a);
    case Op::tan:
      return tan(a);
    case Op::asin:
      return asin(a);
    case Op::acos:
      return acos(a);
    case Op::atan2:
      return atan2(a, b);
    case Op::exp:
      return exp(a);
    case Op::log:
      return log(a);
    case Op::tanh:
      return tanh(a);
    case Op::abs:
      return abs(a);
    case Op::sign:
      return sign(a);
    case Op::sum_error:
      return sum_error(a, b);
    case Op::product_error:
      return product_error(a, b);
    case Op::quotient_error:
      return quotient_error(a, b);
    case Op::constant:
    case Op::input:
      break;
  }
  throw std::logic_error("a leaf of the tape has no operation to apply");
}

}  // namespace anholon
