// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/reading.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"

namespace anholon {

std::optional<Exact> DefaultValues::at(const Expr& x) {
  if (x.tape() == nullptr) {
    Tape literals;
    return literals.value(x.id(literals));
  }
  const NodeId id = x.id(*x.tape());
  while (values_.size() <= id) values_.push_back(computed(static_cast<NodeId>(values_.size())));
  return values_[id];
}

std::optional<Exact> DefaultValues::computed(NodeId id) const {
  static const Exact largest = Exact::from_decimal("1e1000");
  const Node& node = tape_.node(id);
  if (node.op == Op::constant) return tape_.value(id);
  if (node.op == Op::input) return inputs_.at(node.a);
  const std::optional<Exact>& a = values_[node.a];
  const std::optional<Exact>& b = info(node.op).arity == 2 ? values_[node.b] : a;
  if (!a || !b) return std::nullopt;
  try {
    const Exact value = apply(node.op, *a, *b);
    return abs(value) > largest ? std::nullopt : std::optional(value);
  } catch (const std::exception&) {  // domain errors, and overflow within CLN
    return std::nullopt;
  }
}

Expr Reading::number(const Value& value, std::string_view what, std::optional<Dimension> unit,
                     Allowed allowed) {
  std::string text = value.text;
  if (value.kind == Value::Kind::number) {
    text = decimal_text(value);
    if (text.empty()) {
      findings.error(value.where, fmt::format("{} is {}", what, value.text), "write a finite decimal number");
      return 0;
    }
  } else if (value.kind != Value::Kind::string) {
    findings.error(value.where, fmt::format("{} is {}", what, value.kind_name()),
                   "write a number, or an expression in quotes");
    return 0;
  }
  try {
    const Quantity quantity = read_expression(*model.tape, text, scope, allowed);
    if (unit && quantity.unit && *quantity.unit != *unit) {
      findings.error(
          value.where,
          fmt::format("{} has the unit {}, but needs {}", what, quantity.unit->text(), unit->text()),
          "check the expression and the units of its parameters");
      return 0;
    }
    return quantity.value;
  } catch (const ExpressionError& error) {
    findings.error(value.at(error.offset), error.fact, error.mend);
    return 0;
  }
}

std::array<Expr, 3> Reading::vector3(const Value& value, std::string_view what, std::optional<Dimension> unit,
                                     Allowed allowed) {
  if (value.kind != Value::Kind::array || value.items.size() != 3) {
    const std::string found = value.kind == Value::Kind::array
                                  ? fmt::format("an array of {}", value.items.size())
                                  : std::string(value.kind_name());
    findings.error(value.where, fmt::format("{} is {}", what, found), "write an array of three numbers");
    return {0, 0, 0};
  }
  std::array<Expr, 3> result = {0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) result[i] = number(value.items[i], what, unit, allowed);
  return result;
}

std::array<Expr, 3> Reading::direction(const Value& value, std::string_view what) {
  const std::size_t before = findings.size();
  const std::array<Expr, 3> v = vector3(value, what, std::nullopt);
  return findings.size() > before ? std::array<Expr, 3>{0, 0, 1} : normalised(v, value.where, what);
}

std::array<Expr, 3> Reading::normalised(const std::array<Expr, 3>& v, const Location& where,
                                        std::string_view what) {
  static const Exact rounding =
      Exact::from_decimal("1e-40");  // far above that of 128 digits, far below any decimal
  const Expr square = dot(v, v);
  const Exact value = at_defaults(square, where, what);
  if (value.is_zero()) {
    findings.error(where, fmt::format("{} is zero", what), "give it a direction");
    return {0, 0, 1};
  }
  if (abs(value - Exact(1)) < rounding) return v;
  model.notes.push_back(fmt::format("{} (line {}) was scaled to unit length", what, where.line));
  const Expr length = sqrt(Expr(*model.tape, square.id(*model.tape)));
  return {v[0] / length, v[1] / length, v[2] / length};
}

std::optional<std::array<Exact, 2>> Reading::range(const Value& value, std::string_view what,
                                                   Dimension unit) {
  if (value.kind != Value::Kind::array || value.items.size() != 2) {
    findings.error(value.where, fmt::format("{} is not an array of two numbers", what),
                   "write [lower, upper]");
    return std::nullopt;
  }
  const std::size_t before = findings.size();
  const Expr lower = number(value.items[0], what, unit);
  const Expr upper = number(value.items[1], what, unit);
  const std::array<Exact, 2> bounds = {at_defaults(lower, value.items[0].where, what),
                                       at_defaults(upper, value.items[1].where, what)};
  if (findings.size() > before) return std::nullopt;
  if (bounds[0] >= bounds[1]) {
    findings.error(value.where,
                   fmt::format("{} goes from {} to {}", what, bounds[0].decimal(8), bounds[1].decimal(8)),
                   "its lower end comes first");
    return std::nullopt;
  }
  return bounds;
}

Exact Reading::at_defaults(const Expr& x, const Location& where, std::string_view what) {
  if (const std::optional<Exact> value = defaults.at(x)) return *value;
  findings.error(where, fmt::format("{} is not a finite number at the parameters' values", what),
                 "check divisions, roots and the parameters");
  return 0;
}

std::string Reading::new_name(const Value& value, std::string_view what) {
  if (const std::string objection = objection_to_name(value.text); !objection.empty()) {
    findings.error(value.where, fmt::format("the name of {}, '{}', {}", what, value.text, objection),
                   "choose another");
    return "";
  }
  return value.text;
}

std::string decimal_text(const Value& value) {
  std::string text = value.text;
  std::erase(text, '_');
  const auto belongs = [](char c) {
    return (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.' || c == 'e' || c == 'E';
  };
  return std::all_of(text.begin(), text.end(), belongs) ? text : "";
}

std::optional<Exact> decimal_value(const Value& value) {
  static const Exact largest = Exact::from_decimal("1e300");
  constexpr std::size_t most_characters = 420;
  if (value.kind != Value::Kind::string && value.kind != Value::Kind::number) return std::nullopt;
  const std::string text = value.kind == Value::Kind::string ? value.text : decimal_text(value);
  if (text.size() > most_characters) return std::nullopt;
  try {
    const Exact number = Exact::from_decimal(text);
    return abs(number) > largest ? std::nullopt : std::optional(number);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

Expr dot(const std::array<Expr, 3>& a, const std::array<Expr, 3>& b) {
  const Expr x = a[0] * b[0];
  const Expr y = a[1] * b[1];
  const Expr z = a[2] * b[2];
  return x + y + z;
}

std::array<Expr, 3> cross(const std::array<Expr, 3>& a, const std::array<Expr, 3>& b) {
  const auto minor = [&](std::size_t i, std::size_t j) {
    const Expr x = a[i] * b[j];
    const Expr y = a[j] * b[i];
    return x - y;
  };
  const Expr x = minor(1, 2);
  const Expr y = minor(2, 0);
  const Expr z = minor(0, 1);
  return {x, y, z};
}

}  // namespace anholon
