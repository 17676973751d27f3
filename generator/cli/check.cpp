// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "check/regularity.hpp"
#include "cli/common.hpp"
#include "describe/deformation.hpp"

namespace anholon::cli {
namespace {

struct Coordinates {
  std::vector<std::string> active, kinematic, dynamic;
};

Coordinates sorted_coordinates(const Model& model, const ReductionReport& reduction) {
  const Partition& p = reduction.partition;
  const auto name_of = [&](int velocity) {
    return model.coordinates[static_cast<std::size_t>(velocity - p.n)].name;
  };
  Coordinates c;
  for (const int i : p.active) c.active.push_back(name_of(i));
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.s_p()); ++i)
    (reduction.ranks.kinematic[i] ? c.kinematic : c.dynamic)
        .push_back(name_of(p.passive[static_cast<std::size_t>(p.n) + i]));
  return c;
}

std::vector<std::string> row_names(const Model& model, const std::vector<int>& rows) {
  std::vector<std::string> names;
  for (const int row : rows) {
    const std::string& name = model.rows[static_cast<std::size_t>(row)].name;
    names.push_back(name.empty() ? fmt::format("{}", row + 1) : name);
  }
  return names;
}

std::string json_text(const Model& model, const ReductionReport& reduction, const Regularity& regularity) {
  const RankAnalysis& ranks = reduction.ranks;
  const Partition& p = reduction.partition;
  const Coordinates coordinates = sorted_coordinates(model, reduction);
  const auto optional = [](const std::optional<std::string>& text) {
    return text ? nlohmann::ordered_json(*text) : nlohmann::ordered_json();
  };
  nlohmann::ordered_json j;
  j["schema"] = "anholon.check/1";
  j["model"] = model.name;
  j["group"] = name(model.group);
  j["sizes"] = {{"n", p.n},           {"s_p", p.s_p()}, {"s_a", p.s_a()},
                {"rows", ranks.rows}, {"m", ranks.m},   {"m_locked", ranks.m_locked}};
  j["table_I"] = ranks.table_I_class(p);
  j["coordinates"] = {{"active", coordinates.active},
                      {"passive_kinematic", coordinates.kinematic},
                      {"passive_dynamic", coordinates.dynamic}};
  j["kernel"] = {{"dimension", reduction.kernel.H.cols()},
                 {"basis", reduction.kernel.description},
                 {"worst_condition", reduction.kernel.worst_condition},
                 {"irregular_samples", reduction.kernel.irregular},
                 {"singular_at", optional(regularity.singular_basis)}};
  if (reduction.charts.size() > 1) {
    nlohmann::ordered_json charts = nlohmann::ordered_json::array();
    for (const Kernel& chart : reduction.charts)
      charts.push_back({{"basis", chart.description}, {"worst_condition", chart.worst_condition}});
    j["kernel"]["charts"] = std::move(charts);
    j["kernel"]["no_single_basis"] = optional(reduction.why_charts);
    j["kernel"]["unserved"] = optional(reduction.unserved);
  }
  j["constraints"] = {{"worst_condition", ranks.worst_condition}, {"worst_at", ranks.worst_at}};
  j["redundant_rows"] = row_names(model, ranks.redundant);
  j["conditions_on_the_imposed_motion"] = row_names(model, ranks.conditions);
  j["rank_drops"] = nlohmann::ordered_json::array();
  for (const auto& drop : ranks.drops)
    j["rank_drops"].push_back(
        {{"where", drop.where}, {"rank", drop.rank}, {"rows", row_names(model, drop.rows)}});
  if (ranks.drops.empty() && regularity.rank_drop)
    j["rank_drops"].push_back({{"where", *regularity.rank_drop},
                               {"rank", nullptr},
                               {"rows", row_names(model, regularity.dropped_rows)}});
  j["deformation"] = kept_terms(model);
  j["notes"] = model.notes;
  return j.dump(1) + "\n";
}

void line(const std::string& what, const std::string& text) { fmt::print("  {:<21s} {}\n", what, text); }

std::string counted(int n, const std::string& what, const std::string& plural) {
  return fmt::format("{} {}", n, n == 1 ? what : plural);
}

void print(const Model& model, const ReductionReport& reduction, const Regularity& regularity) {
  const RankAnalysis& ranks = reduction.ranks;
  const Partition& p = reduction.partition;
  const Kernel& kernel = reduction.kernel;
  const Coordinates c = sorted_coordinates(model, reduction);
  const auto listed = [](const std::vector<std::string>& names) {
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
  };
  fmt::print("{}{}\n", model.name, model.title.empty() ? "" : ": " + model.title);
  line("group", fmt::format("{} (n = {})", name(model.group), p.n));
  line("bodies", fmt::format("{}", model.bodies.size()));
  for (const Count& count : model.counts)
    line("count", fmt::format("{} = {}, from {} to {}: {}", count.name, count.value, count.least, count.most,
                              count.meaning));
  line("active coordinates", fmt::format("s_a = {}: {}", p.s_a(), listed(c.active)));
  line("passive coordinates", p.s_p() == 0 ? "s_p = 0: none"
                                           : fmt::format("s_p = {}: kinematic {}; dynamic {}", p.s_p(),
                                                         listed(c.kinematic), listed(c.dynamic)));
  line("constraint rows", ranks.rows == 0
                              ? "none"
                              : fmt::format("{}; rank m = {} of (A, B_p, B_a), m° = {} of (A, B_p)",
                                            ranks.rows, ranks.m, ranks.m_locked));
  if (!ranks.redundant.empty())
    line("redundant rows", fmt::format("{}: implied by the others, whatever moves",
                                       fmt::join(row_names(model, ranks.redundant), ", ")));
  if (!ranks.conditions.empty())
    line("conditions", fmt::format("{}: bind the motion of the active coordinates alone",
                                   fmt::join(row_names(model, ranks.conditions), ", ")));
  line("class (Table I)", ranks.table_I_class(p));
  if (reduction.charts.size() > 1) {
    line("kernel", fmt::format("{}; no basis serves the whole range: an atlas of {} charts",
                               counted(kernel.H.cols(), "reduced velocity", "reduced velocities"),
                               reduction.charts.size()));
    for (std::size_t c = 0; c < reduction.charts.size(); ++c)
      line(fmt::format("  chart {}", c + 1),
           fmt::format("{}; condition of H where it is to serve, worst {:.3g}",
                       reduction.charts[c].description, reduction.charts[c].worst_condition));
    if (reduction.why_charts)
      line("  why", fmt::format("the best single basis is singular at {}", *reduction.why_charts));
    if (reduction.unserved)
      line("  not served", fmt::format("no chart is well conditioned at {}", *reduction.unserved));
  } else {
    line("kernel",
         kernel.H.cols() == 0
             ? kernel.description
             : fmt::format("{}; {}", counted(kernel.H.cols(), "reduced velocity", "reduced velocities"),
                           kernel.description));
  }
  if (ranks.rows > 0) {
    const std::string basis =
        kernel.H.cols() == 0 ? "" : fmt::format("basis H {:.3g}, ", kernel.worst_condition);
    line("condition, worst", fmt::format("{}(A, B_p) {:.3g}{}", basis, ranks.worst_condition,
                                         ranks.worst_at.empty() ? "" : " at " + ranks.worst_at));
  }
  if (kernel.irregular > 0)
    line("irregular basis",
         fmt::format("H or J is singular, infinite or vanishes at {}",
                     counted(kernel.irregular, "sampled configuration", "sampled configurations")));
  if (regularity.singular_basis) {
    line("singular basis",
         fmt::format("H or J is singular at {}, where (A, B_p) keeps its rank;", *regularity.singular_basis));
    line("", "name other free_velocities in the description, or keep motions away from there");
  }
  for (const auto& drop : ranks.drops)
    line("rank drop", fmt::format("(A, B_p) has rank {} at {}: {}", drop.rank, drop.where,
                                  fmt::join(row_names(model, drop.rows), ", ")));
  if (ranks.drops.empty() && regularity.rank_drop)
    line("rank drop", fmt::format("(A, B_p) loses rank at {}: {}", *regularity.rank_drop,
                                  fmt::join(row_names(model, regularity.dropped_rows), ", ")));
  for (const std::string& terms : kept_terms(model)) line("deformation", terms);
  for (const std::string& note : model.notes) line("note", note);
}

}  // namespace

int check(const CheckOptions& options) {
  const Model model = load_model(options);
  if (wants_tree(options, model)) return check_tree(options, model);
  DeriveRequest request = derive_request(options, model);
  request.functions = {"kinematics", "constraints"};
  request.closed_forms = false;
  const auto derivation = derive(model, request);
  const Regularity regularity = search_singularities(model, *derivation);
  if (options.json) {
    fmt::print("{}", json_text(model, derivation->reduction, regularity));
  } else {
    print(model, derivation->reduction, regularity);
  }
  return ok;
}

}  // namespace anholon::cli
