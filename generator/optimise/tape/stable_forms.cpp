// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/tape/stable_forms.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "optimise/tape/dead_code.hpp"
#include "optimise/tape/rebuild.hpp"
#include "tape/expr.hpp"

namespace anholon {
namespace {

/// A term of a sum: a number times factors that are no numbers, sorted by structure.
struct Product {
  Exact number = 1;
  std::vector<NodeId> factors;
};

class StableSums {
 public:
  StableSums(Tape& tape, const std::vector<NodeId>& roots) : tape_(tape), inner_(tape.size(), 0) {
    const std::vector<NodeId> needed = needed_nodes(tape, roots);
    std::vector<int> uses(tape.size(), 0);
    for (const NodeId id : needed) {
      const Node& n = tape.node(id);
      if (info(n.op).arity >= 1) ++uses[n.a];
      if (info(n.op).arity == 2) ++uses[n.b];
    }
    for (const NodeId root : roots) uses[root] += 2;
    for (const NodeId id : needed) {
      const Node& n = tape.node(id);
      if (!is_sum(id)) continue;
      for (const NodeId x : {n.a, n.b}) {
        if (is_sum(x) && uses[x] == 1) inner_[x] = 1;
      }
    }
  }

  NodeId operator()(NodeId old, const std::vector<NodeId>& image) {
    if (!is_sum(old) || inner_[old] != 0) return copied(tape_, old, image);
    std::vector<Product> terms;
    flatten(old, false, image, terms);
    if (terms.size() > most_terms) return copied(tape_, old, image);
    std::vector<Expr> rewritten;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      for (std::size_t j = 0; j < terms.size(); ++j) {
        if (i == j) continue;
        const std::optional<Expr> form = stable(terms[i], terms[j]);
        if (!form) continue;
        rewritten.push_back(*form);
        terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(std::max(i, j)));
        terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(std::min(i, j)));
        i = static_cast<std::size_t>(-1);  // from the beginning
        break;
      }
    }
    if (rewritten.empty()) return copied(tape_, old, image);
    Expr sum = 0;
    for (const Expr& e : rewritten) sum += e;
    for (const Product& t : terms) sum += product(t.number, t.factors);
    return sum.id(tape_);
  }

 private:
  static constexpr std::size_t most_terms = 24, most_factors = 12;

  [[nodiscard]] bool is_sum(NodeId id) const {
    return tape_.node(id).op == Op::add || tape_.node(id).op == Op::sub;
  }
  [[nodiscard]] bool is(NodeId id, Op op) const { return tape_.node(id).op == op; }
  [[nodiscard]] Expr expr(NodeId id) const { return {tape_, id}; }
  [[nodiscard]] Expr number(const Exact& value) const { return {tape_, tape_.constant(value)}; }
  /// Numbers of nodes depend on the order in which a compiler evaluates operands.
  [[nodiscard]] auto by_structure() const {
    return [this](NodeId x, NodeId y) { return tape_.key(x) < tape_.key(y); };
  }
  /// What a function is of.
  [[nodiscard]] Expr argument(NodeId id) const { return expr(tape_.node(id).a); }

  void flatten(NodeId id, bool negative, const std::vector<NodeId>& image,
               std::vector<Product>& terms) const {
    const Node n = tape_.node(id);
    for (const auto& [x, sign] : {std::pair{n.a, negative}, std::pair{n.b, negative != (n.op == Op::sub)}}) {
      if (inner_[x] != 0) {
        flatten(x, sign, image, terms);
        continue;
      }
      Product p;
      if (sign) p.number = -1;
      take_factors(image[x], p);
      std::ranges::sort(p.factors, by_structure());
      terms.push_back(std::move(p));
    }
  }

  void take_factors(NodeId id, Product& p) const {
    const Node n = tape_.node(id);
    if (tape_.is_constant(id)) {
      p.number *= tape_.value(id);
    } else if (n.op == Op::neg) {
      p.number *= Exact(-1);
      take_factors(n.a, p);
    } else if (n.op == Op::mul && p.factors.size() < most_factors) {
      take_factors(n.a, p);
      take_factors(n.b, p);
    } else {
      p.factors.push_back(id);
    }
  }

  [[nodiscard]] Expr product(const Exact& x, const std::vector<NodeId>& factors) const {
    Expr result = 1;
    for (const NodeId f : factors) result *= expr(f);
    return number(x) * result;
  }

  /// The sum of both terms, where it is one of the forms, with p in the place of the first term there.
  [[nodiscard]] std::optional<Expr> stable(const Product& p, const Product& q) const {
    std::vector<NodeId> common, a, b;
    std::ranges::set_intersection(p.factors, q.factors, std::back_inserter(common), by_structure());
    std::ranges::set_difference(p.factors, common, std::back_inserter(a), by_structure());
    std::ranges::set_difference(q.factors, common, std::back_inserter(b), by_structure());
    if (const auto root = root_minus_number(p.number, a, q.number, b)) return product(1, common) * *root;
    if (!(p.number + q.number).is_zero()) return std::nullopt;
    const std::optional<Expr> form = difference(a, b);
    if (!form) return std::nullopt;
    return product(p.number, common) * *form;
  }

  /// a - b without common factors.
  [[nodiscard]] std::optional<Expr> difference(const std::vector<NodeId>& a,
                                               const std::vector<NodeId>& b) const {
    const auto square_of = [](const std::vector<NodeId>& x) { return x.size() == 2 && x[0] == x[1]; };
    const auto all = [&](const std::vector<NodeId>& x, Op op) {
      return !x.empty() && std::ranges::all_of(x, [&](NodeId id) { return is(id, op); });
    };
    const auto half = [](const Expr& x) { return Expr(1) / Expr(2) * x; };
    if (a.empty()) {
      if (square_of(b) && is(b[0], Op::cos)) return squared(sin(argument(b[0])));
      if (square_of(b) && is(b[0], Op::sin)) return squared(cos(argument(b[0])));
      if (square_of(b)) return (Expr(1) - expr(b[0])) * (Expr(1) + expr(b[0]));
      if (!all(b, Op::cos)) return std::nullopt;
      Expr sum = 0, before = 1;  // 1 - c1 c2 ... = (1 - c1) + c1 (1 - c2) + ...
      for (const NodeId c : b) {
        sum += before * (Expr(2) * squared(sin(half(argument(c)))));
        before *= expr(c);
      }
      return sum;
    }
    if (a.size() == 1 && b.empty() && is(a[0], Op::exp))
      return tanh(half(argument(a[0]))) * (expr(a[0]) + Expr(1));
    if (square_of(a) && square_of(b)) {
      const bool of_one_angle =
          is(a[0], Op::cos) && is(b[0], Op::sin) && tape_.node(a[0]).a == tape_.node(b[0]).a;
      if (of_one_angle) return cos(Expr(2) * argument(a[0]));
      return (expr(a[0]) - expr(b[0])) * (expr(a[0]) + expr(b[0]));
    }
    if (a.size() == 1 && b.size() == 1 && is(a[0], Op::cos) && is(b[0], Op::cos)) {
      const Expr x = argument(a[0]), y = argument(b[0]);
      return Expr(2) * sin(half(x + y)) * sin(half(y - x));
    }
    if (a.size() == 1 && b.size() == 1 && is(a[0], Op::sin) && is(b[0], Op::sin)) {
      const Expr x = argument(a[0]), y = argument(b[0]);
      return Expr(2) * cos(half(x + y)) * sin(half(x - y));
    }
    return sine_of_difference(a, b);
  }

  /// sin x cos y - cos x sin y
  [[nodiscard]] std::optional<Expr> sine_of_difference(const std::vector<NodeId>& a,
                                                       const std::vector<NodeId>& b) const {
    if (a.size() != 2 || b.size() != 2) return std::nullopt;
    const auto sine_first = [&](std::vector<NodeId> x) {
      if (is(x[0], Op::cos)) std::swap(x[0], x[1]);
      return is(x[0], Op::sin) && is(x[1], Op::cos) ? std::optional(x) : std::nullopt;
    };
    const auto x = sine_first(a), y = sine_first(b);
    if (!x || !y) return std::nullopt;
    const auto of = [&](NodeId id) { return tape_.node(id).a; };
    if (of((*x)[0]) != of((*y)[1]) || of((*x)[1]) != of((*y)[0])) return std::nullopt;
    return sin(argument((*x)[0]) - argument((*y)[0]));
  }

  /// m sqrt(k^2 + x) - m k
  [[nodiscard]] std::optional<Expr> root_minus_number(const Exact& m, const std::vector<NodeId>& a,
                                                      const Exact& negative,
                                                      const std::vector<NodeId>& b) const {
    if (a.size() != 1 || !b.empty() || !is(a[0], Op::sqrt)) return std::nullopt;
    const Exact k = -negative / m;
    const Node radicand = tape_.node(tape_.node(a[0]).a);
    if (!(k > Exact(0)) || radicand.op != Op::add) return std::nullopt;
    for (const auto& [c, x] : {std::pair{radicand.a, radicand.b}, std::pair{radicand.b, radicand.a}}) {
      if (tape_.is_constant(c) && tape_.value(c) == k * k)
        return number(m) * expr(x) / (expr(a[0]) + number(k));
    }
    return std::nullopt;
  }

  static Expr squared(const Expr& x) { return x * x; }

  Tape& tape_;
  std::vector<char> inner_;  // sums that only another sum uses
};

}  // namespace

std::vector<NodeId> stable_forms(Tape& tape, std::vector<NodeId> roots) {
  for (int round = 0; round < 3; ++round) {  // a form may leave another one behind
    StableSums sums(tape, roots);
    std::vector<NodeId> next =
        rebuild(tape, roots, [&](NodeId old, const std::vector<NodeId>& image) { return sums(old, image); });
    if (next == roots) break;
    roots = std::move(next);
  }
  return roots;
}

}  // namespace anholon
