// SPDX-License-Identifier: GPL-2.0-or-later
#include "algebra/latex.hpp"

#include <cln/integer.h>
#include <cln/integer_io.h>
#include <cln/integer_ring.h>
#include <cln/rational.h>
#include <cln/rational_ring.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

#include "algebra/closed_form.hpp"

namespace anholon {
namespace {

constexpr std::size_t size_worth_a_name = 6;

/// Place of a factor in a product, and, factor by factor, of a term in a sum: numbers, inputs, cosines and
/// sines, the rest.
using Rank = std::tuple<int, std::uint32_t, int, StructuralKey>;

/// Product with quotients flattened: constant * product of node^exponent.
struct Product {
  bool negative = false;
  Exact constant = 1;
  std::vector<std::pair<NodeId, int>> factors;
};

class Writer {
 public:
  Writer(const Tape& tape, const LatexNames& names) : tape_(&tape), names_(&names) {}

  /// Decides which nodes get a name of their own.
  void choose_names(const std::vector<NodeId>& roots);
  std::string write(NodeId root) { return is_named(root) ? name(root) : expression(root, true); }
  [[nodiscard]] const std::vector<std::string>& definitions() const { return definitions_; }

 private:
  std::string expression(NodeId id, bool is_root = false);
  std::string product(const Product& p);
  std::string factor(NodeId id, int exponent, bool is_alone);
  std::string function(const Node& n, int exponent);
  std::string argument(NodeId id);
  std::string number(const Exact& value);
  std::string name(NodeId id);

  void collect_terms(NodeId id, bool negative, bool is_top,
                     std::vector<std::pair<bool, NodeId>>& terms) const;
  void collect_factors(NodeId id, int exponent, bool is_top, Product& p) const;
  [[nodiscard]] Product product_of(NodeId id, bool is_top) const;
  [[nodiscard]] bool is_named(NodeId id) const { return named_.contains(id); }
  [[nodiscard]] bool is_sum(NodeId id) const {
    return tape_->node(id).op == Op::add || tape_->node(id).op == Op::sub;
  }
  [[nodiscard]] Rank rank(NodeId id) const;
  [[nodiscard]] std::vector<std::pair<Rank, int>> rank_of_term(NodeId id) const;

  const Tape* tape_;
  const LatexNames* names_;
  std::set<NodeId> named_;
  std::map<NodeId, std::string> given_;
  std::vector<std::string> definitions_;
};

void Writer::choose_names(const std::vector<NodeId>& roots) {
  const std::vector<NodeId> order = tape_->reachable(roots);
  std::map<NodeId, std::size_t> users;
  for (const NodeId id : order) {
    const Node& n = tape_->node(id);
    if (info(n.op).arity >= 1) ++users[n.a];
    if (info(n.op).arity == 2 && n.b != n.a) ++users[n.b];
  }
  std::map<NodeId, std::size_t> size;  // symbols and numbers shown, bounded
  const std::size_t bound = names_->entry_size;
  const auto shown = [&](bool with_names) {
    for (const NodeId id : order) {
      const Node& n = tape_->node(id);
      std::size_t s = info(n.op).arity == 0 ? 1 : 0;
      for (int i = 0; i < info(n.op).arity; ++i) {
        const NodeId operand = i == 0 ? n.a : n.b;
        s += is_named(operand) ? 1 : size[operand];
      }
      size[id] = std::min<std::size_t>(s, 100 * bound + 100);
      if (!with_names) continue;
      const bool is_compound = is_sum(id) || n.op == Op::mul || n.op == Op::div;
      if (is_compound && ((users[id] > 1 && s >= size_worth_a_name) || (users[id] > 0 && s > bound)))
        named_.insert(id);
    }
  };
  shown(false);
  for (const NodeId root : roots) {
    if (size[root] > bound) {
      shown(true);
      break;
    }
  }
}

std::string Writer::number(const Exact& value) {
  if (!value.is_rational()) return value.decimal(12);
  const auto q = cln::the<cln::cl_RA>(value.value());
  cln::cl_I rest = cln::denominator(q);
  while (cln::zerop(cln::mod(rest, 2))) rest = cln::exquo(rest, 2);
  while (cln::zerop(cln::mod(rest, 5))) rest = cln::exquo(rest, 5);
  const bool is_decimal = rest == 1 && cln::denominator(q) > 8;  // 0.025, but 1/2
  if (value.is_integer() || is_decimal) return value.decimal(15);
  std::ostringstream numerator;
  std::ostringstream denominator;
  numerator << cln::abs(cln::numerator(q));
  denominator << cln::denominator(q);
  return fmt::format("{}\\frac{{{}}}{{{}}}", cln::minusp(q) ? "-" : "", numerator.str(), denominator.str());
}

Rank Writer::rank(NodeId id) const {
  const Node& n = tape_->node(id);
  if (n.op == Op::constant) return {0, 0, 0, {}};
  if (n.op == Op::input) return {1, n.a, 0, {}};
  const bool is_turn = n.op == Op::cos || n.op == Op::sin || n.op == Op::tan;
  if (is_turn && tape_->node(n.a).op == Op::input)
    return {2, tape_->node(n.a).a, static_cast<int>(n.op == Op::cos ? 0 : 1), {}};
  return {is_turn ? 3 : 4, 0, 0, tape_->key(id)};
}

void Writer::collect_factors(NodeId id, int exponent, bool is_top, Product& p) const {
  const Node& n = tape_->node(id);
  if (is_named(id) && !is_top) {
    p.factors.emplace_back(id, exponent);
  } else if (n.op == Op::neg) {
    p.negative = !p.negative;
    collect_factors(n.a, exponent, false, p);
  } else if (n.op == Op::mul || n.op == Op::div) {
    collect_factors(n.a, exponent, false, p);
    collect_factors(n.b, n.op == Op::mul ? exponent : -exponent, false, p);
  } else if (n.op == Op::constant) {
    p.constant = exponent > 0 ? p.constant * tape_->value(id) : p.constant / tape_->value(id);
  } else {
    p.factors.emplace_back(id, exponent);
  }
}

Product Writer::product_of(NodeId id, bool is_top) const {
  Product raw;
  collect_factors(id, 1, is_top, raw);
  Product p{raw.negative, raw.constant, {}};
  std::ranges::stable_sort(raw.factors, {}, [this](const auto& f) { return rank(f.first); });
  for (const auto& [node, exponent] : raw.factors) {
    if (!p.factors.empty() && p.factors.back().first == node) {
      p.factors.back().second += exponent;
    } else {
      p.factors.emplace_back(node, exponent);
    }
  }
  std::erase_if(p.factors, [](const auto& f) { return f.second == 0; });
  if (p.constant < Exact(0)) {
    p.negative = !p.negative;
    p.constant = -p.constant;
  }
  return p;
}

std::vector<std::pair<Rank, int>> Writer::rank_of_term(NodeId id) const {
  const Product p = product_of(id, false);
  std::vector<std::pair<Rank, int>> ranks;
  for (const auto& [node, exponent] : p.factors) ranks.emplace_back(rank(node), -exponent);
  // Numbers come last in a sum.
  if (ranks.empty()) ranks.emplace_back(Rank{9, 0, 0, {}}, 0);
  return ranks;
}

void Writer::collect_terms(NodeId id, bool negative, bool is_top,
                           std::vector<std::pair<bool, NodeId>>& terms) const {
  const Node& n = tape_->node(id);
  if (is_named(id) && !is_top) {
    terms.emplace_back(negative, id);
  } else if (n.op == Op::add || n.op == Op::sub) {
    collect_terms(n.a, negative, false, terms);
    collect_terms(n.b, n.op == Op::sub ? !negative : negative, false, terms);
  } else if (n.op == Op::neg) {
    collect_terms(n.a, !negative, false, terms);
  } else {
    terms.emplace_back(negative, id);
  }
}

std::string Writer::name(NodeId id) {
  const auto found = given_.find(id);
  if (found != given_.end()) return found->second;
  std::string formula = expression(id, true);  // names what it uses first
  std::string symbol = fmt::format("{}_{{{}}}", names_->intermediate, definitions_.size() + 1);
  definitions_.push_back(fmt::format("{} = {}", symbol, formula));
  given_.emplace(id, symbol);
  return symbol;
}

std::string Writer::expression(NodeId id, bool is_root) {
  std::vector<std::pair<bool, NodeId>> terms;
  collect_terms(id, false, is_root, terms);
  std::ranges::stable_sort(terms, {}, [this](const auto& t) { return rank_of_term(t.second); });
  std::vector<std::pair<bool, std::string>> texts;
  for (const auto& [negative, node] : terms) {
    Product p = product_of(node, is_root && node == id);
    texts.emplace_back(p.negative != negative, "");
    p.negative = false;
    texts.back().second = product(p);
  }
  const auto first_positive = std::ranges::find(texts, false, &std::pair<bool, std::string>::first);
  if (first_positive != texts.end()) std::rotate(texts.begin(), first_positive, first_positive + 1);
  std::string result;
  for (const auto& [negative, text] : texts) {
    if (result.empty()) {
      result = (negative ? "-" : "") + text;
    } else {
      result += (negative ? " - " : " + ") + text;
    }
  }
  return result;
}

std::string Writer::argument(NodeId id) {
  const Node& n = tape_->node(id);
  const std::string text = expression(id);
  return n.op == Op::input || is_named(id) ? " " + text : fmt::format("\\left({}\\right)", text);
}

std::string Writer::function(const Node& n, int exponent) {
  const std::string power = exponent == 1 ? "" : fmt::format("^{{{}}}", exponent);
  switch (n.op) {
    case Op::sin:
    case Op::cos:
    case Op::tan:
    case Op::tanh:
    case Op::log:
      return fmt::format("\\{}{}{}", info(n.op).name, power, argument(n.a));
    case Op::asin:
    case Op::acos:
      return fmt::format("\\arc{}{}{}", info(n.op).name.substr(1), power, argument(n.a));
    case Op::atan2:
      return fmt::format("\\operatorname{{atan2}}{}\\left({}, {}\\right)", power, expression(n.a),
                         expression(n.b));
    case Op::sqrt:
      return fmt::format("\\sqrt{{{}}}{}", expression(n.a), power);
    case Op::exp:
      return fmt::format("e^{{{}{}}}", exponent == 1 ? "" : fmt::format("{}\\,", exponent), expression(n.a));
    case Op::abs:
      return fmt::format("\\left|{}\\right|{}", expression(n.a), power);
    default:
      return fmt::format("\\operatorname{{{}}}{}\\left({}\\right)", info(n.op).name, power, expression(n.a));
  }
}

std::string Writer::factor(NodeId id, int exponent, bool is_alone) {
  const Node& n = tape_->node(id);
  const auto raised = [exponent](const std::string& base) {
    return exponent == 1 ? base : fmt::format("{}^{{{}}}", base, exponent);
  };
  if (is_named(id)) return raised(name(id));
  if (n.op == Op::input) {
    const bool is_given = n.a < names_->inputs.size() && !names_->inputs[n.a].empty();
    const std::string text = is_given ? names_->inputs[n.a] : latex_name(tape_->inputs()[n.a]);
    return raised(
        exponent != 1 && text.find('^') != std::string::npos ? fmt::format("\\left({}\\right)", text) : text);
  }
  if (!is_sum(id)) return function(n, exponent);
  if (is_alone && exponent == 1) return expression(id);
  return raised(fmt::format("\\left({}\\right)", expression(id)));
}

std::string Writer::product(const Product& p) {
  std::vector<std::pair<NodeId, int>> above;
  std::vector<std::pair<NodeId, int>> below;
  for (const auto& [node, exponent] : p.factors) {
    (exponent > 0 ? above : below).emplace_back(node, exponent > 0 ? exponent : -exponent);
  }
  std::map<NodeId, std::pair<NodeId, int>> tangents;  // by sine: the argument and the power
  for (auto& [s, m] : above) {                        // sin x / cos x
    if (tape_->node(s).op != Op::sin || is_named(s)) continue;
    for (auto& [c, k] : below) {
      if (tape_->node(c).op != Op::cos || is_named(c) || tape_->node(c).a != tape_->node(s).a) continue;
      const int power = std::min(m, k);
      tangents[s] = {tape_->node(s).a, power};
      m -= power;
      k -= power;
    }
  }
  const auto joined = [&](const std::vector<std::pair<NodeId, int>>& factors, bool with_tangents,
                          bool is_alone) {
    std::string text;
    for (const auto& [node, exponent] : factors) {
      if (exponent > 0)
        text += (text.empty() ? "" : " ") + factor(node, exponent, is_alone && factors.size() == 1);
      const auto tangent = tangents.find(node);
      if (!with_tangents || tangent == tangents.end()) continue;
      const auto [angle, power] = tangent->second;
      text += (text.empty() ? "" : " ") + function({Op::tan, angle, 0}, power);
    }
    return text;
  };
  std::erase_if(below, [](const auto& f) { return f.second == 0; });
  Exact over = p.constant;
  Exact under = 1;
  if (!below.empty() && p.constant.is_rational() &&
      !p.constant.is_integer()) {  // no fraction within a fraction
    const auto q = cln::the<cln::cl_RA>(p.constant.value());
    over = Exact(cln::cl_R(cln::numerator(q)));
    under = Exact(cln::cl_R(cln::denominator(q)));
  }
  const bool shows_over = !(over == Exact(1));
  std::string numerator = joined(above, true, !shows_over && !p.factors.empty() && !below.empty());
  if (numerator.empty()) {
    numerator = number(over);
  } else if (shows_over) {
    numerator = number(over) + " " + numerator;
  }
  if (below.empty()) return numerator;
  const bool shows_under = !(under == Exact(1));
  std::string denominator = joined(below, false, !shows_under);
  if (shows_under) denominator = number(under) + " " + denominator;
  return fmt::format("\\frac{{{}}}{{{}}}", numerator, denominator);
}

}  // namespace

LatexText latex_text(const Tape& tape, const std::vector<std::vector<NodeId>>& rows,
                     const LatexNames& names) {
  Tape scratch = tape;
  std::vector<std::vector<NodeId>> simplified = rows;
  std::vector<NodeId> roots;
  for (auto& row : simplified) {
    for (NodeId& id : row) {
      const auto form = closed_form(scratch, {id}, {names.nodes, names.terms});
      if (form) id = form->front();
      roots.push_back(id);
    }
  }
  Writer writer(scratch, names);
  writer.choose_names(roots);
  LatexText result;
  const bool is_scalar = rows.size() == 1 && rows.front().size() == 1;
  for (const auto& row : simplified) {
    std::string line;
    for (std::size_t j = 0; j < row.size(); ++j) line += (j == 0 ? "" : " & ") + writer.write(row[j]);
    result.formula += (result.formula.empty() ? "" : " \\\\ ") + line;
  }
  if (!is_scalar) result.formula = fmt::format("\\begin{{bmatrix}} {} \\end{{bmatrix}}", result.formula);
  result.definitions = writer.definitions();
  return result;
}

}  // namespace anholon
