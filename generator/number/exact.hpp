// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Exact numbers. A value is a rational as long as it fits in 256 bits, else a binary float that carries its
// own digits. Decimal text is read exactly; sines and roots are computed to the working digits.

#include <cln/real.h>

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

namespace anholon {

/// Decimal digits, at least 40, that transcendental functions of exact arguments are computed to; restored at
/// scope end.
class WorkingDigits {
 public:
  explicit WorkingDigits(unsigned digits);
  ~WorkingDigits();
  WorkingDigits(const WorkingDigits&) = delete;
  WorkingDigits& operator=(const WorkingDigits&) = delete;
  static unsigned current();

 private:
  unsigned previous_;
};

class Exact {
 public:
  Exact() = default;
  Exact(int value) : value_(value) {}  // NOLINT: integers are exact, the conversion loses nothing
  explicit Exact(const cln::cl_R& value);

  static Exact ratio(long numerator, long denominator);
  /// Reads [+-]digits[.digits][e[+-]digits] exactly. @throws std::invalid_argument on any other text and on
  /// exponents beyond 4096, which would make a rational of unbounded size.
  static Exact from_decimal(std::string_view text);
  /// The binary value of a finite double, exactly.
  static Exact from_double(double value);
  static Exact pi();

  [[nodiscard]] bool is_rational() const;
  [[nodiscard]] bool is_integer() const;
  [[nodiscard]] bool is_zero() const;
  /// The same value as a float with the working digits.
  [[nodiscard]] Exact as_float() const;
  [[nodiscard]] double to_double() const;
  /// Shortest decimal text with at most `digits` significant digits, rounded half away from zero.
  [[nodiscard]] std::string decimal(unsigned digits) const;
  /// Text that two rationals share exactly when they are equal, and two floats when they agree in all digits.
  [[nodiscard]] std::string key() const;
  [[nodiscard]] const cln::cl_R& value() const { return value_; }

  Exact& operator+=(const Exact& other) { return *this = *this + other; }
  Exact& operator-=(const Exact& other) { return *this = *this - other; }
  Exact& operator*=(const Exact& other) { return *this = *this * other; }
  Exact& operator/=(const Exact& other) { return *this = *this / other; }

  friend Exact operator+(const Exact& a, const Exact& b);
  friend Exact operator-(const Exact& a, const Exact& b);
  friend Exact operator*(const Exact& a, const Exact& b);
  /// @throws std::domain_error when b is zero
  friend Exact operator/(const Exact& a, const Exact& b);
  friend Exact operator-(const Exact& a);
  friend bool operator==(const Exact& a, const Exact& b);
  friend std::strong_ordering operator<=>(const Exact& a, const Exact& b);

 private:
  cln::cl_R value_ = 0;
};

// Real functions; a value outside the domain throws std::domain_error.
Exact sqrt(const Exact& x);
Exact sin(const Exact& x);
Exact cos(const Exact& x);
Exact tan(const Exact& x);
Exact asin(const Exact& x);
Exact acos(const Exact& x);
Exact atan2(const Exact& y, const Exact& x);
Exact exp(const Exact& x);
Exact log(const Exact& x);
Exact tanh(const Exact& x);
Exact abs(const Exact& x);
Exact sign(const Exact& x);
bool isfinite(const Exact& x);

}  // namespace anholon
