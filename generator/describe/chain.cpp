// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <utility>

#include "describe/expression.hpp"
#include "describe/reading.hpp"
#include "describe/table_reader.hpp"
#include "describe/units.hpp"

namespace anholon {
namespace {

constexpr int most_segments = 200;

/// A factor of the expressions in the links, and where it was written.
struct Factor {
  Location where;
  std::string text;
};

Value text_at(const Location& where, std::string text) {
  Value value;
  value.kind = Value::Kind::string;
  value.where = where;
  value.text = std::move(text);
  return value;
}

Value list_at(const Location& where, const std::vector<std::string>& texts) {
  Value value;
  value.kind = Value::Kind::array;
  value.where = where;
  for (const std::string& text : texts) value.items.push_back(text_at(where, text));
  return value;
}

Value table_at(const Location& where, std::vector<std::pair<const char*, Value>> entries) {
  Value value;
  value.kind = Value::Kind::table;
  value.where = where;
  for (std::pair<const char*, Value>& entry : entries)
    value.entries.push_back({entry.first, entry.second.where, std::move(entry.second)});
  return value;
}

/// The parameters of a document that is yet to be read, to check expressions before they are copied into
/// links. What is wrong with the parameters themselves is said where they are read.
Scope parameters_of(const Value& document, Tape& tape) {
  Scope scope;
  const Value* parameters = document.find("parameters");
  for (const Entry& entry : parameters == nullptr ? std::vector<Entry>{} : parameters->entries) {
    Symbol symbol{SymbolKind::parameter, {Expr(tape, tape.input(entry.key)), std::nullopt}, "", ""};
    const Value* unit = entry.value.find("unit");
    try {
      if (unit != nullptr) symbol.quantity.unit = read_unit(unit->text);
    } catch (const UnitError&) {
      symbol.quantity.unit.reset();
    }
    scope.add(entry.key, std::move(symbol));
  }
  return scope;
}

/// Reads the keys of one chain.
class ChainReader {
 public:
  ChainReader(TableReader table, const Value& document)
      : table_(std::move(table)), scope_(parameters_of(document, tape_)) {}
  TableReader& table() { return table_; }

  /// A quantity of the chain as a factor of expressions, checked here once for all links.
  Factor factor(std::string_view key, std::string_view mend, const Dimension& unit) {
    const Value* value = table_.required(key, mend);
    if (value == nullptr) return {table_.table().where, "1"};
    const std::string what = fmt::format("the {} of {}", key, table_.what());
    const bool is_number = value->kind == Value::Kind::number;
    const std::string text = is_number ? decimal_text(*value) : value->text;
    if (text.empty() || (!is_number && value->kind != Value::Kind::string)) {
      table_.findings().error(value->where, fmt::format("{} is {}", what, value->kind_name()),
                              "write a decimal number, or an expression in quotes");
      return {value->where, "1"};
    }
    try {
      const Quantity quantity = read_expression(tape_, text, scope_, SymbolKind::parameter);
      if (quantity.unit && *quantity.unit != unit)
        table_.findings().error(
            value->where,
            fmt::format("{} has the unit {}, but needs {}", what, quantity.unit->text(), unit.text()),
            "check the expression and the units of its parameters");
    } catch (const ExpressionError& error) {
      table_.findings().error(value->at(error.offset), error.fact, error.mend);
    }
    return {value->where, "(" + text + ")"};
  }

 private:
  TableReader table_;
  Tape tape_;
  Scope scope_;
};

/// segments = 8, or "{N}" written out.
std::optional<int> read_segments(TableReader& chain) {
  const Value* value = chain.required("segments", "write how many: segments = 8");
  if (value == nullptr) return std::nullopt;
  int segments = 0;
  const char* end = value->text.data() + value->text.size();
  const bool is_text = value->kind == Value::Kind::number || value->kind == Value::Kind::string;
  const auto [stop, error] = std::from_chars(value->text.data(), end, segments);
  if (is_text && error == std::errc() && stop == end && segments >= 1 && segments <= most_segments)
    return segments;
  chain.findings().error(value->where, fmt::format("{} has no number of segments", chain.what()),
                         fmt::format("write a whole number from 1 to {}", most_segments));
  return std::nullopt;
}

/// A part of the uniform beam, 1/`parts` of its length, as a body.
Value link(const Location& where, const std::string& name, const std::string& parent, const Factor& L,
           const Factor& rhoA, int parts) {
  const long cube = 12L * parts * parts * parts;
  const Value moment = text_at(rhoA.where, fmt::format("{}*{}^3/{}", rhoA.text, L.text, cube));
  Value inertia =
      table_at(where, {{"mass", text_at(rhoA.where, fmt::format("{}*{}/{}", rhoA.text, L.text, parts))},
                       {"com", list_at(L.where, {fmt::format("{}/{}", L.text, 2 * parts), "0", "0"})},
                       {"about_com", table_at(rhoA.where, {{"yy", moment}, {"zz", moment}})}});
  return table_at(
      where,
      {{"name", text_at(where, name)}, {"parent", text_at(where, parent)}, {"inertia", std::move(inertia)}});
}

Value moved_by(const Factor& L, int parts) {
  return table_at(L.where,
                  {{"translation", list_at(L.where, {fmt::format("{}/{}", L.text, parts), "0", "0"})}});
}

void add(Value& table, const char* key, Value value) {
  const Location where = value.where;
  table.entries.push_back({key, where, std::move(value)});
}

/// The bodies that a chain stands for, in order.
std::vector<Value> links_of(const std::string& name, const Value& table, const Value& document,
                            Findings& findings) {
  ChainReader reader(TableReader(table, fmt::format("the chain of body '{}'", name), findings), document);
  TableReader& chain = reader.table();
  static const std::vector<std::string> planes = {"y", "z"};
  const std::size_t before = findings.size();
  const Factor L = reader.factor("length", "write it in m", units::m);
  const Factor rhoA = reader.factor("mass_per_length", "write it in kg/m", units::kg / units::m);
  const Factor EI = reader.factor("bending_stiffness", "write it in N m^2", units::newton_m * units::m);
  const std::optional<int> segments = read_segments(chain);
  const bool along_z = chain.optional_choice("plane", planes) == 1U;
  const std::string prefix = chain.optional_string("coordinate").value_or(name + "_q");
  const Value* range = chain.optional("range");
  std::optional<Factor> eta;
  if (chain.table().find("material_damping") != nullptr)
    eta = reader.factor("material_damping", "", units::s);
  chain.report_unknown_keys();
  if (findings.size() > before || !segments) return {};

  const int n = *segments;
  const Location& where = table.where;
  const auto fixed = [&] { return table_at(where, {{"kind", text_at(where, "fixed")}}); };
  std::vector<Value> links = {link(where, name + "_0", name, L, rhoA, 2 * n)};
  add(links.back(), "joint", fixed());
  const std::string spring = fmt::format("{}*{}/{}", EI.text, n, L.text);
  for (int i = 1; i <= n; ++i) {
    Value body = link(where, fmt::format("{}_{}", name, i), fmt::format("{}_{}", name, i - 1), L, rhoA,
                      i == n ? 2 * n : n);
    add(body, "pose", moved_by(L, i == 1 ? 2 * n : n));
    Value joint = table_at(
        where, {{"kind", text_at(where, "revolute")},
                {"axis", along_z ? list_at(where, {"0", "-1", "0"}) : list_at(where, {"0", "0", "1"})},
                {"coordinate", text_at(where, fmt::format("{}{}", prefix, i))},
                {"stiffness", text_at(EI.where, spring)}});
    if (eta) add(joint, "damping", text_at(eta->where, eta->text + "*" + spring));
    if (range != nullptr) add(joint, "range", *range);
    add(body, "joint", std::move(joint));
    links.push_back(std::move(body));
  }
  Value end = table_at(where, {{"name", text_at(where, name + "_end")},
                               {"parent", text_at(where, fmt::format("{}_{}", name, n))}});
  add(end, "pose", moved_by(L, 2 * n));
  add(end, "joint", fixed());
  links.push_back(std::move(end));
  return links;
}

}  // namespace

void write_out_chains(Value& document, Findings& findings) {
  const auto bodies = std::ranges::find_if(document.entries, [](const Entry& e) { return e.key == "body"; });
  if (bodies == document.entries.end() || bodies->value.kind != Value::Kind::array) return;
  std::set<std::string, std::less<>> chains;
  std::vector<Value> written;
  for (Value& body : bodies->value.items) {
    for (Entry& entry : body.entries) {  // what hangs on a chain hangs on its end
      if (entry.key == "parent" && entry.value.kind == Value::Kind::string &&
          chains.contains(entry.value.text))
        entry.value.text += "_end";
    }
    const Value* name = body.find("name");
    const Value* chain = body.find("chain");
    std::vector<Value> links;
    if (chain != nullptr && chain->kind == Value::Kind::table && name != nullptr &&
        name->kind == Value::Kind::string) {
      for (const char* other : {"beam", "modal"}) {
        if (const Value* second = body.find(other))
          findings.error(second->where, fmt::format("body '{}' has a chain and a {}", name->text, other),
                         "keep one");
      }
      links = links_of(name->text, *chain, document, findings);
      chains.insert(name->text);
      std::erase_if(body.entries, [](const Entry& e) { return e.key == "chain"; });
    }
    written.push_back(std::move(body));
    std::ranges::move(links, std::back_inserter(written));
  }
  bodies->value.items = std::move(written);
}

}  // namespace anholon
