// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/polynomial.hpp"

#include <cln/integer_ring.h>
#include <cln/rational_ring.h>

#include <algorithm>
#include <limits>

namespace anholon {
namespace {

void trim(Monomial& monomial) {
  while (!monomial.empty() && monomial.back() == 0) monomial.pop_back();
}

Monomial product(const Monomial& a, const Monomial& b) {
  Monomial result = a.size() >= b.size() ? a : b;
  const Monomial& other = a.size() >= b.size() ? b : a;
  for (std::size_t i = 0; i < other.size(); ++i) {
    const int exponent = result[i] + other[i];
    if (exponent > std::numeric_limits<std::uint16_t>::max()) throw SizeLimitExceeded();
    result[i] = static_cast<std::uint16_t>(exponent);
  }
  return result;
}

std::optional<Monomial> quotient(const Monomial& a, const Monomial& b) {
  if (b.size() > a.size()) return std::nullopt;
  Monomial result = a;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (a[i] < b[i]) return std::nullopt;
    result[i] = static_cast<std::uint16_t>(a[i] - b[i]);
  }
  trim(result);
  return result;
}

}  // namespace

Polynomial::Polynomial(int value) {
  if (value != 0) terms_.emplace(Monomial(), cln::cl_RA(value));
}

Polynomial::Polynomial(const cln::cl_RA& value) {
  if (!cln::zerop(value)) terms_.emplace(Monomial(), value);
}

Polynomial Polynomial::variable(std::size_t index) {
  Monomial monomial(index + 1, 0);
  monomial[index] = 1;
  return term(std::move(monomial), 1);
}

Polynomial Polynomial::term(Monomial monomial, const cln::cl_RA& coefficient) {
  trim(monomial);
  Polynomial result;
  if (!cln::zerop(coefficient)) result.terms_.emplace(std::move(monomial), coefficient);
  return result;
}

bool Polynomial::is_constant() const { return is_zero() || (size() == 1 && terms_.begin()->first.empty()); }

cln::cl_RA Polynomial::constant() const {
  if (!is_constant()) throw std::logic_error("the polynomial is not constant");
  return is_zero() ? cln::cl_RA(0) : terms_.begin()->second;
}

unsigned Polynomial::degree(std::size_t variable) const {
  unsigned result = 0;
  for (const auto& [monomial, coefficient] : terms_) {
    if (variable < monomial.size()) result = std::max<unsigned>(result, monomial[variable]);
  }
  return result;
}

std::size_t Polynomial::variable_count() const {
  std::size_t result = 0;
  for (const auto& [monomial, coefficient] : terms_) result = std::max(result, monomial.size());
  return result;
}

std::size_t Polynomial::weight() const {
  std::size_t result = 0;
  for (const auto& [monomial, coefficient] : terms_) {
    ++result;
    for (const auto exponent : monomial) result += exponent;
  }
  return result;
}

void Polynomial::add_term(const Monomial& monomial, const cln::cl_RA& coefficient) {
  const auto [found, is_new] = terms_.try_emplace(monomial, coefficient);
  if (!is_new) found->second = found->second + coefficient;
  if (cln::zerop(found->second)) terms_.erase(found);
}

Polynomial operator+(const Polynomial& p, const Polynomial& q) {
  Polynomial result = p;
  for (const auto& [monomial, coefficient] : q.terms_) result.add_term(monomial, coefficient);
  return result;
}

Polynomial operator-(const Polynomial& p, const Polynomial& q) {
  Polynomial result = p;
  for (const auto& [monomial, coefficient] : q.terms_) result.add_term(monomial, -coefficient);
  return result;
}

Polynomial operator*(const Polynomial& p, const Polynomial& q) {
  Polynomial result;
  for (const auto& [a, x] : p.terms_) {
    for (const auto& [b, y] : q.terms_) result.add_term(product(a, b), x * y);
  }
  return result;
}

Polynomial operator*(const cln::cl_RA& factor, const Polynomial& p) {
  if (cln::zerop(factor)) return {};
  Polynomial result = p;
  for (auto& [monomial, coefficient] : result.terms_) coefficient = factor * coefficient;
  return result;
}

Polynomial operator-(const Polynomial& p) { return cln::cl_RA(-1) * p; }

bool operator==(const Polynomial& p, const Polynomial& q) {
  return std::ranges::equal(p.terms_, q.terms_, [](const auto& x, const auto& y) {
    return x.first == y.first && x.second == y.second;
  });
}

bool operator<(const Polynomial& p, const Polynomial& q) {
  return std::ranges::lexicographical_compare(p.terms_, q.terms_, [](const auto& x, const auto& y) {
    return x.first != y.first ? x.first < y.first : x.second < y.second;
  });
}

Polynomial pow(const Polynomial& p, unsigned exponent) {
  Polynomial result = 1;
  for (unsigned i = 0; i < exponent; ++i) result = result * p;
  return result;
}

cln::cl_RA signed_content(const Polynomial& p) {
  if (p.is_zero()) return 1;
  cln::cl_I numerator = 0;
  cln::cl_I denominator = 1;
  for (const auto& [monomial, coefficient] : p.terms()) {
    numerator = cln::gcd(numerator, cln::numerator(coefficient));
    denominator = cln::lcm(denominator, cln::denominator(coefficient));
  }
  const cln::cl_RA content = cln::cl_RA(numerator) / denominator;
  return cln::minusp(p.leading_coefficient()) ? -content : content;
}

Polynomial primitive(const Polynomial& p) { return cln::recip(signed_content(p)) * p; }

Monomial monomial_content(const Polynomial& p) {
  if (p.is_zero()) return {};
  Monomial result = p.terms().begin()->first;
  for (const auto& [monomial, coefficient] : p.terms()) {
    if (result.size() > monomial.size()) result.resize(monomial.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = std::min(result[i], monomial[i]);
  }
  trim(result);
  return result;
}

std::optional<Polynomial> divide(const Polynomial& p, const Polynomial& q) {
  if (q.is_zero()) throw std::domain_error("division by the zero polynomial");
  Polynomial rest = p;
  Polynomial result;
  const auto& [divisor, divisor_coefficient] = *q.terms().begin();
  while (!rest.is_zero()) {
    const auto& [monomial, coefficient] = *rest.terms().begin();
    const auto step = quotient(monomial, divisor);
    if (!step) return std::nullopt;
    const cln::cl_RA factor = coefficient / divisor_coefficient;
    result.add_term(*step, factor);
    const Monomial& shift = *step;
    for (const auto& [m, c] : q.terms()) rest.add_term(product(m, shift), -factor * c);
  }
  return result;
}

Polynomial replace_square(const Polynomial& p, std::size_t variable, std::size_t other) {
  if (p.degree(variable) < 2) return p;
  Polynomial square_of_other = Polynomial(1);
  Monomial w(other + 1, 0);
  w[other] = 2;
  square_of_other.add_term(w, -1);
  Polynomial result;
  for (const auto& [monomial, coefficient] : p.terms()) {
    const unsigned exponent = variable < monomial.size() ? monomial[variable] : 0;
    if (exponent < 2) {
      result.add_term(monomial, coefficient);
      continue;
    }
    Monomial rest = monomial;
    rest[variable] = static_cast<std::uint16_t>(exponent % 2);
    const Polynomial replaced = Polynomial::term(rest, coefficient) * pow(square_of_other, exponent / 2);
    for (const auto& [m, c] : replaced.terms()) result.add_term(m, c);
  }
  return result;
}

Polynomial renumbered(const Polynomial& p, const std::vector<std::size_t>& position) {
  Polynomial result;
  for (const auto& [monomial, coefficient] : p.terms()) {
    Monomial moved(position.size(), 0);
    for (std::size_t i = 0; i < monomial.size(); ++i) moved[position[i]] = monomial[i];
    trim(moved);
    result.add_term(moved, coefficient);
  }
  return result;
}

}  // namespace anholon
