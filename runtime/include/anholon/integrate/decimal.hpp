// SPDX-License-Identifier: MIT
//
// Decimal constants of up to 36 digits, kept whole until the scalar is known:
//
//   constexpr long double x = 0.526001519587677318785587544488e-1_decimal;
//
// A literal with the suffix L would be cut to the digits of long double, whatever the scalar.
#pragma once

#include <concepts>
#include <type_traits>

namespace anholon::integrate {

/// The number (head 10^-scale + tail 10^-(scale + 18)), both parts integers of at most 18 digits.
struct Decimal {
  long long head = 0, tail = 0;
  int scale = 0;

  /// To about one unit in the last place of Real; float and double are rounded from long double.
  template <class Real>
  requires(!std::integral<Real>) constexpr operator Real()
      const {  // NOLINT: a constant stands where a scalar is wanted
    if constexpr (std::is_same_v<Real, float> || std::is_same_v<Real, double>) {
      return static_cast<Real>(static_cast<long double>(*this));
    } else {
      const Real split = power_of_ten<Real>(18);
      return (Real(head) + Real(tail) / split) / power_of_ten<Real>(scale);
    }
  }
  constexpr Decimal operator-() const { return {-head, -tail, scale}; }

 private:
  template <class Real>
  static constexpr Real power_of_ten(int exponent) {
    Real product = Real(1);
    for (int i = 0; i < exponent; ++i) product *= Real(10);
    for (int i = 0; i > exponent; --i) product /= Real(10);
    return product;
  }
};

/// Reads digits[.digits][e[+-]digits]; what lies beyond 36 digits is left out.
consteval Decimal operator""_decimal(const char* text) {
  Decimal x;
  int digits = 0, exponent = 0;
  bool point = false;
  for (; *text != '\0' && *text != 'e' && *text != 'E'; ++text) {
    if (*text == '.') {
      point = true;
      continue;
    }
    if (point) --exponent;
    if (digits < 36 && (digits > 0 || *text != '0')) {
      long long& part = digits < 18 ? x.head : x.tail;
      part = 10 * part + (*text - '0');
      ++digits;
    } else if (digits >= 36) {
      ++exponent;
    }
  }
  if (*text != '\0') {
    ++text;
    const bool negative = *text == '-';
    if (*text == '-' || *text == '+') ++text;
    int written = 0;
    for (; *text != '\0'; ++text) written = 10 * written + (*text - '0');
    exponent += negative ? -written : written;
  }
  for (; digits < 36; ++digits, --exponent) {
    long long& part = digits < 18 ? x.head : x.tail;
    part *= 10;
  }
  x.scale = -(exponent + 18);
  return x;
}

}  // namespace anholon::integrate
