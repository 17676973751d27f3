// SPDX-License-Identifier: GPL-2.0-or-later
#include "report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "emit/embedded.hpp"
#include "emit/template.hpp"
#include "report/plot.hpp"

namespace anholon {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

double number(const ordered_json& value) { return value.is_number() ? value.get<double>() : nan; }

std::string shown(double x, const char* format = "{:.3g}") {
  return std::isnan(x) ? "–" : fmt::format(fmt::runtime(format), x);
}

const ordered_json* function_of(const ordered_json& model, const std::string& name) {
  for (const ordered_json& f : model.at("functions")) {
    if (f.at("function") == name) return &f;
  }
  return nullptr;
}

/// The output of a function whose worst error is largest; null where none was compared.
const ordered_json* worst_output(const ordered_json& function) {
  const ordered_json* worst = nullptr;
  for (const ordered_json& e : function.at("errors")) {
    if (worst == nullptr || number(e.at("worst_ulps")) > number(worst->at("worst_ulps"))) worst = &e;
  }
  return worst;
}

double worst_ulps(const ordered_json& function) {
  const ordered_json* const worst = worst_output(function);
  return worst == nullptr ? nan : number(worst->at("worst_ulps"));
}

json function_row(const ordered_json& f) {
  int dearest = 0;
  for (const ordered_json& route : f.at("routes"))
    dearest = std::max(dearest, route.at("operations").get<int>());
  const int operations = f.at("operations").at("total").get<int>();
  const ordered_json* const error = worst_output(f);
  const auto of_error = [&](const char* key) {
    return error == nullptr ? "–" : shown(number(error->at(key)), "{:.2f}");
  };
  return {{"function", escaped(f.at("function").get<std::string>())},
          {"operations", operations},
          {"unprepared", f.at("operations_without_prepare").get<int>()},
          {"dearest", dearest > operations ? std::to_string(dearest) : ""},
          {"sines", f.at("operations").at("sines_and_cosines").get<int>()},
          {"ns", shown(number(f.at("ns_double").at("median")))},
          {"spread", shown(number(f.at("ns_double").at("spread")), "{:.2g}")},
          {"ns_float", shown(number(f.at("ns_float").at("median")))},
          {"ns_batch", shown(number(f.at("ns_double_batch_sines").at("median")))},
          {"median", of_error("median_ulps")},
          {"p99", of_error("p99_ulps")},
          {"worst", of_error("worst_ulps")},
          {"bad", error != nullptr && !error->at("passed").get<bool>()},
          {"output", error == nullptr ? "" : escaped(error->at("output").get<std::string>())}};
}

std::string sizes_text(const ordered_json& sizes) {
  const auto of = [&](const char* key) { return sizes.at(key).get<int>(); };
  if (!sizes.contains("n")) return fmt::format("{} bodies, {} coordinates", of("bodies"), of("coordinates"));
  return fmt::format(
      "{} bodies; n = {}, s_p = {}, s_a = {}; {} rows, m = {}, m° = {}; {} reduced velocities{}",
      of("bodies"), of("n"), of("s_p"), of("s_a"), of("rows"), of("m"), of("m_locked"),
      of("reduced_velocities"), of("charts") > 1 ? fmt::format(", {} charts", of("charts")) : "");
}

const ordered_json& points_of(const ordered_json& motion) { return motion.at("ladder").at("points"); }

Series series_of(const ordered_json& motion, const std::string& code, const char* abscissa) {
  Series series{code, {}};
  for (const ordered_json& p : points_of(motion)) {
    if (p.at("code") == code) series.points.emplace_back(number(p.at(abscissa)), number(p.at("error")));
  }
  return series;
}

std::vector<std::string> codes_of(const ordered_json& motion) {
  std::vector<std::string> codes;
  for (const ordered_json& p : points_of(motion)) {
    const auto code = p.at("code").get<std::string>();
    if (std::ranges::find(codes, code) == codes.end()) codes.push_back(code);
  }
  return codes;
}

std::string rung_text(const ordered_json& point) {
  const char* const rung = point.contains("step") ? "step" : "tolerance";
  return fmt::format("{} {:.0e}", rung, number(point.at(rung)));
}

json motion_data(const ordered_json& motion) {
  const auto scene = motion.at("scene").get<std::string>();
  if (motion.contains("left_out"))
    return {{"plots", ""},
            {"note", escaped(fmt::format("{}: no ladder of tolerances; {}", scene,
                                         motion.at("left_out").get<std::string>()))}};
  LogPlot time{scene, "CPU time [s]", "error of the final state", {}};
  LogPlot work{scene, "evaluations of the dynamics", "error of the final state", {}};
  std::vector<std::string> failed;
  for (const std::string& code : codes_of(motion)) {
    time.series.push_back(series_of(motion, code, "cpu_seconds"));
    work.series.push_back(series_of(motion, code, "evaluations"));
  }
  for (const ordered_json& p : points_of(motion)) {
    if (p.at("status") != "ok")
      failed.push_back(fmt::format("{} at {}: {}", p.at("code").get<std::string>(), rung_text(p),
                                   p.at("status").get<std::string>()));
  }
  std::string note = fmt::format("{}: reference {}, {} steps; half as many move it by {:.1e}.", scene,
                                 motion.at("ladder").at("reference").at("method").get<std::string>(),
                                 motion.at("ladder").at("reference").at("steps").get<long>(),
                                 number(motion.at("ladder").at("reference").at("own_error")));
  for (const std::string& text : failed) note += " " + text + ".";
  return {{"plots", draw(time) + "\n" + draw(work)}, {"note", escaped(note)}};
}

/// Times of single evaluations where the ladder is tightest; the field of the one over that of the other.
double evaluation_ratio(const ordered_json& motion) {
  const auto cost = [&](const std::string& code) {
    double least = nan;
    for (const ordered_json& p : points_of(motion)) {
      if (p.at("code") != code || p.at("status") != "ok") continue;
      const double x = number(p.at("cpu_seconds")) / number(p.at("evaluations"));
      if (!(x >= least)) least = x;
    }
    return least;
  };
  return cost("recursion") / cost("generated");
}

/// What a row of routes, passes or modes says of operations and ulps.
json measured_row(const ordered_json& row, const char* name) {
  const auto of = [&](const char* key) { return row.contains(key) ? shown(number(row.at(key))) : "–"; };
  return {{"name", escaped(row.at(name).get<std::string>())},
          {"operations", row.at("operations").get<int>()},
          {"median", of("median_ulps")},
          {"worst", of("worst_ulps")}};
}

/// The passes that change operations or errors, the function's name with the first.
json pass_rows(const ordered_json& f) {
  json rows = json::array();
  const auto is_same = [](const json& a, const json& b) {
    return a["operations"] == b["operations"] && a["median"] == b["median"] && a["worst"] == b["worst"];
  };
  for (const ordered_json& pass : f.at("passes")) {
    json row = measured_row(pass, "after");
    row["function"] = rows.empty() ? escaped(f.at("function").get<std::string>()) : "";
    if (rows.empty() || !is_same(rows.back(), row)) rows.push_back(std::move(row));
  }
  return rows.size() > 1 ? rows : json::array();
}

/// Operations against digits of every function, one series for each aim of the optimiser.
LogPlot pareto(const ordered_json& model) {
  LogPlot plot{
      "operations against digits, every function", "operations", "worst rounding error [ulps]", {}, false};
  for (const ordered_json& f : model.at("functions")) {
    for (const ordered_json& m : f.at("modes")) {
      const auto mode = m.at("mode").get<std::string>();
      const auto found = std::ranges::find(plot.series, mode, &Series::name);
      Series& series = found == plot.series.end() ? plot.series.emplace_back(Series{mode, {}}) : *found;
      if (m.contains("worst_ulps"))
        series.points.emplace_back(m.at("operations").get<int>(), number(m.at("worst_ulps")));
    }
  }
  return plot;
}

json model_data(const ordered_json& model, const ordered_json& motions) {
  const auto name = model.at("model").get<std::string>();
  const ordered_json* const forward = function_of(model, "forward_dynamics");
  double worst = 0;
  json functions = json::array(), modes = json::array(), passes = json::array();
  for (const ordered_json& f : model.at("functions")) {
    const double ulps = worst_ulps(f);
    if (ulps > worst) worst = ulps;
    functions.push_back(function_row(f));
    json row = {{"function", functions.back()["function"]}, {"cells", json::array()}};
    for (const ordered_json& m : f.at("modes")) row["cells"].push_back(measured_row(m, "mode"));
    if (!row["cells"].empty()) modes.push_back(std::move(row));
    for (json& pass : pass_rows(f)) passes.push_back(std::move(pass));
  }
  json plotted = json::array();
  for (const ordered_json& motion : motions) {
    if (motion.at("model") == name) plotted.push_back(motion_data(motion));
  }
  const ordered_json& v = model.at("verification");
  return {{"name", name},
          {"title", escaped(model.at("title").get<std::string>())},
          {"class", escaped(model.at("table_I").get<std::string>())},
          {"sizes", sizes_text(model.at("sizes"))},
          {"forward_operations",
           forward == nullptr ? "–" : fmt::format("{}", forward->at("operations").at("total").get<int>())},
          {"forward_ns", forward == nullptr ? "–" : shown(number(forward->at("ns_double").at("median")))},
          {"forward_ulps", forward == nullptr ? "–" : shown(worst_ulps(*forward), "{:.1f}")},
          {"worst_ulps", shown(worst, "{:.1f}")},
          {"generation", shown(number(model.at("generation_s")), "{:.2f}")},
          {"compile", shown(number(model.at("compile_s")), "{:.2f}")},
          {"header", model.at("header_bytes").get<long>()},
          {"object", model.at("object_bytes").get<long>()},
          {"formulas", shown(number(v.at("formulas_worst")), "{:.1e}")},
          {"balance", shown(number(v.at("energy_balance")), "{:.1e}")},
          {"samples", v.at("samples").get<int>()},
          {"failed", !v.at("passed").get<bool>()},
          {"functions", functions},
          {"has_modes", !modes.empty()},
          {"mode_names", modes.empty() ? json::array() : modes[0]["cells"]},
          {"modes", modes},
          {"pareto_plot", modes.empty() ? "" : draw(pareto(model))},
          {"has_passes", !passes.empty()},
          {"passes", passes},
          {"has_motions", !plotted.empty()},
          {"motions", plotted}};
}

/// Speed against error of every function, one series for each kind that most users call, one for the rest.
LogPlot overview(const ordered_json& report) {
  LogPlot plot{"every function of every model", "time of one call [ns]", "worst error [ulps]", {}, false};
  plot.series = {{"forward_dynamics", {}}, {"inverse_torques", {}}, {"inverse_dynamics", {}}, {"others", {}}};
  for (const ordered_json& model : report.at("models")) {
    for (const ordered_json& f : model.at("functions")) {
      const auto of_name = [&](const Series& s) { return f.at("function") == s.name; };
      const auto found = std::ranges::find_if(plot.series, of_name);
      Series& series = found == plot.series.end() ? plot.series.back() : *found;
      series.points.emplace_back(number(f.at("ns_double").at("median")), worst_ulps(f));
    }
  }
  return plot;
}

}  // namespace

double cpu_seconds_at(const ordered_json& motion, const std::string& code, double error) {
  double previous_error = nan, previous_time = nan;
  for (const ordered_json& p : points_of(motion)) {  // from loose to tight
    if (p.at("code") != code || p.at("status") != "ok") continue;
    const double e = number(p.at("error")), t = number(p.at("cpu_seconds"));
    if (e <= error) {
      if (std::isnan(previous_error) || previous_error <= error) return t;
      const double part = std::log(error / previous_error) / std::log(e / previous_error);
      return previous_time * std::pow(t / previous_time, part);
    }
    previous_error = e, previous_time = t;
  }
  return nan;
}

std::string report_page(const ordered_json& report) {
  json models = json::array(), ratios = json::array();
  for (const ordered_json& model : report.at("models"))
    models.push_back(model_data(model, report.at("motions")));
  for (const ordered_json& motion : report.at("motions")) {
    if (motion.contains("left_out")) continue;
    const auto at = [&](double error) {
      return shown(cpu_seconds_at(motion, "recursion", error) / cpu_seconds_at(motion, "generated", error),
                   "{:.1f}");
    };
    const auto model = motion.at("model").get<std::string>();
    ratios.push_back(
        {{"name", model},
         {"motion", escaped(fmt::format("{}, {}", model, motion.at("scene").get<std::string>()))},
         {"at_6", at(1e-6)},
         {"at_9", at(1e-9)},
         {"evaluation", shown(evaluation_ratio(motion), "{:.1f}")}});
  }
  const ordered_json& machine = report.at("machine");
  std::string flags;
  for (const ordered_json& flag : machine.at("flags"))
    flags += (flags.empty() ? "" : " ") + flag.get<std::string>();
  return fill_template(embedded::report_template,
                       {{"model_count", models.size()},
                        {"motion_count", report.at("motions").size()},
                        {"processor", escaped(machine.at("processor").get<std::string>())},
                        {"compiler", escaped(machine.at("compiler").get<std::string>())},
                        {"version", escaped(machine.at("anholon").get<std::string>())},
                        {"flags", escaped(flags)},
                        {"states", report.at("states").get<int>()},
                        {"overview_plot", draw(overview(report))},
                        {"has_ratios", !ratios.empty()},
                        {"ratios", ratios},
                        {"models", models}});
}

}  // namespace anholon
