// SPDX-License-Identifier: GPL-2.0-or-later
#include "tape/expr.hpp"

#include <numeric>
#include <stdexcept>

namespace anholon {

NodeId Expr::id(Tape& tape) const {
  if (tape_ == nullptr) return tape.constant(Exact::ratio(numerator_, denominator_));
  if (tape_ != &tape) throw std::logic_error("expression of another tape");
  return static_cast<NodeId>(numerator_);
}

bool Expr::is_zero() const {
  return tape_ == nullptr ? numerator_ == 0 : tape_->is_zero(static_cast<NodeId>(numerator_));
}

std::optional<Exact> Expr::constant_value() const {
  if (tape_ == nullptr) return Exact::ratio(numerator_, denominator_);
  const auto id = static_cast<NodeId>(numerator_);
  return tape_->is_constant(id) ? std::optional(tape_->value(id)) : std::nullopt;
}

Expr Expr::binary(Op op, const Expr& x, const Expr& y) {
  Tape* tape = x.tape_ != nullptr ? x.tape_ : y.tape_;
  if (tape != nullptr) return {*tape, tape->apply(op, x.id(*tape), y.id(*tape))};
  const std::int64_t a = x.numerator_;
  const std::int64_t b = x.denominator_;
  const std::int64_t c = y.numerator_;
  const std::int64_t d = y.denominator_;
  std::int64_t n = 0;
  std::int64_t m = 1;
  switch (op) {
    case Op::add:
      n = a * d + c * b, m = b * d;
      break;
    case Op::sub:
      n = a * d - c * b, m = b * d;
      break;
    case Op::mul:
      n = a * c, m = b * d;
      break;
    case Op::div:
      n = a * d, m = b * c;
      break;
    default:
      throw std::logic_error("a function of literals needs a tape");
  }
  if (m == 0) throw std::domain_error("division by a constant zero");
  if (m < 0) n = -n, m = -m;
  const std::int64_t common = std::gcd(n, m);
  n /= common, m /= common;
  Expr result;
  result.numerator_ = static_cast<std::int32_t>(n);
  result.denominator_ = static_cast<std::int32_t>(m);
  if (result.numerator_ != n || result.denominator_ != m) throw std::logic_error("literal out of range");
  return result;
}

Expr Expr::unary(Op op, const Expr& x) {
  if (x.tape_ != nullptr) return {*x.tape_, x.tape_->apply(op, static_cast<NodeId>(x.numerator_))};
  if (op == Op::neg) return Expr(0) - x;
  if (x.numerator_ == 0) {
    if (op == Op::cos || op == Op::exp) return 1;
    if (op != Op::log && op != Op::acos) return 0;
  }
  throw std::logic_error("a function of literals needs a tape");
}

}  // namespace anholon
