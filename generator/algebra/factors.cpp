// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/factors.hpp"

#include <ginac/ginac.h>

#include <algorithm>
#include <map>

namespace anholon {
namespace {

constexpr std::size_t gcd_term_limit = 200;
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

bool share_variables(const Polynomial& p, const Polynomial& q) {
  for (std::size_t i = 0; i < std::min(p.variable_count(), q.variable_count()); ++i) {
    if (p.degree(i) > 0 && q.degree(i) > 0) return true;
  }
  return false;
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

}  // namespace

Polynomial gcd(const Polynomial& p, const Polynomial& q) {
  if (p.is_zero()) return primitive(q);
  if (q.is_zero()) return primitive(p);
  if (!share_variables(p, q)) return 1;
  if (p.size() == 1 || q.size() == 1) return common_monomial(p, q);
  if (divide(p, q)) return primitive(q);
  if (divide(q, p)) return primitive(p);
  if (p.size() > gcd_term_limit || q.size() > gcd_term_limit) return common_monomial(p, q);
  Symbols symbols;
  const GiNaC::ex a = symbols.to_ginac(primitive(p));
  const GiNaC::ex b = symbols.to_ginac(primitive(q));
  return primitive(symbols.from_ginac(GiNaC::gcd(a, b)));
}

std::vector<std::pair<Polynomial, unsigned>> factors(const Polynomial& p) {
  if (p.is_constant()) return {};
  std::vector<std::pair<Polynomial, unsigned>> result;
  const Monomial monomial = monomial_content(p);
  for (std::size_t i = 0; i < monomial.size(); ++i) {
    if (monomial[i] != 0) result.emplace_back(Polynomial::variable(i), monomial[i]);
  }
  const Polynomial core = primitive(*divide(p, Polynomial::term(monomial, 1)));
  const auto add = [&result](const Polynomial& factor, unsigned exponent) {
    if (!factor.is_constant()) result.emplace_back(primitive(factor), exponent);
  };
  if (core.size() < 2 || core.size() > factor_term_limit || variables_in_use(core) > factor_variable_limit ||
      total_degree(core) > factor_degree_limit) {
    add(core, 1);
  } else {
    Symbols symbols;
    const GiNaC::ex product = GiNaC::factor(symbols.to_ginac(core));
    const auto add_power = [&](const GiNaC::ex& e) {
      if (GiNaC::is_a<GiNaC::power>(e) && e.op(1).info(GiNaC::info_flags::posint)) {
        add(symbols.from_ginac(e.op(0)),
            static_cast<unsigned>(GiNaC::ex_to<GiNaC::numeric>(e.op(1)).to_int()));
      } else {
        add(symbols.from_ginac(e), 1);
      }
    };
    if (GiNaC::is_a<GiNaC::mul>(product)) {
      for (std::size_t i = 0; i < product.nops(); ++i) add_power(product.op(i));
    } else {
      add_power(product);
    }
  }
  std::ranges::sort(result, [](const auto& x, const auto& y) {
    return x.first == y.first ? x.second < y.second : x.first < y.first;
  });
  return result;
}

}  // namespace anholon
