// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/lowering.hpp"

#include <cln/integer_ring.h>
#include <cln/rational_ring.h>

#include <algorithm>
#include <numeric>
#include <unordered_set>

#include "algebra/factors.hpp"

namespace anholon {
namespace {

/// p = common * inside + rest, where `common` is a variable or a rational.
struct Split {
  Polynomial common;
  Polynomial inside;
  Polynomial rest;
};

/// The variable, or else the coefficient, that most terms share; ties go to the first.
Split most_shared(const Polynomial& p) {
  std::size_t most = 1;
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < p.variable_count(); ++i) {
    std::size_t users = 0;
    for (const auto& [monomial, c] : p.terms()) users += i < monomial.size() && monomial[i] > 0 ? 1 : 0;
    if (users > most) {
      most = users;
      chosen = i;
    }
  }
  std::map<cln::cl_RA, std::size_t> users_of;  // by magnitude
  for (const auto& [monomial, c] : p.terms()) {
    if (cln::abs(c) != 1) ++users_of[cln::abs(c)];
  }
  cln::cl_RA shared = 0;
  std::size_t shared_by = most;
  for (const auto& [magnitude, users] : users_of) {
    if (users > shared_by && users < p.size()) {
      shared = magnitude;
      shared_by = users;
    }
  }
  Split result;
  for (const auto& [monomial, c] : p.terms()) {
    if (!cln::zerop(shared)) {
      cln::abs(c) == shared ? result.inside.add_term(monomial, c / shared)
                            : result.rest.add_term(monomial, c);
    } else if (most > 1 && chosen < monomial.size() && monomial[chosen] > 0) {
      Monomial lower = monomial;
      --lower[chosen];
      while (!lower.empty() && lower.back() == 0) lower.pop_back();
      result.inside.add_term(lower, c);
    } else {
      result.rest.add_term(monomial, c);
    }
  }
  result.common = cln::zerop(shared) ? Polynomial::variable(chosen) : Polynomial(shared);
  return result;
}

/// f = whole + rest / denominator: whole terms where the denominator is a monomial or constant.
struct Parts {
  Polynomial whole;
  Polynomial rest;
};

Parts parted(const Fraction& f) {
  Parts result;
  if (f.denominator.size() > 1) {
    result.rest = f.numerator;
    return result;
  }
  for (const auto& [monomial, coefficient] : f.numerator.terms()) {
    const Polynomial term = Polynomial::term(monomial, coefficient);
    if (const auto quotient = divide(term, f.denominator)) {
      result.whole = result.whole + *quotient;
    } else {
      result.rest = result.rest + term;
    }
  }
  return result;
}

}  // namespace

NodeId Lowering::scaled(const cln::cl_RA& factor, NodeId id) {
  return tape_->apply(Op::mul, tape_->constant(Exact(cln::cl_R(factor))), id);
}

NodeId Lowering::power(NodeId base, unsigned exponent) {
  if (exponent == 0) return tape_->constant(1);
  if (exponent == 1) return base;
  const NodeId half = power(base, exponent / 2);
  const NodeId square = tape_->apply(Op::mul, half, half);
  return exponent % 2 == 0 ? square : tape_->apply(Op::mul, square, base);
}

NodeId Lowering::polynomial(const Polynomial& p) {
  if (p.is_zero()) return tape_->constant(0);
  if (p.is_constant()) return tape_->constant(Exact(cln::cl_R(p.constant())));
  for (const Circle& circle : ring_->circles()) {  // 1 - c^2 = s^2
    for (const auto& [from, to] :
         {std::pair{circle.cosine, circle.sine}, std::pair{circle.sine, circle.cosine}}) {
      if (p.degree(from) < 2 || p.degree(to) > 0) continue;
      const auto quotient = divide(p, Polynomial(1) - pow(Polynomial::variable(from), 2));
      if (quotient) return polynomial(*quotient * pow(Polynomial::variable(to), 2));
    }
  }
  if (cln::minusp(p.leading_coefficient())) return tape_->apply(Op::neg, leading_positive(-p));
  return leading_positive(p);
}

NodeId Lowering::leading_positive(const Polynomial& p) {
  const auto found = known_.find(p);
  if (found != known_.end()) return found->second;
  // Content out unless that leaves more factors different from one: 2 a + 3 b stays, 2 a + 2 b and a / 3 + b
  // / 3 do not.
  cln::cl_RA content = signed_content(p);
  const auto non_units = [&p](const cln::cl_RA& divisor) {
    return std::ranges::count_if(p.terms(), [&](const auto& t) { return cln::abs(t.second / divisor) != 1; });
  };
  if (p.size() > 1 && non_units(content) + 1 > non_units(1)) content = 1;
  const Polynomial core = cln::recip(content) * p;
  const NodeId result = scaled(content, core.is_constant() ? tape_->constant(1) : product(core));
  known_.emplace(p, result);
  return result;
}

NodeId Lowering::product(const Polynomial& p) {
  const auto parts = factors(p);
  const auto is_sum = [](const auto& part) { return part.first.size() > 1; };
  const cln::cl_RA content = signed_content(p);  // the factors multiply to the primitive part
  NodeId monomial = tape_->constant(1);
  for (const auto& [factor, exponent] : parts) {
    if (factor.size() == 1) monomial = tape_->apply(Op::mul, monomial, power(sum(factor), exponent));
  }
  const auto sums = std::ranges::count_if(parts, is_sum);
  if (sums == 0) return scaled(content, monomial);
  // The coefficients go to the only factor, if there is one.
  NodeId factored = monomial;
  const bool is_single = sums == 1 && std::ranges::find_if(parts, is_sum)->second == 1;
  for (const auto& [factor, exponent] : parts) {
    if (factor.size() == 1) continue;
    factored =
        tape_->apply(Op::mul, factored, power(nested(is_single ? content * factor : factor), exponent));
  }
  if (is_single) return factored;
  factored = scaled(content, factored);
  const Polynomial rest = *divide(p, Polynomial::term(monomial_content(p), 1));
  const NodeId plain =
      tape_->apply(Op::mul, monomial, nested(rest));  // x^2 - y^2 costs less than its factors
  return operation_weight(*tape_, {plain}) <= operation_weight(*tape_, {factored}) ? plain : factored;
}

NodeId Lowering::nested(const Polynomial& p) {
  if (p.size() == 1) return sum(p);
  const Split split = most_shared(p);
  if (split.inside.size() < 2) return sum(p);
  const NodeId inside = polynomial(split.inside);
  NodeId product = 0;
  bool negative = false;
  if (tape_->node(inside).op == Op::neg) {
    negative = true;
    product = tape_->apply(Op::mul, polynomial(split.common), tape_->node(inside).a);
  } else {
    product = tape_->apply(Op::mul, polynomial(split.common), inside);
  }
  if (split.rest.is_zero()) return negative ? tape_->apply(Op::neg, product) : product;
  const NodeId rest = polynomial(split.rest);
  return negative ? tape_->apply(Op::sub, rest, product) : tape_->apply(Op::add, product, rest);
}

NodeId Lowering::sum(const Polynomial& p) {
  std::vector<std::pair<bool, NodeId>> terms;  // negative?, magnitude
  for (const auto& [monomial, coefficient] : p.terms()) {
    unsigned common = 0;  // x^2 y^2 = (x y)^2
    for (const auto exponent : monomial) common = std::gcd(common, unsigned{exponent});
    NodeId id = tape_->constant(1);
    for (std::size_t i = 0; i < monomial.size(); ++i) {
      if (monomial[i] > 0) id = tape_->apply(Op::mul, id, power(ring_->variables()[i], monomial[i] / common));
    }
    id = power(id, std::max(common, 1U));
    terms.emplace_back(cln::minusp(coefficient), scaled(cln::abs(coefficient), id));
  }
  std::stable_partition(terms.begin(), terms.end(), [](const auto& t) { return !t.first; });
  const bool all_negative = terms.front().first;
  NodeId result = terms.front().second;
  for (std::size_t i = 1; i < terms.size(); ++i) {
    result = tape_->apply(terms[i].first == all_negative ? Op::add : Op::sub, result, terms[i].second);
  }
  return all_negative ? tape_->apply(Op::neg, result) : result;
}

std::vector<NodeId> Lowering::fractions(const std::vector<Fraction>& values) {
  struct User {
    std::size_t index;
    Polynomial numerator;
  };
  std::map<Polynomial, std::vector<User>> by_denominator;
  std::vector<NodeId> result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    auto [whole, rest] = parted(values[i]);
    result.push_back(polynomial(whole));
    if (!rest.is_zero()) by_denominator[values[i].denominator].push_back({i, std::move(rest)});
  }
  for (const auto& [denominator, users] : by_denominator) {
    Polynomial common;
    for (const User& user : users) common = gcd(common, user.numerator);
    if (users.size() == 1) common = users.front().numerator;
    const NodeId shared = tape_->apply(Op::div, polynomial(common), polynomial(denominator));
    for (const User& user : users) {
      const NodeId rest = tape_->apply(Op::mul, polynomial(*divide(user.numerator, common)), shared);
      result[user.index] = tape_->apply(Op::add, result[user.index], rest);
    }
  }
  return result;
}

std::size_t operation_weight(const Tape& tape, const std::vector<NodeId>& roots) {
  std::size_t result = 0;
  std::unordered_set<NodeId> seen;  // asked, never iterated
  std::vector<NodeId> open = roots;
  while (!open.empty()) {
    const NodeId id = open.back();
    open.pop_back();
    if (!seen.insert(id).second) continue;
    const Node& n = tape.node(id);
    const int arity = info(n.op).arity;
    if (arity >= 1) open.push_back(n.a);
    if (arity == 2) open.push_back(n.b);
    switch (info(n.op).cost) {
      case CostClass::none:
        break;
      case CostClass::addition:
      case CostClass::multiplication:
        result += 2;
        break;
      case CostClass::negation:
        result += 1;
        break;
      case CostClass::division:
      case CostClass::root:
        result += 8;
        break;
      default:
        result += 40;
        break;
    }
  }
  return result;
}

}  // namespace anholon
