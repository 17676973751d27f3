// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Scalar that writes a tape. An Expr is a node of a tape, or a small rational that belongs to none yet, so
// that generic code may write S(0), S(1) / S(2). It has no order and no truth value: code that branches on a
// number cannot be derived symbolically and does not compile.

#include <cstdint>
#include <optional>

#include "tape/tape.hpp"

namespace anholon {

class Expr {
 public:
  Expr() = default;
  Expr(int value) : numerator_(value) {}  // NOLINT: generic code writes S(0), S(1)
  Expr(Tape& tape, NodeId id) : tape_(&tape), numerator_(static_cast<std::int32_t>(id)) {}

  [[nodiscard]] Tape* tape() const { return tape_; }
  /// Node on `tape`, made there if this is a rational. @throws std::logic_error if this is a node of another
  /// tape
  [[nodiscard]] NodeId id(Tape& tape) const;
  /// Structural zero: what emission would print as 0.
  [[nodiscard]] bool is_zero() const;
  /// The number that this is, if it depends on no input.
  [[nodiscard]] std::optional<Exact> constant_value() const;

  Expr& operator+=(const Expr& other) { return *this = *this + other; }
  Expr& operator-=(const Expr& other) { return *this = *this - other; }
  Expr& operator*=(const Expr& other) { return *this = *this * other; }

  friend Expr operator+(const Expr& x, const Expr& y) { return binary(Op::add, x, y); }
  friend Expr operator-(const Expr& x, const Expr& y) { return binary(Op::sub, x, y); }
  friend Expr operator*(const Expr& x, const Expr& y) { return binary(Op::mul, x, y); }
  friend Expr operator/(const Expr& x, const Expr& y) { return binary(Op::div, x, y); }
  friend Expr operator-(const Expr& x) { return unary(Op::neg, x); }
  friend Expr sqrt(const Expr& x) { return unary(Op::sqrt, x); }
  friend Expr sin(const Expr& x) { return unary(Op::sin, x); }
  friend Expr cos(const Expr& x) { return unary(Op::cos, x); }
  friend Expr tan(const Expr& x) { return unary(Op::tan, x); }
  friend Expr asin(const Expr& x) { return unary(Op::asin, x); }
  friend Expr acos(const Expr& x) { return unary(Op::acos, x); }
  friend Expr atan2(const Expr& y, const Expr& x) { return binary(Op::atan2, y, x); }
  friend Expr exp(const Expr& x) { return unary(Op::exp, x); }
  friend Expr log(const Expr& x) { return unary(Op::log, x); }
  friend Expr tanh(const Expr& x) { return unary(Op::tanh, x); }
  friend Expr abs(const Expr& x) { return unary(Op::abs, x); }
  friend Expr sign(const Expr& x) { return unary(Op::sign, x); }
  friend Expr sum_error(const Expr& x, const Expr& y) { return binary(Op::sum_error, x, y); }
  friend Expr product_error(const Expr& x, const Expr& y) { return binary(Op::product_error, x, y); }
  friend Expr quotient_error(const Expr& x, const Expr& y) { return binary(Op::quotient_error, x, y); }

 private:
  static Expr binary(Op op, const Expr& x, const Expr& y);
  static Expr unary(Op op, const Expr& x);

  Tape* tape_ = nullptr;
  std::int32_t numerator_ = 0;  // node id where there is a tape
  std::int32_t denominator_ = 1;
};

}  // namespace anholon
