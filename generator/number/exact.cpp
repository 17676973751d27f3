// SPDX-License-Identifier: GPL-2.0-or-later
#include "number/exact.hpp"

#include <cln/exception.h>
#include <cln/float.h>
#include <cln/integer.h>
#include <cln/integer_io.h>
#include <cln/integer_ring.h>
#include <cln/rational.h>
#include <cln/rational_ring.h>
#include <cln/real.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace anholon {
namespace {

constexpr unsigned default_digits = 128;
constexpr unsigned fewest_digits = 40;  // fewer, and sines near a half could not be told from a half
constexpr unsigned rational_bits = 256;
constexpr int exponent_limit = 4096;

unsigned& digits_in_use() {
  static unsigned digits = default_digits;
  return digits;
}

cln::float_format_t working_format() { return cln::float_format(digits_in_use()); }

cln::cl_F to_float(const cln::cl_R& x) {
  if (cln:: instanceof (x, cln::cl_RA_ring)) return cln::cl_float(x, working_format());
  return cln::the<cln::cl_F>(x);
}

cln::cl_RA to_rational(const cln::cl_R& x) { return cln::rational(x); }

/// A rational that has outgrown its bound becomes a float, and a float that vanishes the rational zero.
cln::cl_R bounded(const cln::cl_R& x) {
  if (!cln:: instanceof (x, cln::cl_RA_ring)) return cln::zerop(x) ? cln::cl_R(0) : x;
  const auto q = cln::the<cln::cl_RA>(x);
  const auto bits = cln::integer_length(cln::numerator(q)) + cln::integer_length(cln::denominator(q));
  return bits <= 2 * rational_bits
             ? x
             : cln::cl_R(cln::cl_float(x, cln::float_format(std::max(default_digits, digits_in_use()))));
}

/// Values of sin and cos at the exact angles (pi/6, pi/2, ...) come back as the rationals that they are. A
/// small angle is none of these, and its sine is small without being 0.
Exact snapped(const cln::cl_R& angle, const cln::cl_F& x) {
  if (cln::abs(angle) < cln::cl_RA(1) / 10) return Exact(cln::cl_R(x));
  for (const long twice : {-2L, -1L, 0L, 1L, 2L}) {
    const cln::cl_RA candidate = cln::cl_RA(twice) / 2;
    const cln::cl_F noise =
        cln::cl_float(cln::expt(cln::cl_RA(10), -static_cast<long>(digits_in_use()) + 12), x);
    if (cln::abs(x - cln::cl_float(candidate, x)) < noise) return Exact(cln::cl_R(candidate));
  }
  return Exact(cln::cl_R(x));
}

cln::cl_I power_of_ten(long exponent) {
  return exponent == 0 ? cln::cl_I(1)
                       : cln::expt_pos(cln::cl_I(10), cln::cl_I(exponent));  // expt_pos needs > 0
}

}  // namespace

WorkingDigits::WorkingDigits(unsigned digits) : previous_(digits_in_use()) {
  digits_in_use() = std::max(digits, fewest_digits);
}
WorkingDigits::~WorkingDigits() { digits_in_use() = previous_; }
unsigned WorkingDigits::current() { return digits_in_use(); }

Exact::Exact(const cln::cl_R& value) : value_(bounded(value)) {}

Exact Exact::ratio(long numerator, long denominator) {
  if (denominator == 0) throw std::domain_error("division by zero");
  return Exact(cln::cl_R(cln::cl_RA(numerator) / cln::cl_RA(denominator)));
}

Exact Exact::from_decimal(std::string_view text) {
  const auto fail = [&] { return std::invalid_argument(fmt::format("'{}' is not a decimal number", text)); };
  std::size_t at = 0;
  bool negative = false;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) negative = text[at++] == '-';
  std::string digits;
  long point_shift = 0;
  bool seen_point = false;
  for (; at < text.size() && (std::isdigit(static_cast<unsigned char>(text[at])) != 0 || text[at] == '.');
       ++at) {
    if (text[at] == '.') {
      if (seen_point) throw fail();
      seen_point = true;
    } else {
      digits += text[at];
      if (seen_point) --point_shift;
    }
  }
  if (digits.empty()) throw fail();
  long exponent = 0;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    ++at;
    bool negative_exponent = false;
    if (at < text.size() && (text[at] == '+' || text[at] == '-')) negative_exponent = text[at++] == '-';
    if (at == text.size()) throw fail();
    for (; at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0; ++at) {
      exponent = 10 * exponent + (text[at] - '0');
      if (exponent > exponent_limit)
        throw std::invalid_argument(fmt::format("the exponent of '{}' is beyond {}", text, exponent_limit));
    }
    if (negative_exponent) exponent = -exponent;
  }
  if (at != text.size()) throw fail();
  exponent += point_shift;
  cln::cl_RA value = cln::cl_I(digits.c_str());
  value = exponent >= 0 ? value * power_of_ten(exponent) : value / power_of_ten(-exponent);
  return Exact(cln::cl_R(negative ? -value : value));
}

Exact Exact::from_double(double value) {
  if (!std::isfinite(value)) throw std::domain_error("not a finite number");
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);  // CLN flushes subnormal doubles: go through integers
  const auto scaled = static_cast<long>(std::ldexp(fraction, 53));
  const cln::cl_RA shift = cln::expt(cln::cl_RA(2), exponent - 53);
  Exact result;
  result.value_ = cln::cl_RA(scaled) * shift;  // exact, whatever its size
  return result;
}

Exact Exact::pi() { return Exact(cln::cl_R(cln::pi(working_format()))); }

bool Exact::is_rational() const { return cln:: instanceof (value_, cln::cl_RA_ring); }
bool Exact::is_integer() const { return cln:: instanceof (value_, cln::cl_I_ring); }
bool Exact::is_zero() const { return cln::zerop(value_); }
Exact Exact::as_float() const {
  Exact result;
  result.value_ = cln::cl_float(value_, working_format());
  return result;
}

double Exact::to_double() const {
  if (const double near = cln::double_approx(value_); std::isnormal(near)) {
    const double rest = cln::double_approx((*this - from_double(near)).value_);
    const double next = std::nextafter(near, std::copysign(std::numeric_limits<double>::infinity(), rest));
    const double way = rest / (next - near);
    if (rest == 0 || std::abs(way) < 0.5 - 1e-9) return near;
    if (way > 0.5 + 1e-9 && way < 1 && std::isnormal(next)) return next;
  }
  // through 25 correct decimal digits: halves, and subnormals
  return std::strtod(decimal(25).c_str(), nullptr);
}

std::string Exact::decimal(unsigned digits) const {
  if (is_zero()) return "0";
  const cln::cl_RA x = cln::abs(to_rational(value_));
  // x lies in [2^(e-1), 2^(e+1)), which leaves two candidates for its decimal exponent
  const auto bits = static_cast<long>(cln::integer_length(cln::numerator(x))) -
                    static_cast<long>(cln::integer_length(cln::denominator(x)));
  auto exponent = static_cast<long>(std::floor(static_cast<double>(bits - 1) * 0.30102999566398120));
  const auto scaled = [&](long shift) {
    const cln::cl_RA y = shift >= 0 ? x * power_of_ten(shift) : x / power_of_ten(-shift);
    return cln::floor1(y + cln::cl_RA(1) / 2);
  };
  const auto count = static_cast<long>(digits);
  cln::cl_I mantissa = scaled(count - 1 - exponent);
  while (mantissa >= power_of_ten(count)) mantissa = scaled(count - 1 - ++exponent);
  while (mantissa < power_of_ten(count - 1)) mantissa = scaled(count - 1 - --exponent);
  std::ostringstream stream;
  stream << mantissa;
  std::string text = stream.str();
  text.erase(text.find_last_not_of('0') + 1);
  const std::string sign = cln::minusp(value_) ? "-" : "";
  const auto size = static_cast<long>(text.size());
  if (exponent >= 0 && exponent < 16) {
    if (size <= exponent + 1)
      return sign + text + std::string(static_cast<std::size_t>(exponent + 1 - size), '0');
    return sign + text.substr(0, static_cast<std::size_t>(exponent + 1)) + "." +
           text.substr(static_cast<std::size_t>(exponent + 1));
  }
  if (exponent < 0 && exponent >= -5)
    return sign + "0." + std::string(static_cast<std::size_t>(-exponent - 1), '0') + text;
  return fmt::format("{}{}{}{}e{}", sign, text.substr(0, 1), size > 1 ? "." : "", text.substr(1), exponent);
}

std::string Exact::key() const {
  if (!is_rational()) return "f" + decimal(120);
  // streams of CLN are slow, and most constants are short
  const auto digits = [](const cln::cl_I& i) {
    if (cln::integer_length(i) < 63) return std::to_string(cln::cl_I_to_long(i));
    std::ostringstream stream;
    stream << i;
    return stream.str();
  };
  const auto rational = cln::the<cln::cl_RA>(value_);
  return digits(cln::numerator(rational)) + '/' + digits(cln::denominator(rational));
}

Exact operator+(const Exact& a, const Exact& b) { return Exact(a.value_ + b.value_); }
Exact operator-(const Exact& a, const Exact& b) { return Exact(a.value_ - b.value_); }
Exact operator*(const Exact& a, const Exact& b) { return Exact(a.value_ * b.value_); }
Exact operator/(const Exact& a, const Exact& b) {
  if (b.is_zero()) throw std::domain_error("division by zero");
  return Exact(a.value_ / b.value_);
}
Exact operator-(const Exact& a) { return Exact(-a.value_); }
bool operator==(const Exact& a, const Exact& b) { return cln::zerop(a.value_ - b.value_); }
std::strong_ordering operator<=>(const Exact& a, const Exact& b) {
  const int order = static_cast<int>(cln::compare(a.value_, b.value_));
  return order < 0   ? std::strong_ordering::less
         : order > 0 ? std::strong_ordering::greater
                     : std::strong_ordering::equal;
}

Exact sqrt(const Exact& x) {
  if (cln::minusp(x.value())) throw std::domain_error("square root of a negative number");
  if (x.is_rational()) {
    cln::cl_RA root;
    if (cln::sqrtp(cln::the<cln::cl_RA>(x.value()), &root)) return Exact(cln::cl_R(root));
  }
  return Exact(cln::cl_R(cln::sqrt(to_float(x.value()))));
}
Exact sin(const Exact& x) {
  if (x.is_zero()) return 0;
  return snapped(x.value(), cln::sin(to_float(x.value())));
}
Exact cos(const Exact& x) {
  if (x.is_zero()) return 1;
  return snapped(x.value(), cln::cos(to_float(x.value())));
}
Exact tan(const Exact& x) { return sin(x) / cos(x); }
Exact asin(const Exact& x) {
  if (abs(x) > Exact(1)) throw std::domain_error("arcsine of a number beyond 1");
  return atan2(x, sqrt(Exact(1) - x * x));
}
Exact acos(const Exact& x) {
  if (abs(x) > Exact(1)) throw std::domain_error("arccosine of a number beyond 1");
  return atan2(sqrt(Exact(1) - x * x), x);
}
Exact atan2(const Exact& y, const Exact& x) {
  if (x.is_zero() && y.is_zero()) return 0;
  if (y.is_zero() && cln::plusp(x.value())) return 0;
  return Exact(cln::atan(to_float(x.value()), to_float(y.value())));
}
Exact exp(const Exact& x) {
  if (x.is_zero()) return 1;
  if (abs(x) > Exact(1 << 20)) throw std::domain_error("exponential out of range");
  return Exact(cln::cl_R(cln::exp(to_float(x.value()))));
}
Exact log(const Exact& x) {
  if (!cln::plusp(x.value())) throw std::domain_error("logarithm of a number that is not positive");
  if (x == Exact(1)) return 0;
  return Exact(cln::cl_R(cln::ln(to_float(x.value()))));
}
Exact tanh(const Exact& x) {
  if (x.is_zero()) return 0;
  if (abs(x) > Exact(1 << 12)) return sign(x);
  return Exact(cln::cl_R(cln::tanh(to_float(x.value()))));
}
Exact abs(const Exact& x) { return cln::minusp(x.value()) ? -x : x; }
Exact sign(const Exact& x) { return x.is_zero() ? 0 : cln::minusp(x.value()) ? -1 : 1; }
bool isfinite(const Exact& /*x*/) { return true; }

}  // namespace anholon
