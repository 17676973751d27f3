// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/ring.hpp"

#include <cln/integer_ring.h>
#include <cln/rational_ring.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "algebra/factors.hpp"

namespace anholon {
namespace {

constexpr std::size_t circles_tried_together = 4;
constexpr std::size_t terms_of_an_angle_sum = 4;
constexpr int largest_angle_multiple = 4;

}  // namespace

Polynomial Ring::checked(Polynomial p) const {
  if (p.size() > max_terms_) throw SizeLimitExceeded();
  return p;
}

Polynomial Ring::directed(const Polynomial& p, std::uint32_t mask) const {
  Polynomial result = p;
  for (std::size_t i = 0; i < circles_.size(); ++i) {
    const auto [c, s] = circles_[i];
    const bool keep_sine = i < 32 && ((mask >> i) & 1U) != 0;
    result = keep_sine ? replace_square(result, c, s) : replace_square(result, s, c);
  }
  return result;
}

Polynomial Ring::normal(const Polynomial& p) const { return directed(p, 0); }

std::vector<std::uint32_t> Ring::directions() const {
  std::vector<std::uint32_t> masks;
  const std::size_t count = std::min<std::size_t>(circles_.size(), 31);
  if (count <= circles_tried_together) {
    for (std::uint32_t mask = 0; mask < (1U << count); ++mask) masks.push_back(mask);
  } else {
    masks.push_back(0);
    for (std::size_t i = 0; i < count; ++i) masks.push_back(1U << i);
    masks.push_back((1U << count) - 1);
  }
  return masks;
}

Polynomial Ring::lightest(const Polynomial& p) const {
  Polynomial best = p;
  for (const std::uint32_t mask : directions()) {
    Polynomial candidate = directed(p, mask);
    if (candidate.weight() < best.weight()) best = std::move(candidate);
  }
  return best;
}

Fraction Ring::cancelled(const Fraction& f) const {
  if (f.numerator.is_zero()) return {};
  Fraction best = f;
  std::size_t best_weight =
      f.numerator.weight() + 2 * f.denominator.weight() + 1;  // dividing a constant out counts
  for (bool improved = true; improved;) {
    improved = false;
    const Fraction start = best;
    for (const std::uint32_t mask : directions()) {
      Polynomial numerator = directed(start.numerator, mask);
      Polynomial denominator = directed(start.denominator, mask);
      const Polynomial common = gcd(numerator, denominator);
      numerator = *divide(numerator, common);
      denominator = *divide(denominator, common);
      const cln::cl_RA content = signed_content(denominator);
      numerator = cln::recip(content) * numerator;
      denominator = cln::recip(content) * denominator;
      const std::size_t weight = numerator.weight() + 2 * denominator.weight();
      if (weight < best_weight) {
        best = {std::move(numerator), std::move(denominator)};
        best_weight = weight;
        improved = true;
      }
    }
  }
  return {lightest(best.numerator), lightest(best.denominator)};
}

Fraction Ring::reduced(Fraction f) const {
  f.numerator = normal(f.numerator);
  if (f.numerator.is_zero()) return {};
  if (f.denominator.is_constant()) {
    f.numerator = cln::recip(f.denominator.constant()) * f.numerator;
    f.denominator = 1;
    return {checked(std::move(f.numerator)), 1};
  }
  f.denominator = normal(f.denominator);
  if (f.denominator.is_zero()) throw std::domain_error("division by an expression that is zero");
  const Polynomial common = gcd(f.numerator, f.denominator);
  f.numerator = *divide(f.numerator, common);
  f.denominator = *divide(f.denominator, common);
  const cln::cl_RA content = signed_content(f.denominator);
  f.numerator = cln::recip(content) * f.numerator;
  f.denominator = cln::recip(content) * f.denominator;
  return {checked(std::move(f.numerator)), checked(std::move(f.denominator))};
}

Fraction Ring::sum(const Fraction& x, const Fraction& y) const {
  if (x.denominator == y.denominator) return reduced({x.numerator + y.numerator, x.denominator});
  return reduced({x.numerator * y.denominator + y.numerator * x.denominator, x.denominator * y.denominator});
}

Fraction Ring::product(const Fraction& x, const Fraction& y) const {
  if (x.numerator.size() * y.numerator.size() > 16 * max_terms_) throw SizeLimitExceeded();
  return reduced({x.numerator * y.numerator, x.denominator * y.denominator});
}

Fraction Ring::quotient(const Fraction& x, const Fraction& y) const {
  if (y.numerator.is_zero()) throw std::domain_error("division by an expression that is zero");
  if (x.numerator.size() * y.denominator.size() > 16 * max_terms_) throw SizeLimitExceeded();
  return reduced({x.numerator * y.denominator, x.denominator * y.numerator});
}

std::size_t Ring::variable(NodeId id) {
  const auto [found, is_new] = variable_of_.try_emplace(id, variables_.size());
  if (is_new) variables_.push_back(id);
  return found->second;
}

std::size_t Ring::function_variable(NodeId id, const Known& known) {
  const Node& n = tape_->node(id);
  if (info(n.op).arity == 0) return variable(id);
  std::vector<Polynomial> operands{known.at(n.a).numerator, known.at(n.a).denominator};
  if (info(n.op).arity == 2) {
    operands.push_back(known.at(n.b).numerator);
    operands.push_back(known.at(n.b).denominator);
  }
  const auto [found, is_new] = functions_.try_emplace({n.op, std::move(operands)}, 0);
  if (is_new) return found->second = variable(id);
  NodeId& representative = variables_[found->second];
  if (tape_->key(id) < tape_->key(representative)) representative = id;
  return found->second;
}

NodeId Ring::monomial_node(const Monomial& monomial, const cln::cl_I& denominator) {
  std::vector<NodeId> operands;
  for (std::size_t i = 0; i < monomial.size(); ++i)
    operands.insert(operands.end(), monomial[i], variables_[i]);
  std::ranges::sort(operands, [this](NodeId a, NodeId b) { return tape_->key(a) < tape_->key(b); });
  NodeId result = operands.front();
  for (std::size_t i = 1; i < operands.size(); ++i) result = tape_->apply(Op::mul, result, operands[i]);
  return tape_->apply(Op::mul, tape_->constant(Exact(cln::cl_R(cln::recip(cln::cl_RA(denominator))))),
                      result);
}

bool Ring::is_opaque_constant(const Monomial& monomial) const {
  for (std::size_t i = 0; i < monomial.size(); ++i) {
    if (monomial[i] != 0 && tape_->is_constant(variables_[i])) return true;
  }
  return monomial.empty();
}

std::pair<Polynomial, Polynomial> Ring::basic_turn(NodeId argument) {
  const auto found = circle_of_.find(argument);
  if (found != circle_of_.end()) {
    const Circle circle = circles_[found->second];
    return {Polynomial::variable(circle.cosine), Polynomial::variable(circle.sine)};
  }
  const NodeId cosine = tape_->apply(Op::cos, argument);
  const NodeId sine = tape_->apply(Op::sin, argument);
  if (tape_->is_constant(cosine) ||
      tape_->is_constant(sine)) {  // constant angle, perhaps with rational values
    const auto value = [this](NodeId id) {
      const Exact& x = tape_->value(id);
      return x.is_rational() ? Polynomial(cln::the<cln::cl_RA>(x.value()))
                             : Polynomial::variable(variable(id));
    };
    return {value(cosine), value(sine)};
  }
  const Circle circle{variable(cosine), variable(sine)};
  circle_of_.emplace(argument, circles_.size());
  circles_.push_back(circle);
  return {Polynomial::variable(circle.cosine), Polynomial::variable(circle.sine)};
}

std::pair<Polynomial, Polynomial> Ring::turn(NodeId argument, const Fraction& value) {
  const Polynomial& p = value.numerator;
  bool expandable = value.denominator.is_constant() && !p.is_zero() && p.size() <= terms_of_an_angle_sum;
  for (const auto& [monomial, coefficient] : p.terms()) {
    if (is_opaque_constant(monomial) || cln::abs(cln::numerator(coefficient)) > largest_angle_multiple) {
      expandable = false;
    }
  }
  if (!expandable) return basic_turn(argument);
  std::pair<Polynomial, Polynomial> result{1, 0};
  for (const auto& [monomial, coefficient] : p.terms()) {
    const cln::cl_I multiple = cln::numerator(coefficient);
    const auto [c, s] = basic_turn(monomial_node(monomial, cln::denominator(coefficient)));
    const Polynomial signed_sine = cln::minusp(multiple) ? -s : s;
    const int count = cln::cl_I_to_int(cln::abs(multiple));
    for (int i = 0; i < count; ++i) {
      const auto [cosine, sine] = result;
      result = {checked(normal(cosine * c - sine * signed_sine)),
                checked(normal(sine * c + cosine * signed_sine))};
    }
  }
  return result;
}

Fraction Ring::of_node(NodeId id, const Known& known) {
  const Node n = tape_->node(id);
  switch (n.op) {
    case Op::constant: {
      const Exact& x = tape_->value(id);
      if (x.is_rational()) return {Polynomial(cln::the<cln::cl_RA>(x.value())), 1};
      return {Polynomial::variable(variable(id)), 1};
    }
    case Op::add:
      return sum(known.at(n.a), known.at(n.b));
    case Op::sub:
      return sum(known.at(n.a), {-known.at(n.b).numerator, known.at(n.b).denominator});
    case Op::neg:
      return {-known.at(n.a).numerator, known.at(n.a).denominator};
    case Op::mul:
      return product(known.at(n.a), known.at(n.b));
    case Op::div:
      return quotient(known.at(n.a), known.at(n.b));
    case Op::cos:
      return {turn(n.a, known.at(n.a)).first, 1};
    case Op::sin:
      return {turn(n.a, known.at(n.a)).second, 1};
    case Op::tan: {
      const auto [c, s] = turn(n.a, known.at(n.a));
      return quotient({s, 1}, {c, 1});
    }
    default:
      return {Polynomial::variable(function_variable(id, known)), 1};
  }
}

std::vector<Fraction> Ring::convert(const std::vector<NodeId>& roots) {
  Known known;
  for (const NodeId id : tape_->reachable(roots)) {
    try {
      known.emplace(id, of_node(id, known));
    } catch (const SizeLimitExceeded&) {
      if (beyond_ == Beyond::give_up) throw;
      known.emplace(id, Fraction{Polynomial::variable(variable(id)), 1});
    }
  }
  std::vector<Fraction> result;
  for (const NodeId id : roots) result.push_back(known.at(id));

  // Number the variables by structure: inputs, then angles of inputs, then the rest by key.
  const auto rank = [this](NodeId id) {
    const Node& n = tape_->node(id);
    const bool is_turn = n.op == Op::cos || n.op == Op::sin;
    const Node& leaf = is_turn ? tape_->node(n.a) : n;
    const bool of_input = leaf.op == Op::input;
    return std::tuple(of_input ? (is_turn ? 1 : 0) : 2, of_input ? leaf.a : 0U, n.op == Op::sin ? 1 : 0,
                      tape_->key(id));
  };
  std::vector<std::size_t> order(variables_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order,
                    [&](std::size_t a, std::size_t b) { return rank(variables_[a]) < rank(variables_[b]); });
  std::vector<std::size_t> position(order.size());
  std::vector<NodeId> sorted;
  for (std::size_t i = 0; i < order.size(); ++i) {
    position[order[i]] = i;
    sorted.push_back(variables_[order[i]]);
  }
  variables_ = std::move(sorted);
  for (auto& [id, index] : variable_of_) index = position[index];
  for (Circle& circle : circles_) circle = {position[circle.cosine], position[circle.sine]};
  std::ranges::sort(circles_, {}, &Circle::cosine);
  circle_of_.clear();
  functions_.clear();
  for (Fraction& f : result) {
    f = reduced({renumbered(f.numerator, position), renumbered(f.denominator, position)});
  }
  return result;
}

}  // namespace anholon
