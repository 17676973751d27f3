// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/read_model.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/chain.hpp"
#include "describe/names.hpp"
#include "describe/read_bytes.hpp"
#include "describe/read_parts.hpp"
#include "describe/read_robot.hpp"
#include "describe/read_supplement.hpp"
#include "describe/sha256.hpp"

namespace anholon {
namespace {

/// Version of the format, name, title and group.
void read_header(TableReader& root, Reading& reading) {
  Model& model = reading.model;
  if (root.required("anholon", "write anholon = 1, the version of this format") != nullptr)
    root.optional_integer("anholon", 1, 1);
  if (const Value* name = root.required("name", Value::Kind::string, "name it: name = \"snakeboard\""))
    model.name = reading.new_name(*name, "the model");
  model.title = root.optional_string("title").value_or(model.name);
  if (const auto group = root.required_choice("group", group_names()))
    model.group = static_cast<GroupKind>(*group);
}

void fill(TableReader& root, const ParameterValues& overrides, Reading& reading) {
  read_header(root, reading);
  read_parameters(root, reading);
  for (Parameter& parameter : reading.model.parameters) {
    if (const auto value = overrides.find(parameter.name); value != overrides.end())
      parameter.value = value->second;
  }
  Outline outline = read_outline(root, reading);
  make_symbols(reading);
  read_couplings(outline, reading);
  read_gravity(root, reading);
  for (std::size_t i = 0; i < outline.bodies.size(); ++i) {
    BodyOutline& body = outline.bodies[i];
    BodyDescription& described = reading.model.bodies[i];
    read_station(body, described,
                 described.parent < 0 ? nullptr : &outline.bodies[static_cast<std::size_t>(described.parent)],
                 reading);
    read_pose(body, described, reading);
    read_joint(body, described, reading);
    read_inertia(body, described, reading);
    read_beam(body, described, reading);
    read_modal_body(body, described, reading);
    body.table.report_unknown_keys();
  }
  read_energies(root, reading);
  read_constraints(root, reading);
  read_forces(root, reading);
  read_fluids(root, outline, 0, reading);
  read_free_velocities(root, reading);
  root.report_unknown_keys();
}

}  // namespace

void read_gravity(TableReader& root, Reading& reading) {
  const Value* value = root.optional("gravity");
  if (value == nullptr) return;
  Model& model = reading.model;
  model.gravity = reading.vector3(*value, "gravity", units::m_per_s2);
  const bool is_normal =
      model.gravity[0].is_zero() && model.gravity[1].is_zero() && !model.gravity[2].is_zero();
  if (model.group == GroupKind::SE2 && is_normal)
    model.notes.emplace_back(
        "gravity is normal to the plane of SE2: it moves only bodies that leave the plane");
}

void read_energies(TableReader& root, Reading& reading) {
  Model& model = reading.model;
  if (const Value* value = root.optional("potential")) {
    model.potential += reading.number(*value, "the potential", units::newton_m,
                                      SymbolKind::parameter | SymbolKind::coordinate | SymbolKind::pose);
  }
  if (const Value* value = root.optional("dissipation")) {
    model.dissipation +=
        reading.number(*value, "the dissipation", units::watt,
                       SymbolKind::parameter | SymbolKind::coordinate | SymbolKind::velocity);
  }
}

void read_free_velocities(TableReader& root, Reading& reading) {
  const Value* list = root.optional("free_velocities", Value::Kind::array);
  if (list == nullptr) return;
  std::vector<std::string> known;
  for (const int i : free_components(reading.model.group))
    known.emplace_back(twist_component_names[static_cast<std::size_t>(i)]);
  for (const Coordinate& coordinate : reading.model.coordinates) known.push_back(coordinate.name);
  for (const Value& item : list->items) {
    std::string name = item.text;
    if (name.starts_with("dot(") && name.ends_with(")")) name = name.substr(4, name.size() - 5);
    auto& chosen = reading.model.free_velocities;
    if (item.kind != Value::Kind::string || std::find(known.begin(), known.end(), name) == known.end()) {
      reading.findings.error(
          item.where, fmt::format("'{}' is not a velocity", item.text),
          did_you_mean(name, known, fmt::format("velocities are those of {}", listed(known))));
    } else if (std::find(chosen.begin(), chosen.end(), name) != chosen.end()) {
      reading.findings.error(item.where, fmt::format("'{}' is named twice", item.text), "remove one");
    } else {
      chosen.push_back(name);
    }
  }
}

std::vector<std::string> group_names() {
  std::vector<std::string> groups;
  for (const GroupKind group : {GroupKind::SE3, GroupKind::SE2, GroupKind::SO3, GroupKind::R1, GroupKind::R2,
                                GroupKind::R3, GroupKind::fixed})
    groups.emplace_back(name(group));
  return groups;
}

Model read_model_text(std::string_view text, const std::string& file_name, const ParameterValues& overrides,
                      const CountValues& counts) {
  Value document = read_document(text, file_name);
  Findings repetitions;
  const std::vector<Count> own_counts = take_counts(document, counts, repetitions);
  repetitions.throw_if_any();
  write_out(document, own_counts, repetitions);
  repetitions.throw_if_any();
  write_out_chains(document, repetitions);
  repetitions.throw_if_any();
  if (std::ranges::any_of(supplement_keys, [&](const char* key) { return document.find(key) != nullptr; })) {
    Model model = read_supplemented_robot(document, text, file_name, overrides);
    model.counts = own_counts;
    return model;
  }
  Model model;
  model.counts = own_counts;
  model.file = std::filesystem::path(file_name).filename().string();
  model.sha256 = sha256_of(text);
  Findings findings;
  Reading reading(model, findings);
  TableReader root(document, "the description", findings);
  if (document.find("model") != nullptr && document.find("body") == nullptr) {
    throw ModelError(document.find("model")->where, "the file is a scene, not the description of a robot",
                     "name the description, or use the scene as a scene");
  }
  if (document.find("anholon") == nullptr) {
    throw ModelError({file_name, 1, 1}, "the file has no 'anholon'",
                     "write anholon = 1, the version of this format");
  }
  fill_model(file_name, findings, [&] { fill(root, overrides, reading); });
  return model;
}

Model read_model(const std::filesystem::path& path, const ParameterValues& overrides,
                 const CountValues& counts) {
  if (!is_robot_file(path)) return read_model_text(read_bytes(path), path.string(), overrides, counts);
  return read_robot(path);  // its figures are numbers: there is nothing to override
}

}  // namespace anholon
