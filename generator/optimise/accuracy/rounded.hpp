// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Double arithmetic that comes out the same on every machine: + - * / and roots as IEEE 754 rounds them, each
// on its own; sines, cosines and other functions, in which libraries differ, rounded from 30 digits or more.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "optimise/accuracy/sine_and_cosine.hpp"
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
  friend Rounded sin(Rounded a) { return Rounded(remembered(Op::sin, a).rounded); }
  friend Rounded cos(Rounded a) { return Rounded(remembered(Op::cos, a).rounded); }
  friend Rounded tan(Rounded a) { return Rounded(from_exact(Op::tan, a).rounded); }
  friend Rounded asin(Rounded a) { return Rounded(from_exact(Op::asin, a).rounded); }
  friend Rounded acos(Rounded a) { return Rounded(from_exact(Op::acos, a).rounded); }
  friend Rounded atan2(Rounded a, Rounded b) { return Rounded(from_exact(Op::atan2, a, b).rounded); }
  friend Rounded exp(Rounded a) { return Rounded(from_exact(Op::exp, a).rounded); }
  friend Rounded log(Rounded a) { return Rounded(from_exact(Op::log, a).rounded); }
  friend Rounded tanh(Rounded a) { return Rounded(from_exact(Op::tanh, a).rounded); }
  friend Rounded sum_error(Rounded a, Rounded b) { return Rounded(sum_error(a.x, b.x)); }
  friend Rounded product_error(Rounded a, Rounded b) { return Rounded(product_error(a.x, b.x)); }
  friend Rounded quotient_error(Rounded a, Rounded b) { return Rounded(quotient_error(a.x, b.x)); }

  /// What y = op(a, b) lacks of the exact value.
  friend double rounding_error(Op op, Rounded y, Rounded a, Rounded b) {
    switch (op) {
      case Op::add:
        return sum_error(a.x, b.x);
      case Op::sub:
        return sum_error(a.x, -b.x);
      case Op::mul:
        return product_error(a.x, b.x);
      case Op::div:
        return quotient_error(a.x, b.x);
      case Op::sqrt:
        return std::fma(-y.x, y.x, a.x) / (2 * y.x);
      case Op::sin:
      case Op::cos:
        return remembered(op, a).rest;
      case Op::neg:
      case Op::abs:
      case Op::sign:
      case Op::sum_error:  // what the errors of errors bring is of second order
      case Op::product_error:
      case Op::quotient_error:
        return 0;
      default:
        return from_exact(op, a, b).rest;
    }
  }

 private:
  using Parts = DoubleDouble;
  /// The same few angles come in every function of a program.
  static Parts remembered(Op op, Rounded a) {
    constexpr std::size_t most = 1 << 20;
    thread_local std::unordered_map<std::uint64_t, SineAndCosine> known;
    if (known.size() > most) known.clear();
    const auto [place, is_new] = known.try_emplace(std::bit_cast<std::uint64_t>(a.x));
    if (is_new) {
      place->second = std::abs(a.x) <= largest_angle
                          ? sine_and_cosine(a.x)
                          : SineAndCosine{from_exact(Op::sin, a), from_exact(Op::cos, a)};
    }
    return op == Op::sin ? place->second.sine : place->second.cosine;
  }
  static Parts from_exact(Op op, Rounded a, Rounded b = Rounded()) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(a.x) || !std::isfinite(b.x)) return {nan, nan};
    try {
      const Exact y = apply(op, Exact::from_double(a.x), Exact::from_double(b.x));
      const double rounded = y.to_double();
      return {rounded, (y - Exact::from_double(rounded)).to_double()};
    } catch (const std::domain_error&) {
      return {nan, nan};
    }
  }
};

template <>
struct FromExact<Rounded> {
  Rounded operator()(const Exact& value) const { return Rounded(value.to_double()); }
};

/// Values of nodes in double, the same on every machine.
class ReproducibleInterpreter {
 public:
  ReproducibleInterpreter(const Tape& tape, const std::vector<NodeId>& nodes)
      : run_(tape, nodes, FromExact<Rounded>{}) {}

  std::vector<double> operator()(const std::vector<double>& inputs) {
    const WorkingDigits precision(rounded_digits);
    std::vector<Rounded> in, out(run_.output_count());
    for (const double x : inputs) in.emplace_back(x);
    run_(in, out);
    std::vector<double> result;
    for (const Rounded& x : out) result.push_back(x.x);
    return result;
  }

 private:
  Interpreter<Rounded> run_;
};

}  // namespace anholon
