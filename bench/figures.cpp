// SPDX-License-Identifier: GPL-2.0-or-later
#include "figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "report/page.hpp"

namespace anholon::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double ulp = 0x1p-52;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(fmt::format("cannot read '{}'", file.string()));
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

double number(const ordered_json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

/// The element of a list whose members have these values.
const ordered_json& find(const ordered_json& list, const char* key, const std::string& value,
                         const char* other_key = nullptr, const std::string& other_value = "") {
  for (const ordered_json& item : list) {
    if (item.at(key) == value && (other_key == nullptr || item.at(other_key) == other_value)) return item;
  }
  throw std::runtime_error(fmt::format("no record of {} {}", value, other_value));
}

/// "7.9e-3": an exponent without its zero.
std::string power(double x, int digits = 1) {
  if (std::isnan(x)) return "";
  std::string text = fmt::format("{:.{}e}", x, digits);
  if (x == 0) return "0";
  const std::size_t at = text.find('e') + 2;
  if (text[at] == '0') text.erase(at, 1);
  if (text[at - 1] == '+') text.erase(at - 1, 1);
  return text;
}

std::string seconds(double s) {
  if (s < 0.1e-3) return fmt::format("{:.2g} us", 1e6 * s);
  if (s < 0.1) return fmt::format("{:.2g} ms", 1e3 * s);
  if (s < 100) return fmt::format("{:.2g} s", s);
  return fmt::format("{:.0f} s", s);
}

std::string ratio(double x) {
  if (std::isnan(x)) return "not reached";
  return x < 10 ? fmt::format("{:.1f}", x) : fmt::format("{:.0f}", x);
}

/// A table of Markdown.
class Table {
 public:
  explicit Table(const std::vector<std::string>& head) {
    add(head);
    add(std::vector<std::string>(head.size(), "---"));
  }
  void add(const std::vector<std::string>& cells) {
    text_ += "|";
    for (const std::string& cell : cells) text_ += cell.empty() ? " |" : " " + cell + " |";
    text_ += "\n";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

double worst_of(const ordered_json& function) {
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (const ordered_json& e : function.at("errors")) {
    const double ulps = number(e.at("worst_ulps"));
    if (!(ulps <= worst)) worst = ulps;
  }
  return ulp * worst;
}

double worst_of(const ordered_json& model, const std::string& function) {
  for (const ordered_json& f : model.at("functions")) {
    if (f.at("function") == function) return worst_of(f);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::string operations_of(const ordered_json& model, const std::string& function) {
  return std::to_string(
      find(model.at("functions"), "function", function).at("operations").at("total").get<int>());
}

const ordered_json& motion_of(const ordered_json& report, const std::string& model,
                              const std::string& scene) {
  return find(report.at("motions"), "model", model, "scene", scene);
}

std::string tolerance_of(const ordered_json& run) {
  const auto text = run.at("integrator").get<std::string>();
  const std::string before = "tolerance ";
  const std::size_t at = text.find(before);
  return at == std::string::npos ? text : power(std::stod(text.substr(at + before.size())), 0);
}

std::string verification(const ordered_json& report) {
  Table table({"model", "`forward_dynamics`, worst", "`inverse_torques`, worst", "`multipliers`, worst",
               "program against recursion, both exact", "energy balance"});
  for (const char* name : {"mobile_pendulum", "bicycle", "rigid_snakeboard", "soft_snakeboard", "trailer",
                           "double_pendulum", "free_chain", "wheeled_snake3", "wheeled_snake5"}) {
    const ordered_json& model = find(report.at("models"), "model", name);
    const ordered_json& v = model.at("verification");
    table.add({fmt::format("`{}`", name), power(worst_of(model, "forward_dynamics")),
               power(worst_of(model, "inverse_torques")), power(worst_of(model, "multipliers")),
               power(number(v.at("formulas_worst"))), power(number(v.at("energy_balance")))});
  }
  return table.text();
}

std::string worst_outputs(const ordered_json& report) {
  Table table({"model", "function", "output", "worst error, ulps", "measured condition"});
  for (const ordered_json& model : report.at("models")) {
    const ordered_json *worst = nullptr, *function = nullptr;
    for (const ordered_json& f : model.at("functions")) {
      for (const ordered_json& e : f.at("errors")) {
        if (worst == nullptr || number(e.at("worst_ulps")) > number(worst->at("worst_ulps")))
          worst = &e, function = &f;
      }
    }
    if (worst == nullptr) continue;
    table.add({fmt::format("`{}`", model.at("model").get<std::string>()),
               fmt::format("`{}`", function->at("function").get<std::string>()),
               fmt::format("`{}`", worst->at("output").get<std::string>()),
               fmt::format("{:.1f}", number(worst->at("worst_ulps"))),
               worst->contains("condition") ? fmt::format("{:.2g}", number(worst->at("condition"))) : ""});
  }
  return table.text();
}

std::string robots(const ordered_json& report) {
  Table table({"robot", "velocities", "`inverse_dynamics`", "`mass_matrix`", "`forward_dynamics`",
               fmt::format("worst error, {} states", report.at("samples").get<int>())});
  for (const char* name : {"arm7", "quadruped", "humanoid"}) {
    const ordered_json& model = find(report.at("models"), "model", name);
    double worst = 0;
    for (const ordered_json& f : model.at("functions")) worst = std::max(worst, worst_of(f));
    const int base = std::string_view(name) == "arm7" ? 0 : 6;
    table.add({fmt::format("`{}`", name),
               std::to_string(base + model.at("sizes").at("coordinates").get<int>()),
               operations_of(model, "inverse_dynamics"), operations_of(model, "mass_matrix"),
               operations_of(model, "forward_dynamics"), power(worst)});
  }
  return table.text();
}

std::string scenes(const ordered_json& report) {
  Table table({"scene", "operations", "sines and cosines"});
  for (const auto& [scene, what] :
       {std::pair{"gait", "everything"}, std::pair{"fixed_rotor", "shaft locked, parameters frozen"},
        std::pair{"rigid_beams", "no modes"}}) {
    const ordered_json& count =
        motion_of(report, "soft_snakeboard", scene).at("operations").at("forward_dynamics");
    table.add({fmt::format("`{}.scene.toml`: {}", scene, what), count.at("total").dump(),
               count.at("sines_and_cosines").dump()});
  }
  return table.text();
}

std::string motions(const ordered_json& report) {
  Table table({"scene", "tolerance", "energy balance, of the largest energy", "constraint residual",
               "one evaluation"});
  for (const auto& [model, scene] :
       {std::pair{"bicycle", "weave"}, std::pair{"mobile_pendulum", "swing"},
        std::pair{"rigid_snakeboard", "gait"}, std::pair{"soft_snakeboard", "gait"},
        std::pair{"trailer", "stir"}, std::pair{"wheeled_snake3", "serpent"}}) {
    const ordered_json& run = motion_of(report, model, scene).at("run");
    table.add({fmt::format("`models/{}/{}.scene.toml`", model, scene), tolerance_of(run),
               power(number(run.at("energy_balance"))), power(number(run.at("constraint_residual"))),
               fmt::format("{:.0f} ns", number(run.at("nanoseconds_per_evaluation")))});
  }
  return table.text();
}

std::string position_motions(const ordered_json& report) {
  Table table({"scene", "tolerance", "energy balance", "position residual", "one evaluation"});
  for (const auto& [model, scene] :
       {std::pair{"whipple_bicycle", "perturbed"}, std::pair{"rolling_disc", "wobble"},
        std::pair{"ball_on_incline", "roll"}, std::pair{"rattleback", "reversal"}}) {
    const ordered_json& motion = motion_of(report, model, scene);
    const ordered_json& run = motion.at("run");
    table.add(
        {fmt::format("`models/{}/{}.scene.toml` ({:g} s)", model, scene, number(motion.at("duration_s"))),
         tolerance_of(run), power(number(run.at("energy_balance"))),
         power(number(run.at("position_residual_m"))) + " m",
         fmt::format("{:.0f} ns", number(run.at("nanoseconds_per_evaluation")))});
  }
  return table.text();
}

/// The point of a code at a tolerance; null where the ladder has none.
const ordered_json* point_of(const ordered_json& motion, const std::string& code, double tolerance) {
  for (const ordered_json& p : motion.at("ladder").at("points")) {
    if (p.at("code") == code && std::abs(number(p.at("tolerance")) / tolerance - 1) < 1e-9) return &p;
  }
  return nullptr;
}

std::string work_precision(const ordered_json& report) {
  const ordered_json& motion = motion_of(report, "soft_snakeboard", "gait");
  Table table({"tolerance", "error, generated", "in float", "recursion", "CPU, generated", "in float",
               "recursion", "evaluations"});
  for (const int k : {-3, -6, -9, -12, -15, -16, -17}) {
    const double tolerance = std::pow(10.0, k);
    std::vector<std::string> errors, times;
    std::string evaluations;
    for (const char* code : {"generated", "generated, float", "recursion"}) {
      const ordered_json* const p = point_of(motion, code, tolerance);
      const bool ok = p != nullptr && p->at("status") == "ok";
      errors.push_back(ok ? power(number(p->at("error"))) : "");
      times.push_back(ok ? seconds(number(p->at("cpu_seconds"))) : "");
      if (ok && evaluations.empty()) evaluations = p->at("evaluations").dump();
    }
    table.add(
        {power(tolerance, 0), errors[0], errors[1], errors[2], times[0], times[1], times[2], evaluations});
  }
  return table.text();
}

std::string floors(const ordered_json& report) {
  Table table({"scene", "least error, generated", "at tolerance", "least error, recursion", "at tolerance"});
  for (const auto& [model, scene] :
       {std::pair{"soft_snakeboard", "gait"}, std::pair{"rigid_snakeboard", "gait"},
        std::pair{"bicycle", "weave"}, std::pair{"mobile_pendulum", "swing"}}) {
    const ordered_json& floor = motion_of(report, model, scene).at("ladder").at("floor");
    std::vector<std::string> cells = {fmt::format("`{}/{}`", model, scene)};
    for (const char* code : {"generated", "recursion"}) {
      cells.push_back(power(number(floor.at(code).at("error"))));
      cells.push_back(power(number(floor.at(code).at("tolerance")), 0));
    }
    table.add(cells);
  }
  return table.text();
}

/// Least time of one evaluation along the ladder.
double seconds_of_evaluation(const ordered_json& motion, const std::string& code) {
  double least = std::numeric_limits<double>::quiet_NaN();
  for (const ordered_json& p : motion.at("ladder").at("points")) {
    if (p.at("code") != code || p.at("status") != "ok") continue;
    const double x = number(p.at("cpu_seconds")) / number(p.at("evaluations"));
    if (!(x >= least)) least = x;
  }
  return least;
}

std::string equal_error(const ordered_json& report) {
  Table table({"motion", "CPU at 1e-6, generated", "recursion / generated", "CPU at 1e-9, generated",
               "recursion / generated", "one evaluation alone"});
  for (const ordered_json& motion : report.at("motions")) {
    if (!motion.contains("ladder")) continue;
    std::vector<std::string> cells = {
        fmt::format("`{}/{}`", motion.at("model").get<std::string>(), motion.at("scene").get<std::string>())};
    for (const double error : {1e-6, 1e-9}) {
      const double own = cpu_seconds_at(motion, "generated", error);
      cells.push_back(std::isnan(own) ? "not reached" : seconds(own));
      cells.push_back(ratio(cpu_seconds_at(motion, "recursion", error) / own));
    }
    cells.push_back(
        ratio(seconds_of_evaluation(motion, "recursion") / seconds_of_evaluation(motion, "generated")));
    table.add(cells);
  }
  return table.text();
}

std::string peers(const ordered_json& record) {
  Table table({"motion", "generated, CPU at 1e-6", "at 1e-9", "recursion / generated", "MuJoCo / generated",
               "Simbody / generated"});
  for (const ordered_json& motion : record.at("motions")) {
    std::vector<std::string> cells = {fmt::format("`{}`, {}", motion.at("model").get<std::string>(),
                                                  motion.at("scene").get<std::string>())};
    for (const double error : {1e-6, 1e-9})
      cells.push_back(seconds(cpu_seconds_at(motion, "generated", error)));
    for (const char* code : {"recursion", "MuJoCo", "Simbody"}) {
      const auto at = [&](double error) {
        return ratio(cpu_seconds_at(motion, code, error) / cpu_seconds_at(motion, "generated", error));
      };
      const ordered_json& points = motion.at("ladder").at("points");
      const bool takes_part =
          std::ranges::any_of(points, [&](const ordered_json& p) { return p.at("code") == code; });
      cells.push_back(takes_part ? at(1e-6) + " / " + at(1e-9) : "");
    }
    table.add(cells);
  }
  return table.text();
}

std::string stiffness(const ordered_json& record) {
  Table table(
      {"fastest rate, 1/s", "steps, stiff", "evaluations, stiff", "error", "evaluations, explicit", "error"});
  for (const ordered_json& row : record.at("rows")) {
    const ordered_json &stiff = row.at("stiff"), &explicit_method = row.at("explicit");
    table.add({power(number(row.at("fastest_per_s"))), stiff.at("steps").dump(),
               stiff.at("evaluations").dump(), power(number(stiff.at("error"))),
               explicit_method.at("evaluations").dump(), power(number(explicit_method.at("error")))});
  }
  return table.text();
}

/// Accuracy reached and the time that it took, of one run.
std::string bicycle(const ordered_json& report) {
  const ordered_json& motion = motion_of(report, "whipple_bicycle", "perturbed");
  Table table({"tolerance", "error of the final state", "CPU time", "faster than the motion"});
  for (const int k : {-6, -9, -12, -14}) {
    const ordered_json* const p = point_of(motion, "generated", std::pow(10.0, k));
    if (p == nullptr) continue;
    const double time = number(p->at("cpu_seconds"));
    table.add({power(std::pow(10.0, k), 0), power(number(p->at("error"))), seconds(time),
               fmt::format("{:.0f} times", number(motion.at("duration_s")) / time)});
  }
  return table.text();
}

std::string machine(const ordered_json& record) {
  const ordered_json& m = record.at("machine");
  std::string flags;
  for (const ordered_json& flag : m.at("flags"))
    flags += (flags.empty() ? "" : " ") + flag.get<std::string>();
  return fmt::format("Processor: {}; compiler: {}; flags: `{}`; anholon {}.\n",
                     m.at("processor").get<std::string>(), m.at("compiler").get<std::string>(), flags,
                     m.at("anholon").get<std::string>());
}

}  // namespace

Figures figures_of(const fs::path& folder) {
  const auto record = [&](const char* name) { return ordered_json::parse(text_of(folder / name)); };
  const ordered_json report = record("report.json"), others = record("motions.json");
  return {{"machine", machine(report)},
          {"verification", verification(report)},
          {"worst outputs", worst_outputs(report)},
          {"robots", robots(report)},
          {"scenes", scenes(report)},
          {"motions", motions(report)},
          {"position motions", position_motions(report)},
          {"work-precision", work_precision(report)},
          {"floors", floors(report)},
          {"equal error", equal_error(report)},
          {"bicycle", bicycle(report)},
          {"peers", peers(others)},
          {"stiffness", stiffness(record("stiffness_cost.json"))}};
}

std::string with_figures(const std::string& text, const Figures& figures) {
  const std::string begin = "<!-- figures: ", close = " -->\n", end = "<!-- end of figures -->";
  std::string result;
  std::size_t at = 0;
  for (;;) {
    const std::size_t mark = text.find(begin, at);
    if (mark == std::string::npos) return result + text.substr(at);
    const std::size_t name_at = mark + begin.size(), name_end = text.find(close, name_at);
    const std::string name = text.substr(name_at, name_end - name_at);
    const auto found = figures.find(name);
    if (name_end == std::string::npos || found == figures.end())
      throw std::runtime_error(fmt::format("there are no figures '{}'", name.substr(0, 60)));
    const std::size_t last = text.find(end, name_end);
    if (last == std::string::npos)
      throw std::runtime_error(fmt::format("the figures '{}' have no end", name));
    result += text.substr(at, name_end + close.size() - at) + "\n" + found->second + "\n";
    at = last;
  }
}

std::vector<fs::path> documents_with_figures(const fs::path& project) {
  std::vector<fs::path> candidates = {project / "README.md"}, documents;
  for (const fs::directory_entry& entry : fs::directory_iterator(project / "docs")) {
    if (entry.path().extension() == ".md") candidates.push_back(entry.path());
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(project / "models")) {
    if (fs::exists(entry.path() / "README.md")) candidates.push_back(entry.path() / "README.md");
  }
  std::ranges::sort(candidates);
  for (const fs::path& file : candidates) {
    if (text_of(file).find("<!-- figures: ") != std::string::npos) documents.push_back(file);
  }
  return documents;
}

}  // namespace anholon::bench
