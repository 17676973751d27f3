// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/factors.hpp"

#include <cln/integer.h>
#include <cln/rational.h>
#include <ginac/ginac.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>

namespace anholon {
namespace {

constexpr std::size_t gcd_term_limit = 200;
constexpr double gcd_point_limit = 5e4;  // dearer ones are left uncancelled
constexpr std::size_t factor_term_limit = 24;
constexpr std::size_t factor_variable_limit = 8;
constexpr std::size_t factor_degree_limit = 6;

/// GiNaC's view of some polynomials: a symbol for each variable that they use.
class Symbols {
 public:
  GiNaC::ex to_ginac(const Polynomial& p) {
    while (symbols_.size() < p.variable_count()) {
      const std::size_t index = symbols_.size();
      symbols_.emplace_back();
      index_.emplace(symbols_.back(), index);
    }
    GiNaC::exvector terms;
    for (const auto& [monomial, coefficient] : p.terms()) {
      GiNaC::exvector powers{GiNaC::numeric(coefficient)};
      for (std::size_t i = 0; i < monomial.size(); ++i) {
        if (monomial[i] != 0) powers.push_back(GiNaC::pow(symbols_[i], monomial[i]));
      }
      terms.emplace_back(GiNaC::mul(powers));
    }
    return GiNaC::add(terms);
  }

  Polynomial from_ginac(const GiNaC::ex& e) const {
    const GiNaC::ex sum = e.expand();
    Polynomial result;
    if (!GiNaC::is_a<GiNaC::add>(sum)) return term(sum);
    for (std::size_t i = 0; i < sum.nops(); ++i) {
      const Polynomial t = term(sum.op(i));
      for (const auto& [monomial, coefficient] : t.terms()) result.add_term(monomial, coefficient);
    }
    return result;
  }

 private:
  Polynomial term(const GiNaC::ex& e) const {
    if (GiNaC::is_a<GiNaC::mul>(e)) {
      Polynomial result = 1;
      for (std::size_t i = 0; i < e.nops(); ++i) result = result * term(e.op(i));
      return result;
    }
    if (GiNaC::is_a<GiNaC::numeric>(e)) {
      return Polynomial(cln::the<cln::cl_RA>(GiNaC::ex_to<GiNaC::numeric>(e).to_cl_N()));
    }
    const bool is_power = GiNaC::is_a<GiNaC::power>(e);
    const std::size_t variable = index_.at(is_power ? e.op(0) : e);
    Monomial monomial(variable + 1, 0);
    monomial[variable] =
        static_cast<std::uint16_t>(is_power ? GiNaC::ex_to<GiNaC::numeric>(e.op(1)).to_int() : 1);
    return Polynomial::term(std::move(monomial), 1);
  }

  std::vector<GiNaC::symbol> symbols_;
  std::map<GiNaC::ex, std::size_t, GiNaC::ex_is_less> index_;  // looked up, never iterated
};

Polynomial common_monomial(const Polynomial& p, const Polynomial& q) {
  Monomial a = monomial_content(p);
  const Monomial b = monomial_content(q);
  a.resize(std::min(a.size(), b.size()));
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = std::min(a[i], b[i]);
  return Polynomial::term(std::move(a), 1);
}

/// Largest prime below 2^31: products of residues fit in 64 bits.
constexpr std::uint64_t prime = 2147483647;

std::uint64_t power_mod(std::uint64_t base, std::uint64_t exponent) {
  std::uint64_t result = 1;
  for (base %= prime; exponent > 0; exponent /= 2, base = base * base % prime) {
    if (exponent % 2 == 1) result = result * base % prime;
  }
  return result;
}

/// Coefficients of the univariate image modulo the prime, all variables but one replaced by fixed numbers.
std::vector<std::uint64_t> image(const Polynomial& p, std::size_t variable) {
  std::vector<std::uint64_t> result(p.degree(variable) + 1, 0);
  for (const auto& [monomial, coefficient] : p.terms()) {
    const cln::cl_I residue =
        cln::mod(cln::numerator(coefficient), cln::cl_I(static_cast<unsigned long>(prime)));
    std::uint64_t value = cln::cl_I_to_ulong(residue);
    for (std::size_t i = 0; i < monomial.size(); ++i) {
      if (i == variable || monomial[i] == 0) continue;
      const std::uint64_t point = power_mod(1000003, i + 2) % (prime - 2) + 2;
      value = value * power_mod(point, monomial[i]) % prime;
    }
    auto& sum = result[variable < monomial.size() ? monomial[variable] : 0];
    sum = (sum + value) % prime;
  }
  while (!result.empty() && result.back() == 0) result.pop_back();
  return result;
}

/// Whether gcd(p, q) is free of the variable; `false` where this cannot be told. Integer coefficients.
///
/// If the images keep their degrees, the degree of their gcd bounds that of the gcd (Brown 1971): a proof,
/// although the point is arbitrary.
bool gcd_is_free_of(const Polynomial& p, const Polynomial& q, std::size_t variable) {
  const unsigned degree_p = p.degree(variable);
  const unsigned degree_q = q.degree(variable);
  if (degree_p == 0 || degree_q == 0) return true;
  std::vector<std::uint64_t> a = image(p, variable);
  std::vector<std::uint64_t> b = image(q, variable);
  if (a.size() != degree_p + 1 || b.size() != degree_q + 1) return false;
  while (!b.empty()) {  // Euclid
    const std::uint64_t inverse = power_mod(b.back(), prime - 2);
    while (a.size() >= b.size()) {
      const std::uint64_t factor = a.back() * inverse % prime;
      const std::size_t shift = a.size() - b.size();
      for (std::size_t i = 0; i < b.size(); ++i) {
        a[i + shift] = (a[i + shift] + (prime - factor) * b[i]) % prime;
      }
      while (!a.empty() && a.back() == 0) a.pop_back();
    }
    std::swap(a, b);
  }
  return a.size() == 1;
}

/// Coefficients of the powers of a variable.
std::vector<Polynomial> coefficients(const Polynomial& p, std::size_t variable) {
  std::vector<Polynomial> result(p.degree(variable) + 1);
  for (const auto& [monomial, coefficient] : p.terms()) {
    const unsigned exponent = variable < monomial.size() ? monomial[variable] : 0;
    Monomial rest = monomial;
    if (exponent > 0) rest[variable] = 0;
    while (!rest.empty() && rest.back() == 0) rest.pop_back();
    result[exponent].add_term(rest, coefficient);
  }
  std::erase_if(result, [](const Polynomial& c) { return c.is_zero(); });
  return result;
}

std::size_t variables_in_use(const Polynomial& p) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < p.variable_count(); ++i) count += p.degree(i) > 0 ? 1 : 0;
  return count;
}

std::size_t total_degree(const Polynomial& p) {
  std::size_t result = 0;
  for (const auto& [monomial, coefficient] : p.terms()) {
    std::size_t degree = 0;
    for (const auto exponent : monomial) degree += exponent;
    result = std::max(result, degree);
  }
  return result;
}

/// Points at which a modular algorithm evaluates two polynomials: the product over the variables of their
/// degrees plus one. Grows without bound with the number of variables, however few the terms.
double evaluation_points(const Polynomial& f, const Polynomial& g) {
  double points = 1;
  for (std::size_t i = 0; i < std::max(f.variable_count(), g.variable_count()); ++i)
    points *= 1.0 + std::min(f.degree(i), g.degree(i));
  return points;
}

}  // namespace

Polynomial gcd(const Polynomial& p, const Polynomial& q) {
  if (p.is_zero()) return primitive(q);
  if (q.is_zero()) return primitive(p);
  if (p.is_constant() || q.is_constant()) return 1;
  if (p.size() == 1 || q.size() == 1) return common_monomial(p, q);
  const Polynomial f = primitive(p);
  const Polynomial g = primitive(q);
  if (f == g) return f;
  for (std::size_t i = 0; i < std::max(f.variable_count(), g.variable_count()); ++i) {
    if (f.degree(i) == 0 && g.degree(i) == 0) continue;
    if (!gcd_is_free_of(f, g, i)) continue;
    // A divisor without this variable divides every coefficient.
    std::vector<Polynomial> parts = coefficients(f, i);
    std::ranges::move(coefficients(g, i), std::back_inserter(parts));
    std::ranges::stable_sort(parts, {}, &Polynomial::size);
    Polynomial common;
    for (const Polynomial& part : parts) {
      common = gcd(common, part);
      if (common.is_constant()) break;
    }
    return common;
  }
  if (divide(f, g)) return g;
  if (divide(g, f)) return f;
  if (f.size() > gcd_term_limit || g.size() > gcd_term_limit || evaluation_points(f, g) > gcd_point_limit)
    return common_monomial(f, g);
  Symbols symbols;
  const GiNaC::ex a = symbols.to_ginac(f);
  const GiNaC::ex b = symbols.to_ginac(g);
  return primitive(symbols.from_ginac(GiNaC::gcd(a, b)));
}

namespace {

using Factors = std::vector<std::pair<Polynomial, unsigned>>;

void add_factors(const Polynomial& p, Factors& result) {
  if (p.is_constant()) return;
  for (std::size_t i = 0; i < p.variable_count(); ++i) {
    if (p.degree(i) != 1) continue;
    // a x + b with coprime a and b is irreducible.
    const std::vector<Polynomial> parts = coefficients(p, i);
    const Polynomial common = parts.size() == 2 ? gcd(parts[0], parts[1]) : parts[0];
    result.emplace_back(primitive(*divide(p, common)), 1);
    add_factors(primitive(common), result);
    return;
  }
  if (p.size() > factor_term_limit || variables_in_use(p) > factor_variable_limit ||
      total_degree(p) > factor_degree_limit) {
    result.emplace_back(primitive(p), 1);
    return;
  }
  Symbols symbols;
  const GiNaC::ex product = GiNaC::factor(symbols.to_ginac(p));
  const auto add_power = [&](const GiNaC::ex& e) {
    const bool is_power = GiNaC::is_a<GiNaC::power>(e) && e.op(1).info(GiNaC::info_flags::posint);
    const Polynomial factor = primitive(symbols.from_ginac(is_power ? e.op(0) : e));
    if (factor.is_constant()) return;
    const int exponent = is_power ? GiNaC::ex_to<GiNaC::numeric>(e.op(1)).to_int() : 1;
    result.emplace_back(factor, static_cast<unsigned>(exponent));
  };
  if (GiNaC::is_a<GiNaC::mul>(product)) {
    for (std::size_t i = 0; i < product.nops(); ++i) add_power(product.op(i));
  } else {
    add_power(product);
  }
}

}  // namespace

std::vector<std::pair<Polynomial, unsigned>> factors(const Polynomial& p) {
  Factors found;
  if (p.is_zero()) return found;
  const Monomial monomial = monomial_content(p);
  for (std::size_t i = 0; i < monomial.size(); ++i) {
    if (monomial[i] != 0) found.emplace_back(Polynomial::variable(i), monomial[i]);
  }
  add_factors(primitive(*divide(p, Polynomial::term(monomial, 1))), found);
  std::ranges::sort(found);
  Factors result;
  for (const auto& [factor, exponent] : found) {
    if (!result.empty() && result.back().first == factor) {
      result.back().second += exponent;
    } else {
      result.emplace_back(factor, exponent);
    }
  }
  return result;
}

}  // namespace anholon
