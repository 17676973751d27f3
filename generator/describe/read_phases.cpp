// SPDX-License-Identifier: GPL-2.0-or-later
// What a scene changes of joints and contacts: how joints are driven, which contacts hold when, and how
// redundant ones share.
#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/read_scene_parts.hpp"

namespace anholon {
namespace {

/// contact_sets = { both = ["left", "right"], left = ["left"] }
void read_contact_sets(TableReader& root, Scene& scene, Reading& reading) {
  const Value* table = root.optional("contact_sets", Value::Kind::table);
  if (table == nullptr) return;
  std::vector<std::string> known;
  for (const RowDescription& row : scene.model.rows) {
    if (std::ranges::find(known, row.contact) == known.end()) known.push_back(row.contact);
  }
  for (const Entry& entry : table->entries) {
    ContactSet set;
    set.name = entry.key;
    if (const std::string objection = objection_to_name(entry.key); !objection.empty())
      reading.findings.error(entry.where, fmt::format("the name '{}' {}", entry.key, objection),
                             "choose another");
    set.contacts = read_names(entry.value, "a constraint", known, reading.findings);
    scene.contact_sets.push_back(std::move(set));
  }
  if (scene.contact_sets.empty())
    reading.findings.error(table->where, "there are no contact sets",
                           "name some: both = [\"left\", \"right\"]");
  if (!scene.contact_sets.empty()) scene.contact_set = scene.contact_sets.front().name;
}

double number_of(const Value& value, const std::string& what, const std::optional<Dimension>& unit,
                 Reading& reading) {
  const Expr x = reading.number(value, what, unit);
  return reading.at_defaults(x, value.where, what).to_double();
}

ContactPhase read_phase(const Value& table, const Scene& scene, Reading& reading) {
  ContactPhase phase;
  phase.where = table.where;
  TableReader reader(table, "a phase", reading.findings);
  std::vector<std::string> known;
  for (const ContactSet& set : scene.contact_sets) known.push_back(set.name);
  const Value* set =
      reader.required("contacts", Value::Kind::string, "name one of contact_sets: contacts = \"both\"");
  if (set != nullptr && std::ranges::find(known, set->text) == known.end())
    reading.findings.error(set->where, fmt::format("'{}' is not a contact set", set->text),
                           known.empty() ? "write contact_sets = { both = [\"left\", \"right\"] }"
                                         : did_you_mean(set->text, known, "there are " + listed(known)));
  if (set != nullptr) phase.set = set->text;
  if (const Value* start = reader.optional("start"))
    phase.start = number_of(*start, "the start of a phase", units::s, reading);
  if (const Value* gap = reader.optional("gap")) {
    phase.gap = number_of(*gap, "the gap of a phase", units::m, reading);
    if (phase.gap < 0) reading.findings.error(gap->where, "the gap is negative", "write a length in m");
  }
  reader.report_unknown_keys();
  return phase;
}

/// contact_elasticity = { stiffness = 1e6, damping = 1e3 }
void read_elasticity(TableReader& root, Scene& scene, Reading& reading) {
  const Value* value = root.optional("contact_elasticity", Value::Kind::table);
  if (value == nullptr) return;
  TableReader table(*value, "the elasticity of contacts", reading.findings);
  ContactElasticity elasticity;
  const auto read = [&](const char* key, Exact& to) {
    const Value* number = table.required(key, "write a positive number");
    if (number == nullptr) return;
    const std::string what = std::string("the ") + key + " of contacts";
    to = reading.at_defaults(reading.number(*number, what, std::nullopt), number->where, what);
    if (!(to > Exact(0)))
      reading.findings.error(number->where, fmt::format("{} is not positive", what), "write for example 1e6");
  };
  read("stiffness", elasticity.stiffness);
  read("damping", elasticity.damping);
  table.report_unknown_keys();
  scene.elasticity = elasticity;
}

}  // namespace

void read_drive(TableReader& root, Scene& scene, Reading& reading) {
  const Value* value = root.optional("drive", Value::Kind::table);
  if (value == nullptr) return;
  static const std::vector<std::string> ways = {"motion", "torque", "passive"};
  for (const Entry& entry : value->entries) {
    const auto index = read_coordinate_name(entry.key, entry.where, reading);
    if (!index) continue;
    const auto way = std::ranges::find(ways, entry.value.text) - ways.begin();
    if (entry.value.kind != Value::Kind::string || way == 3) {
      reading.findings.error(entry.value.where,
                             fmt::format("'{}' is not a way to drive a joint", entry.value.text),
                             fmt::format("choose from {}", listed(ways)));
      continue;
    }
    const bool is_mode = std::ranges::any_of(scene.model.bodies, [&](const BodyDescription& body) {
      return std::ranges::count(body.modes, *index, &ModeDescription::coordinate) > 0;
    });
    if (is_mode) {
      reading.findings.error(entry.where, fmt::format("'{}' is a mode and has no drive", entry.key),
                             "only joints are driven");
      continue;
    }
    scene.model.coordinates[static_cast<std::size_t>(*index)].drive =
        way < 2 ? Drive::active : Drive::passive;
    if (way == 1) scene.torque_driven.push_back(entry.key);
  }
}

void read_phases(TableReader& root, Scene& scene, Reading& reading) {
  read_contact_sets(root, scene, reading);
  read_elasticity(root, scene, reading);
  if (const Value* continuous = root.optional("continuous")) {
    scene.continuous = number_of(*continuous, "the allowed jump", units::one, reading);
    if (*scene.continuous < 0)
      reading.findings.error(continuous->where, "the allowed jump is negative", "write for example 1e-6");
  }
  if (const auto sharing = root.optional_choice("lambda_stat", {"least norm", "equal friction utilisation"}))
    scene.sharing = static_cast<LoadSharing>(*sharing);
  const Value* phases = root.optional("phase", Value::Kind::array);
  if (phases == nullptr) return;
  for (const Value& table : phases->items) {
    if (table.kind != Value::Kind::table) {
      reading.findings.error(table.where, fmt::format("a phase is {}", table.kind_name()),
                             "write [[phase]] with its keys below");
      continue;
    }
    const ContactPhase phase = read_phase(table, scene, reading);
    const bool in_order = scene.phases.empty() ? phase.start == 0 : phase.start > scene.phases.back().start;
    if (!in_order || (scene.duration > 0 && phase.start >= scene.duration))
      reading.findings.error(table.where, fmt::format("a phase starts at {} s", phase.start),
                             "the first starts at 0, each later than the one before and before the end");
    scene.phases.push_back(phase);
  }
  if (!scene.phases.empty() && reading.findings.empty()) scene.contact_set = scene.phases.front().set;
}

}  // namespace anholon
