// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Polynomials with rational coefficients over numbered variables. The terms are kept in lexicographic order,
// so that equal polynomials are equal data on every run: what a computer algebra system orders by address
// never gets further than this type.

#include <cln/integer.h>
#include <cln/rational.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

namespace anholon {

/// Exponents by variable, without trailing zeros.
using Monomial = std::vector<std::uint16_t>;

/// An expression outgrew the bound of its computation; bounds count terms, never time.
struct SizeLimitExceeded : std::runtime_error {
  SizeLimitExceeded() : std::runtime_error("the expression exceeds its size limit") {}
};

class Polynomial {
 public:
  using Terms = std::map<Monomial, cln::cl_RA, std::greater<>>;

  Polynomial() = default;
  Polynomial(int value);  // NOLINT: integers are polynomials
  explicit Polynomial(const cln::cl_RA& value);
  static Polynomial variable(std::size_t index);
  static Polynomial term(Monomial monomial, const cln::cl_RA& coefficient);

  [[nodiscard]] const Terms& terms() const { return terms_; }
  [[nodiscard]] std::size_t size() const { return terms_.size(); }
  [[nodiscard]] bool is_zero() const { return terms_.empty(); }
  [[nodiscard]] bool is_constant() const;
  /// Value of a constant polynomial.
  [[nodiscard]] cln::cl_RA constant() const;
  [[nodiscard]] const cln::cl_RA& leading_coefficient() const { return terms_.begin()->second; }
  [[nodiscard]] unsigned degree(std::size_t variable) const;
  /// One more than the largest variable in use.
  [[nodiscard]] std::size_t variable_count() const;
  /// Sum over the terms of 1 + degree: what the polynomial costs to read.
  [[nodiscard]] std::size_t weight() const;

  void add_term(const Monomial& monomial, const cln::cl_RA& coefficient);

  friend Polynomial operator+(const Polynomial& p, const Polynomial& q);
  friend Polynomial operator-(const Polynomial& p, const Polynomial& q);
  friend Polynomial operator*(const Polynomial& p, const Polynomial& q);
  friend Polynomial operator*(const cln::cl_RA& factor, const Polynomial& p);
  friend Polynomial operator-(const Polynomial& p);
  friend bool operator==(const Polynomial& p, const Polynomial& q);
  /// A total order, to look polynomials up.
  friend bool operator<(const Polynomial& p, const Polynomial& q);

 private:
  Terms terms_;
};

Polynomial pow(const Polynomial& p, unsigned exponent);

/// Rational factor that leaves coprime integer coefficients with a positive leading one.
cln::cl_RA signed_content(const Polynomial& p);
/// p / signed_content(p); zero stays zero.
Polynomial primitive(const Polynomial& p);
/// Largest monomial that divides every term.
Monomial monomial_content(const Polynomial& p);
/// p / q where q divides p.
std::optional<Polynomial> divide(const Polynomial& p, const Polynomial& q);
/// Replaces the square of `variable` by 1 - (square of `other`): cosine and sine of one angle.
Polynomial replace_square(const Polynomial& p, std::size_t variable, std::size_t other);
/// Renumbers the variables: the old number i becomes position[i].
Polynomial renumbered(const Polynomial& p, const std::vector<std::size_t>& position);

}  // namespace anholon
