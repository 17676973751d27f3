// SPDX-License-Identifier: GPL-2.0-or-later
#include "emit/header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "emit/embedded.hpp"
#include "emit/names.hpp"
#include "emit/plan.hpp"
#include "emit/provenance.hpp"
#include "emit/template.hpp"

namespace anholon {
namespace {

using nlohmann::json;

constexpr std::size_t line_width = 110;

std::string without_last_newline(std::string text) {
  if (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

template <class Block>
std::string shape(const Block& block) {
  return block.cols == 1 ? fmt::format("({})", block.rows) : fmt::format("({}x{})", block.rows, block.cols);
}

template <class Block>
std::string extent(const Block& block) {
  return block.cols == 1 || block.rows == 1 ? fmt::format("[{}]", block.rows * block.cols)
                                            : fmt::format("[{} * {}]", block.rows, block.cols);
}

std::string unit_and_meaning(const std::string& unit, const std::string& meaning) {
  return unit + (unit.empty() || meaning.empty() ? "" : ": ") + meaning;
}

/// A declared member with a comment behind it; the comment comes first where the line would be too long.
std::string member(const std::string& declaration, const std::string& remark) {
  const std::string text = one_line(remark);
  if (text.empty()) return "  " + declaration;
  const std::string line = fmt::format("  {}  // {}", declaration, text);
  return line.size() <= line_width ? line : comment(remark, "  // ") + "  " + declaration;
}

/// Arguments on one line, or one a line where they don't fit.
std::string argument_list(const std::vector<std::string>& arguments, std::size_t columns_before) {
  const std::string line = joined(arguments, ", ");
  if (columns_before + line.size() + 12 <= line_width) return line;
  return joined(arguments, ",\n" + std::string(columns_before, ' '));
}

/// What a hoisted value is, as far as it fits on a line: "m_1 * l * l".
std::string formula(const Program& program, const EmissionPlan& plan, NodeId id, int depth = 0) {
  const Node& n = program.tape.node(id);
  if (n.op == Op::constant) return program.tape.value(id).decimal(6);
  if (n.op == Op::input) {
    for (std::size_t i = 0; i < program.parameters.size(); ++i) {
      if (program.parameters[i].node == id) return plan.parameter_names[i];
    }
    return program.tape.inputs()[n.a];
  }
  if (depth > 0) {
    const auto found = std::find(plan.prepared_values.begin(), plan.prepared_values.end(), id);
    if (found != plan.prepared_values.end()) {
      return plan.prepared_names[static_cast<std::size_t>(found - plan.prepared_values.begin())];
    }
  }
  if (depth > 12) return std::string(line_width, '?');  // does not fit anyway
  const auto operand = [&](NodeId x, bool is_second) {
    const std::string text = formula(program, plan, x, depth + 1);
    const CostClass inner = info(program.tape.node(x).op).cost;
    const bool bare = text.find(' ') == std::string::npos && text.front() != '-';
    const bool call = info(n.op).cpp.back() == ')';
    const bool product = inner == CostClass::multiplication;
    if (bare || call || (product && n.op != Op::neg && !(n.op == Op::div && is_second))) return text;
    if (info(n.op).cost == CostClass::addition && text.front() != '-' && !(n.op == Op::sub && is_second))
      return text;
    return "(" + text + ")";
  };
  const std::string a = operand(n.a, false);
  const std::string b = info(n.op).arity == 2 ? operand(n.b, true) : "";
  if (a.size() + b.size() > line_width) return std::string(line_width, '?');
  return fmt::format(fmt::runtime(info(n.op).cpp), a, b);
}

class HeaderWriter {
 public:
  HeaderWriter(const Program& program, const StatementStyle& style)
      : program_(program), style_(style), plan_(plan_emission(program)) {}

  std::string write() {
    json data;
    data["version"] = std::string(generator_version());
    data["model"] = one_line(program_.model);
    data["scene"] = one_line(program_.scene.empty() ? "standard" : program_.scene);
    data["source_file"] = origin(base_name(program_.source_file));
    data["source_sha256"] = origin(program_.source_sha256);
    data["name_space"] = joined(plan_.name_space, "::");
    write_notes(data);
    write_operations(data);
    write_layout(data);
    write_sizes(data);
    write_parameters(data);
    write_prepare(data);
    data["functions"] = json::array();
    for (const PlannedFunction& function : plan_.functions)
      data["functions"].push_back(function_data(function));
    write_charts(data);
    data["uses_sign"] = uses([](Op op) { return op == Op::sign; });
    data["uses_rounding_errors"] = uses([](Op op) { return info(op).cost == CostClass::compensation; });
    data["uses_batch"] = uses_batch_;
    data["uses_loops"] = std::ranges::any_of(
        plan_.functions, [](const PlannedFunction& f) { return f.function->loops.has_value(); });
    data["rounding_errors"] = without_last_newline(std::string(embedded::rounding_errors));
    data["tree_loops"] = without_last_newline(std::string(embedded::tree_loops));
    data["sines_cosines"] = without_last_newline(std::string(embedded::sines_cosines));
    return fill_template(embedded::header_template, data);
  }

 private:
  void write_notes(json& data) const {
    std::string text;
    for (const std::string& note : program_.notes) text += comment(note, "//   ", 2);
    data["notes"] = text.empty() ? "//" : "//\n" + text + "//";
  }

  void write_operations(json& data) const {
    std::size_t width = std::string("prepare").size();
    for (const PlannedFunction& function : plan_.functions) width = std::max(width, function.name.size());
    std::string text;
    for (const PlannedFunction& function : plan_.functions) {
      text += fmt::format("//   {:<{}}  {}\n", function.name, width, function.operations.text());
    }
    text += fmt::format("//   {:<{}}  {}, once per set of parameters", "prepare", width,
                        plan_.prepare_operations.text());
    data["operations"] = text;
  }

  void write_layout(json& data) const {
    std::string text;
    for (std::size_t i = 0; i < program_.inputs.size(); ++i) {
      if (!is_read(i)) continue;
      const InputBlock& block = program_.inputs[i];
      text += comment(fmt::format("{} {} {}", plan_.input_names[i], shape(block),
                                  unit_and_meaning(block.unit, block.meaning)),
                      "//   ", 2);
    }
    data["layout"] = without_last_newline(text.empty() ? "//   none" : text);
  }

  /// inline constexpr int n_<block> for inputs, and for outputs that are of one size wherever they occur.
  void write_sizes(json& data) const {
    std::map<std::string, std::set<int>> sizes;
    std::vector<std::string> names;
    const auto note = [&](const std::string& name, int size) {
      if (!sizes.contains(name)) names.push_back(name);
      sizes[name].insert(size);
    };
    for (std::size_t i = 0; i < program_.inputs.size(); ++i) {
      if (is_read(i)) note(plan_.input_names[i], program_.inputs[i].rows * program_.inputs[i].cols);
    }
    for (const PlannedFunction& function : plan_.functions) {
      for (const PlannedOutput& output : function.outputs)
        note(output.name, output.block->rows * output.block->cols);
    }
    NameScope scope;
    for (const PlannedFunction& function : plan_.functions) scope.claim(function.name);
    data["sizes"] = json::array();
    for (const std::string& name : names) {
      if (sizes[name].size() != 1) continue;
      const std::string constant = scope.claim("n_" + name);
      data["sizes"].push_back(
          {{"text", fmt::format("inline constexpr int {} = {};", constant, *sizes[name].begin())}});
    }
  }

  void write_parameters(json& data) const {
    data["parameters"] = json::array();
    for (std::size_t i = 0; i < program_.parameters.size(); ++i) {
      const ParameterInfo& parameter = program_.parameters[i];
      const std::string declaration =
          fmt::format("Real {} = detail::{};", plan_.parameter_names[i], constant_text(parameter.value));
      data["parameters"].push_back(
          {{"text", member(declaration, unit_and_meaning(parameter.unit, parameter.meaning))}});
    }
    data["members"] = json::array();
    for (const std::size_t i : plan_.prepared_parameters) {
      data["members"].push_back({{"text", member("Real " + plan_.parameter_names[i] + ";", "")}});
    }
    for (std::size_t i = 0; i < plan_.prepared_values.size(); ++i) {
      std::string text = formula(program_, plan_, plan_.prepared_values[i]);
      if (text.size() > line_width - 20) text.clear();
      data["members"].push_back({{"text", member("Real " + plan_.prepared_names[i] + ";", text)}});
    }
  }

  Statements statements(const std::vector<Assignment>& results, const GivenValues& given,
                        const NameScope& names) {
    Statements s = write_statements(program_.tape, results, given, names, style_);
    uses_batch_ = uses_batch_ || s.uses_batch;
    return s;
  }

  void write_prepare(json& data) {
    GivenValues given;
    for (std::size_t i = 0; i < program_.parameters.size(); ++i) {
      given[program_.parameters[i].node] = {"par." + plan_.parameter_names[i], 0};
    }
    std::vector<Assignment> results;
    for (const std::size_t i : plan_.prepared_parameters) {
      results.push_back({"result." + plan_.parameter_names[i], program_.parameters[i].node});
    }
    for (std::size_t i = 0; i < plan_.prepared_values.size(); ++i) {
      results.push_back({"result." + plan_.prepared_names[i], plan_.prepared_values[i]});
    }
    NameScope names;
    names.claim("result");
    const std::string argument = "const Parameters<Real>& par";
    const Body body = body_of(statements(results, given, names), "prepare", {argument});
    data["prepare_operations"] = plan_.prepare_operations.text();
    data["prepare_argument"] = body.arguments.empty() ? "const Parameters<Real>&" : argument;
    data["prepare_body"] = body.text;
    data["prepare_blocks"] = json::array();
    std::string blocks;
    for (const json& block : body.blocks) {
      blocks +=
          fmt::format("template <class Real>\n[[gnu::noinline]] inline void {}({}) noexcept {{\n{}\n}}\n\n",
                      block["name"].get<std::string>(), block["arguments"].get<std::string>(),
                      block["body"].get<std::string>());
    }
    if (!blocks.empty())
      data["prepare_blocks"].push_back(
          {{"text", "namespace detail {\n\n" + blocks + "}  // namespace detail"}});
  }

  json function_data(const PlannedFunction& function) {
    std::vector<std::string> arguments = {"const Prepared<Real>& par"};
    GivenValues given;
    for (const std::size_t i : plan_.prepared_parameters) {
      given[program_.parameters[i].node] = {"par." + plan_.parameter_names[i], 0};
    }
    for (std::size_t i = 0; i < plan_.prepared_values.size(); ++i) {
      given[plan_.prepared_values[i]] = {"par." + plan_.prepared_names[i], 0};
    }
    NameScope names;
    for (const std::size_t i : function.inputs) {
      const InputBlock& block = program_.inputs[i];
      const std::string& name = plan_.input_names[i];
      names.claim(name);
      for (std::size_t j = 0; j < block.nodes.size(); ++j) {
        if (program_.tape.node(block.nodes[j]).op != Op::input) continue;
        given.try_emplace(block.nodes[j], GivenValue{fmt::format("{}[{}]", name, j), arguments.size()});
      }
      arguments.push_back(fmt::format("const Real (&{}){}", name, extent(block)));
    }
    std::vector<Assignment> results;
    for (const PlannedOutput& output : function.outputs) {
      names.claim(output.name);
      for (std::size_t j = 0; j < output.block->nodes.size(); ++j)
        results.push_back({output.name, output.block->nodes[j], j, arguments.size()});
      arguments.push_back(fmt::format("Real (&{}){}", output.name, extent(*output.block)));
    }
    const std::string doc = documentation(function);
    const Body body = function.function->loops
                          ? body_of_loops(function, arguments)
                          : body_of(statements(results, given, names), function.name, arguments);
    if (!body.arguments.contains(0)) arguments[0] = "const Prepared<Real>&";
    json data;
    data["name"] = function.unqualified;
    data["has_scope"] = !function.scope.empty();
    data["scope"] = function.scope;
    data["arguments"] =
        argument_list(arguments, std::string("inline void (").size() + function.unqualified.size());
    data["doc"] = without_last_newline(doc);
    data["body"] = body.text;
    data["has_blocks"] = !body.blocks.empty();
    data["blocks"] = body.blocks;
    return data;
  }

  /// Names of the first chart's functions in a namespace like those of the others.
  void write_charts(json& data) const {
    std::set<std::string> charts, shared;
    for (const PlannedFunction& function : plan_.functions) {
      if (function.scope.empty()) continue;
      charts.insert(function.scope);
      shared.insert(function.unqualified);
    }
    data["has_charts"] = !charts.empty();
    data["first_chart"] = json::array();
    for (const PlannedFunction& function : plan_.functions) {
      if (function.scope.empty() && shared.contains(function.name))
        data["first_chart"].push_back(
            {{"text", fmt::format("using {}::{};", joined(plan_.name_space, "::"), function.name)}});
    }
  }

  struct Body {
    std::string text;
    json blocks = json::array();
    std::set<std::size_t> arguments;
  };

  /// The text of a function, with the calls of its blocks where it is split.
  static Body body_of(const Statements& statements, const std::string& function,
                      const std::vector<std::string>& arguments) {
    Body body;
    body.arguments.insert(statements.arguments.begin(), statements.arguments.end());
    std::string calls;
    if (!statements.blocks.empty())
      calls = fmt::format("  Real {}[{}];\n", statements.carried,
                          std::max<std::size_t>(1, statements.carried_size));
    for (std::size_t i = 0; i < statements.blocks.size(); ++i) {
      const StatementBlock& block = statements.blocks[i];
      const std::string name = fmt::format("{}_block_{}", function, i + 1);
      std::vector<std::string> declared;
      std::vector<std::string> passed;
      for (const std::size_t a : block.arguments) {
        declared.push_back(arguments[a]);
        passed.push_back(argument_name(arguments[a]));
      }
      if (block.uses_carried) {
        declared.push_back(fmt::format("Real (&__restrict {})[{}]", statements.carried,
                                       std::max<std::size_t>(1, statements.carried_size)));
        passed.push_back(statements.carried);
      }
      calls += fmt::format("  detail::{}({});\n", name, joined(passed, ", "));
      body.blocks.push_back(
          {{"name", name},
           {"arguments",
            argument_list(declared, std::string("[[gnu::noinline]] inline void (").size() + name.size())},
           {"body", without_last_newline(block.text)}});
    }
    body.text = without_last_newline(calls + statements.text);
    return body;
  }

  /// The call of the function before the loops, and of the loops over its outputs.
  Body body_of_loops(const PlannedFunction& function, const std::vector<std::string>& arguments) const {
    const TreeLoops& loops = *function.function->loops;
    const PlannedFunction& first = *std::ranges::find(
        plan_.functions, loops.from, [](const PlannedFunction& f) { return f.function->name; });
    Body body;
    const auto table = [&](const std::string& name, const std::vector<int>& values) {
      body.text += comment(
          fmt::format("static constexpr int {}[{}] = {{{}}};", name, values.size(), fmt::join(values, ", ")),
          "  ", 4);
    };
    const auto call = [&](const std::string& name, const std::vector<std::string>& passed) {
      body.text += fmt::format("  {}({});\n", name, joined(passed, ", "));
    };
    std::vector<std::string> passed;
    for (std::size_t i = 0; i + function.outputs.size() < arguments.size(); ++i) {
      passed.push_back(argument_name(arguments[i]));
      body.arguments.insert(i);
    }
    const std::string n = std::to_string(loops.parent.size());
    const std::string& result = function.outputs[0].name;
    table("parent", loops.parent);
    if (loops.kind == TreeLoops::Kind::regressor) {
      table("row", loops.row);
      if (!loops.component.empty()) table("component", loops.component);
      for (const PlannedOutput& o : first.outputs) {
        body.text += fmt::format("  Real {}{};\n", o.name, extent(*o.block));
        passed.push_back(o.name);
      }
      call(first.name, passed);
      call("detail::regressor_rows",
           {n, "parent", "row", std::to_string(loops.component.size()),
            loops.component.empty() ? "nullptr" : "component", std::to_string(loops.rows),
            first.outputs[0].name, first.outputs[1].name, result});
    } else {
      const bool inverts = loops.kind == TreeLoops::Kind::inverse_mass_matrix;
      if (inverts) {
        table("end", loops.end);
        body.text += fmt::format("  Real D[{}];\n", n);
      }
      const std::string& D = inverts ? "D" : function.outputs[1].name;
      passed.push_back(result);
      call(first.name, passed);
      call("detail::factor_mass_matrix", {n, "parent", result, D});
      if (inverts) call("detail::invert_mass_factor", {n, "parent", "end", result, D});
    }
    body.text = without_last_newline(body.text);
    return body;
  }

  /// "const Real (&q)[2]" -> q, "const Prepared<Real>& par" -> par
  static std::string argument_name(const std::string& declaration) {
    const std::size_t begin = declaration.rfind('&') + 1;
    const std::size_t end = std::min(declaration.find(')', begin), declaration.size());
    const std::string name = declaration.substr(begin, end - begin);
    return name.front() == ' ' ? name.substr(1) : name;
  }

  std::string documentation(const PlannedFunction& function) const {
    std::string text = comment(
        function.function->meaning.empty() ? function.name + "." : function.function->meaning, "/// ");
    if (!function.function->remark.empty()) text += comment(function.function->remark, "/// ");
    text += comment("operations: " + function.operations.text(), "/// ");
    std::size_t width = 3;
    for (const std::size_t i : function.inputs) width = std::max(width, plan_.input_names[i].size());
    for (const PlannedOutput& output : function.outputs) width = std::max(width, output.name.size());
    const auto line = [&](const char* direction, const std::string& name, const std::string& rest) {
      const std::string head = fmt::format("/// @param{} {:<{}}  ", direction, name, width);
      // the head keeps its blanks; only what follows is wrapped
      const std::string body = comment(rest, "///     ", 4);
      text += head.size() + rest.size() <= line_width
                  ? head + one_line(rest) + "\n"
                  : fmt::format("/// @param{} {}\n", direction, name) + body;
    };
    line("[in] ", "par", "made by prepare()");
    for (const std::size_t i : function.inputs) {
      const InputBlock& block = program_.inputs[i];
      line("[in] ", plan_.input_names[i], shape(block) + " " + unit_and_meaning(block.unit, block.meaning));
    }
    for (const PlannedOutput& output : function.outputs) {
      line("[out]", output.name,
           shape(*output.block) + " " + unit_and_meaning(output.block->unit, output.block->meaning));
    }
    return text;
  }

  [[nodiscard]] bool is_read(std::size_t input) const {
    return std::any_of(plan_.functions.begin(), plan_.functions.end(), [&](const PlannedFunction& f) {
      return std::find(f.inputs.begin(), f.inputs.end(), input) != f.inputs.end();
    });
  }

  template <class Condition>
  [[nodiscard]] bool uses(const Condition& condition) const {
    std::vector<NodeId> roots;
    for (const PlannedFunction& function : plan_.functions) {
      if (function.function->loops) continue;
      for (const PlannedOutput& output : function.outputs) {
        roots.insert(roots.end(), output.block->nodes.begin(), output.block->nodes.end());
      }
    }
    const std::vector<NodeId> nodes = program_.tape.reachable(roots);
    return std::any_of(nodes.begin(), nodes.end(),
                       [&](NodeId id) { return condition(program_.tape.node(id).op); });
  }

  const Program& program_;
  const StatementStyle& style_;
  EmissionPlan plan_;
  bool uses_batch_ = false;  // in what is written so far
};

}  // namespace

std::string emit_header(const Program& program, const StatementStyle& style) {
  return HeaderWriter(program, style).write();
}

}  // namespace anholon
