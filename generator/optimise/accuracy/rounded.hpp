// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Double arithmetic that comes out the same on every machine: + - * / and roots as IEEE 754 rounds them, each
// on its own; sines, cosines and other functions, in which libraries differ, rounded from 40 digits.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <unordered_map>

#include "tape/interpret.hpp"

namespace anholon {

inline constexpr unsigned rounded_digits = 40;  // to be set as WorkingDigits where Rounded is used

/// A double whose every operation is rounded correctly.
struct Rounded {
  double x;
  explicit Rounded(double value = 0) : x(value) {}

  friend Rounded operator+(Rounded a, Rounded b) { return Rounded(a.x + b.x); }
  friend Rounded operator-(Rounded a, Rounded b) { return Rounded(a.x - b.x); }
  friend Rounded operator*(Rounded a, Rounded b) { return Rounded(a.x * b.x); }
  friend Rounded operator/(Rounded a, Rounded b) { return Rounded(a.x / b.x); }
  friend Rounded operator-(Rounded a) { return Rounded(-a.x); }
  friend Rounded sqrt(Rounded a) { return Rounded(std::sqrt(a.x)); }
  friend Rounded abs(Rounded a) { return Rounded(std::abs(a.x)); }
  friend Rounded sign(Rounded a) { return Rounded(a.x > 0 ? 1 : a.x < 0 ? -1 : 0); }
  friend Rounded sin(Rounded a) { return remembered(Op::sin, a); }
  friend Rounded cos(Rounded a) { return remembered(Op::cos, a); }
  friend Rounded tan(Rounded a) { return from_exact(Op::tan, a); }
  friend Rounded asin(Rounded a) { return from_exact(Op::asin, a); }
  friend Rounded acos(Rounded a) { return from_exact(Op::acos, a); }
  friend Rounded atan2(Rounded a, Rounded b) { return from_exact(Op::atan2, a, b); }
  friend Rounded exp(Rounded a) { return from_exact(Op::exp, a); }
  friend Rounded log(Rounded a) { return from_exact(Op::log, a); }
  friend Rounded tanh(Rounded a) { return from_exact(Op::tanh, a); }
  friend Rounded sum_error(Rounded a, Rounded b) { return Rounded(sum_error(a.x, b.x)); }
  friend Rounded product_error(Rounded a, Rounded b) { return Rounded(product_error(a.x, b.x)); }
  friend Rounded quotient_error(Rounded a, Rounded b) { return Rounded(quotient_error(a.x, b.x)); }

 private:
  /// The same few angles come in every function of a program.
  static Rounded remembered(Op op, Rounded a) {
    constexpr std::size_t most = 1 << 20;
    thread_local std::unordered_map<std::uint64_t, double> sines, cosines;
    auto& known = op == Op::sin ? sines : cosines;
    if (known.size() > most) known.clear();
    const auto [place, is_new] = known.try_emplace(std::bit_cast<std::uint64_t>(a.x));
    if (is_new) place->second = from_exact(op, a).x;
    return Rounded(place->second);
  }
  static Rounded from_exact(Op op, Rounded a, Rounded b = Rounded()) {
    if (!std::isfinite(a.x) || !std::isfinite(b.x)) return Rounded(std::numeric_limits<double>::quiet_NaN());
    try {
      return Rounded(apply(op, Exact::from_double(a.x), Exact::from_double(b.x)).to_double());
    } catch (const std::domain_error&) {
      return Rounded(std::numeric_limits<double>::quiet_NaN());
    }
  }
};

template <>
struct FromExact<Rounded> {
  Rounded operator()(const Exact& value) const { return Rounded(value.to_double()); }
};

}  // namespace anholon
