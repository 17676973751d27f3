// SPDX-License-Identifier: GPL-2.0-or-later
#include "emit/c_abi.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "emit/embedded.hpp"
#include "emit/plan.hpp"
#include "emit/provenance.hpp"
#include "emit/statements.hpp"
#include "emit/template.hpp"

namespace anholon {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// The text as a C string literal; what is not printable ASCII goes as octal, which ends after three digits.
std::string c_literal(std::string_view text) {
  std::string literal = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') literal += '\\';
    if (byte >= 0x20 && byte < 0x7F) {
      literal += c;
    } else {
      literal += fmt::format("\\{:03o}", byte);
    }
  }
  return literal + "\"";
}

std::string double_literal(const Exact& value) {
  std::string text = fmt::format("{}", value.to_double());
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

template <class Block>
json block_data(const Block& block, std::size_t index, AbiScalar scalar) {
  return {{"array", scalar == AbiScalar::is_double ? "" : ".array()"},
          {"name", c_literal(block.name)},
          {"unit", c_literal(block.unit)},
          {"meaning", c_literal(block.meaning)},
          {"rows", block.rows},
          {"cols", block.cols},
          {"size", block.rows * block.cols},
          {"index", index}};
}

json function_data(const Program& program, const PlannedFunction& function, AbiScalar scalar) {
  json data = {{"name", function.name},
               {"qualified", (function.scope.empty() ? "" : function.scope + "::") + function.unqualified},
               {"quoted_name", c_literal(function.function->name)},
               {"quoted_meaning", c_literal(function.function->meaning)},
               {"has_inputs", !function.inputs.empty()},
               {"input_count", function.inputs.size()},
               {"input_table", function.inputs.empty() ? "nullptr" : function.name + "_inputs"},
               {"input_argument", function.inputs.empty() ? "/*inputs*/" : "inputs"},
               {"output_count", function.outputs.size()},
               {"inputs", json::array()},
               {"outputs", json::array()}};
  for (std::size_t i = 0; i < function.inputs.size(); ++i) {
    data["inputs"].push_back(block_data(program.inputs[function.inputs[i]], i, scalar));
  }
  for (std::size_t i = 0; i < function.outputs.size(); ++i) {
    data["outputs"].push_back(block_data(*function.outputs[i].block, i, scalar));
  }
  return data;
}

template <class Block>
ordered_json described(const Block& block) {
  return {{"name", block.name},
          {"unit", block.unit},
          {"meaning", block.meaning},
          {"rows", block.rows},
          {"cols", block.cols}};
}

ordered_json described(const OperationCount& count) {
  return {{"additions", count.additions}, {"multiplications", count.multiplications},
          {"divisions", count.divisions}, {"negations", count.negations},
          {"roots", count.roots},         {"sines", count.sines},
          {"cosines", count.cosines},     {"other", count.other},
          {"total", count.total()}};
}

}  // namespace

std::string emit_c_abi(const Program& program, std::string_view header, AbiScalar scalar) {
  const bool converts = scalar != AbiScalar::is_double;
  const EmissionPlan plan = plan_emission(program);
  json data = {{"version", std::string(generator_version())},
               {"real", converts ? "float" : "double"},
               {"converts", converts},
               {"header", one_line(header)},
               {"model", one_line(program.model)},
               {"source_file", origin(base_name(program.source_file))},
               {"source_sha256", origin(program.source_sha256)},
               {"name_space", fmt::format("{}", fmt::join(plan.name_space, "::"))},
               {"quoted_name_space", c_literal(program.name_space)},
               {"quoted_model", c_literal(program.model)},
               {"quoted_scene", c_literal(program.scene)},
               {"quoted_sha256", c_literal(program.source_sha256)},
               {"has_parameters", !program.parameters.empty()},
               {"parameter_count", program.parameters.size()},
               {"parameter_table", program.parameters.empty() ? "nullptr" : "parameters"},
               {"has_functions", !plan.functions.empty()},
               {"function_count", plan.functions.size()},
               {"function_table", plan.functions.empty() ? "nullptr" : "functions"},
               {"parameters", json::array()},
               {"functions", json::array()}};
  for (std::size_t i = 0; i < program.parameters.size(); ++i) {
    const ParameterInfo& parameter = program.parameters[i];
    data["parameters"].push_back({{"name", c_literal(parameter.name)},
                                  {"unit", c_literal(parameter.unit)},
                                  {"meaning", c_literal(parameter.meaning)},
                                  {"value", double_literal(parameter.value)},
                                  {"member", plan.parameter_names[i]},
                                  {"cast", converts ? "static_cast<float>(" : ""},
                                  {"end_of_cast", converts ? ")" : ""},
                                  {"index", i}});
  }
  for (const PlannedFunction& function : plan.functions)
    data["functions"].push_back(function_data(program, function, scalar));
  return fill_template(embedded::c_abi_template, data);
}

std::string describe_json(const Program& program) {
  const EmissionPlan plan = plan_emission(program);
  ordered_json data = {
      {"schema", "anholon.program/1"},
      {"generator", std::string(generator_version())},
      {"name_space", program.name_space},
      {"model", program.model},
      {"scene", program.scene},
      {"source", {{"file", base_name(program.source_file)}, {"sha256", program.source_sha256}}},
      {"notes", program.notes},
      {"parameters", ordered_json::array()},
      {"inputs", ordered_json::array()},
      {"prepare", {{"operations", described(plan.prepare_operations)}}},
      {"functions", ordered_json::array()}};
  for (const ParameterInfo& parameter : program.parameters) {
    data["parameters"].push_back({{"name", parameter.name},
                                  {"unit", parameter.unit},
                                  {"meaning", parameter.meaning},
                                  {"value", parameter.value.to_double()},
                                  {"digits", parameter.value.decimal(30)}});
  }
  for (const InputBlock& input : program.inputs) data["inputs"].push_back(described(input));
  for (const PlannedFunction& function : plan.functions) {
    ordered_json entry = {{"name", function.function->name},
                          {"meaning", function.function->meaning},
                          {"remark", function.function->remark},
                          {"inputs", ordered_json::array()},
                          {"outputs", ordered_json::array()},
                          {"operations", described(function.operations)},
                          {"operations_without_prepare", described(function.unprepared)}};
    for (const std::size_t i : function.inputs) entry["inputs"].push_back(program.inputs[i].name);
    for (const PlannedOutput& output : function.outputs) entry["outputs"].push_back(described(*output.block));
    data["functions"].push_back(std::move(entry));
  }
  return data.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace anholon
