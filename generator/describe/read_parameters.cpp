// SPDX-License-Identifier: GPL-2.0-or-later
// Parameters: [parameters.x] { value, unit, meaning }.
#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/outline.hpp"

namespace anholon {
std::vector<std::string> reserved_names() {
  std::vector<std::string> names = expression_words();
  names.emplace_back("t");
  for (const std::string_view component : twist_component_names) names.emplace_back(component);
  for (const char row : {'X', 'Y', 'Z'}) {
    for (const char column : {'X', 'Y', 'Z'}) names.push_back(fmt::format("R_{}{}", row, column));
    names.push_back(fmt::format("p_{}", row));
  }
  return names;
}

void read_parameters(TableReader& root, Reading& reading) {
  const Value* tables = root.optional("parameters", Value::Kind::table);
  if (tables == nullptr) return;
  const std::vector<std::string> reserved = reserved_names();
  for (const Entry& entry : tables->entries) {
    const std::string what = fmt::format("parameter '{}'", entry.key);
    Parameter parameter;
    parameter.name = entry.key;
    parameter.where = entry.where;
    std::string objection = objection_to_name(entry.key);
    if (objection.empty() && std::find(reserved.begin(), reserved.end(), entry.key) != reserved.end())
      objection = "has a meaning of its own in expressions";
    if (!objection.empty()) {
      reading.findings.error(entry.where, fmt::format("the parameter name '{}' {}", entry.key, objection),
                             "choose another");
    }
    if (entry.value.kind != Value::Kind::table) {
      reading.findings.error(entry.value.where, fmt::format("{} is {}", what, entry.value.kind_name()),
                             "write { value = ..., unit = \"...\", meaning = \"...\" }");
      continue;
    }
    TableReader table(entry.value, what, reading.findings);
    if (const Value* value = table.required("value", "give it a value")) {
      if (value->kind == Value::Kind::string || value->kind == Value::Kind::number) {
        if (const auto number = decimal_value(*value)) {
          parameter.value = *number;
        } else {
          reading.findings.error(
              value->where, fmt::format("the value of {} is not a decimal number", what),
              "write for example 0.25 or 1e-3; formulas belong where the parameter is used");
        }
      } else {
        reading.findings.error(value->where, fmt::format("the value of {} is {}", what, value->kind_name()),
                               "write a decimal number");
      }
    }
    if (const Value* unit = table.required("unit", Value::Kind::string, "write \"1\" for a plain number")) {
      parameter.unit = unit->text;
      try {
        read_unit(unit->text);
      } catch (const UnitError& error) {
        reading.findings.error(unit->at(error.offset), error.fact, error.mend);
      }
    }
    parameter.meaning = table.optional_string("meaning").value_or("");
    table.report_unknown_keys();
    reading.model.parameters.push_back(std::move(parameter));
  }
}

}  // namespace anholon
