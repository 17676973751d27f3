// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "cli/common.hpp"

namespace anholon::cli {

int check(const CheckOptions& options) {
  const Model model = load_model(options);
  DeriveRequest request = derive_request(options, model);
  request.functions = {"kinematics"};
  request.closed_forms = false;
  const auto derivation = derive(model, request);
  const ReductionReport& reduction = derivation->reduction;
  const RankAnalysis& ranks = reduction.ranks;
  const Partition& p = reduction.partition;
  std::vector<std::string> active, kinematic, dynamic;
  for (const int i : p.active) active.push_back(model.coordinates[static_cast<std::size_t>(i - p.n)].name);
  for (int i = 0; i < p.s_p(); ++i) {
    const std::string& coordinate =
        model.coordinates[static_cast<std::size_t>(p.passive[static_cast<std::size_t>(p.n + i)] - p.n)].name;
    (ranks.kinematic[static_cast<std::size_t>(i)] ? kinematic : dynamic).push_back(coordinate);
  }

  if (options.json) {
    nlohmann::ordered_json j;
    j["schema"] = "anholon.check/1";
    j["model"] = model.name;
    j["group"] = name(model.group);
    j["sizes"] = {{"n", p.n},           {"s_p", p.s_p()}, {"s_a", p.s_a()},
                  {"rows", ranks.rows}, {"m", ranks.m},   {"m_locked", ranks.m_locked}};
    j["table_I"] = ranks.table_I_class(p);
    j["coordinates"] = {{"active", active}, {"passive_kinematic", kinematic}, {"passive_dynamic", dynamic}};
    j["kernel"] = {{"dimension", reduction.kernel.H.cols()},
                   {"basis", reduction.kernel.description},
                   {"worst_condition", reduction.kernel.worst_condition},
                   {"irregular_samples", reduction.kernel.irregular}};
    j["constraints"] = {{"worst_condition", ranks.worst_condition}, {"worst_at", ranks.worst_at}};
    for (const auto& drop : ranks.drops)
      j["rank_drops"].push_back({{"where", drop.where}, {"rank", drop.rank}});
    j["notes"] = model.notes;
    fmt::print("{}\n", j.dump(1));
    return ok;
  }
  fmt::print("{}{}\n", model.name, model.title.empty() ? "" : ": " + model.title);
  fmt::print("  group                 {} (n = {})\n", name(model.group), p.n);
  fmt::print("  bodies                {}\n", model.bodies.size());
  fmt::print("  active                s_a = {}: {}\n", p.s_a(), fmt::join(active, ", "));
  fmt::print("  passive, kinematic    {}\n", fmt::join(kinematic, ", "));
  fmt::print("  passive, dynamic      {}  (s_p = {})\n", fmt::join(dynamic, ", "), p.s_p());
  fmt::print("  constraint rows       {}, rank m = {} unlocked, m_locked = {} locked\n", ranks.rows, ranks.m,
             ranks.m_locked);
  fmt::print("  class (Table I)       {}\n", ranks.table_I_class(p));
  fmt::print("  kernel                {} reduced velocities; {}\n", reduction.kernel.H.cols(),
             reduction.kernel.description);
  fmt::print("  conditioning          basis H {:.3g} at worst; constraints {:.3g}{}\n",
             reduction.kernel.worst_condition, ranks.worst_condition,
             ranks.worst_at.empty() ? "" : " at " + ranks.worst_at);
  if (reduction.kernel.irregular > 0)
    fmt::print("  irregular             H or J is not regular at {} of the sampled configurations\n",
               reduction.kernel.irregular);
  for (const auto& drop : ranks.drops)
    fmt::print("  rank drop             (A, B_p) has rank {} at {}\n", drop.rank, drop.where);
  for (const std::string& note : model.notes) fmt::print("  note                  {}\n", note);
  return ok;
}

}  // namespace anholon::cli
