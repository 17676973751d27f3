// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "describe/names.hpp"
#include "describe/read_parts.hpp"

namespace anholon {
namespace {

constexpr int most_modes = 30;
constexpr std::size_t most_bodies = 1000;

const std::vector<std::string> joint_kinds = {"fixed", "revolute", "prismatic", "helical"};

/// A new coordinate's name, unique among coordinates, parameters and the words of expressions.
std::string coordinate_name(const Value& value, std::string_view what, Reading& reading,
                            std::vector<std::string>& taken) {
  const std::string name = reading.new_name(value, what);
  if (name.empty()) return "";
  if (std::find(taken.begin(), taken.end(), name) != taken.end()) {
    reading.findings.error(value.where, fmt::format("the name '{}' of {} is taken already", name, what),
                           "parameters, coordinates, states and functions need different names");
    return "";
  }
  taken.push_back(name);
  return name;
}

void read_parent(BodyOutline& body, BodyDescription& described, const std::vector<std::string>& all_names,
                 Reading& reading) {
  const Value* parent = body.table.required("parent", Value::Kind::string, "name the body it hangs on");
  if (parent == nullptr) return;
  described.parent = body_index(reading.model, parent->text);
  if (described.parent >= 0) return;
  described.parent = 0;
  const std::string fact =
      fmt::format("{} has parent '{}', which is not a body", body.table.what(), parent->text);
  if (parent->text == described.name) {
    reading.findings.error(parent->where, fmt::format("{} is its own parent", body.table.what()),
                           "name the body it hangs on");
  } else if (std::find(all_names.begin(), all_names.end(), parent->text) != all_names.end()) {
    reading.findings.error(
        parent->where,
        fmt::format("{} has parent '{}', which comes after it", body.table.what(), parent->text),
        "write parents before their children");
  } else {
    reading.findings.error(
        parent->where, fact,
        did_you_mean(parent->text, all_names, fmt::format("bodies are {}", listed(all_names))));
  }
}

void read_joint_outline(BodyOutline& body, BodyDescription& described, Reading& reading,
                        std::vector<std::string>& taken, std::vector<Coordinate>& joints) {
  const Value* table =
      body.table.required("joint", Value::Kind::table, "write for example joint = { kind = \"fixed\" }");
  if (table == nullptr) return;
  TableReader& joint =
      body.joint.emplace(*table, fmt::format("the joint of {}", body.table.what()), reading.findings);
  const auto kind = joint.required_choice("kind", joint_kinds);
  if (!kind) {
    joint.accept_all_keys();
    return;
  }
  described.joint.kind = static_cast<JointKind>(*kind);
  if (described.joint.kind == JointKind::fixed) return;
  const Value* name = joint.required("coordinate", Value::Kind::string, "name it: coordinate = \"r1\"");
  if (name == nullptr) return;
  described.joint.coordinate = coordinate_name(*name, "a coordinate", reading, taken);
  if (described.joint.coordinate.empty()) return;
  Coordinate coordinate;
  coordinate.name = described.joint.coordinate;
  coordinate.is_angle = described.joint.kind != JointKind::prismatic;
  coordinate.where = name->where;
  joints.push_back(coordinate);
}

/// Planes of deflection: "y", "z" or both.
std::vector<int> planes_of(TableReader& beam) {
  const Value* value = beam.optional("planes");
  if (value == nullptr) return {1};
  std::vector<const Value*> words;
  if (value->kind == Value::Kind::array) {
    for (const Value& item : value->items) words.push_back(&item);
  } else {
    words.push_back(value);
  }
  std::vector<int> planes;
  for (const Value* word : words) {
    const int axis = word->kind != Value::Kind::string ? 0
                     : word->text == "y"               ? 1
                     : word->text == "z"               ? 2
                                                       : 0;
    if (axis == 0 || std::find(planes.begin(), planes.end(), axis) != planes.end()) {
      beam.findings().error(word->where,
                            fmt::format("'planes' of {} are not \"y\", \"z\" or both", beam.what()),
                            "name each axis along which the beam deflects once");
      return {1};
    }
    planes.push_back(axis);
  }
  if (planes.empty()) {
    beam.findings().error(value->where, fmt::format("'planes' of {} is empty", beam.what()),
                          "write planes = \"y\"");
    planes = {1};
  }
  return planes;
}

/// The coordinates of a compliant body's modes: named by the key `coordinates`, or after the body.
/// @param is_angle  whether mode i is measured in rad
void add_modal_coordinates(TableReader& table, const BodyDescription& described, std::size_t count,
                           const std::function<bool(std::size_t)>& is_angle, const char* mend,
                           Reading& reading, std::vector<std::string>& taken) {
  const Value* names = table.optional("coordinates", Value::Kind::array);
  if (names != nullptr && names->items.size() != count) {
    reading.findings.error(
        names->where,
        fmt::format("{} has {} modes but names {} coordinates", table.what(), count, names->items.size()),
        mend);
    names = nullptr;
  }
  for (std::size_t i = 0; i < count; ++i) {
    Value name;
    name.kind = Value::Kind::string;
    name.where = table.table().where;
    name.text = fmt::format("{}_e{}", described.name, i + 1);
    if (names != nullptr) name = names->items[i];
    if (name.kind != Value::Kind::string) {
      reading.findings.error(name.where,
                             fmt::format("a coordinate of {} is {}", table.what(), name.kind_name()),
                             "write its name in quotes");
      name.text.clear();
    }
    Coordinate coordinate;
    coordinate.where = name.where;
    coordinate.is_angle = is_angle(i);
    if (!name.text.empty()) coordinate.name = coordinate_name(name, "a modal coordinate", reading, taken);
    reading.model.coordinates.push_back(coordinate);
  }
}

/// modal = { table = "panel.modes.toml" }: the path is relative to the description.
void read_modal_outline(BodyOutline& body, const BodyDescription& described, Reading& reading,
                        std::vector<std::string>& taken) {
  const Value* table = body.table.optional("modal", Value::Kind::table);
  if (table == nullptr) return;
  ModalOutline& modal = body.modal.emplace(ModalOutline{
      TableReader(*table, fmt::format("the modes of {}", body.table.what()), reading.findings), {}, 0});
  modal.first_coordinate = static_cast<int>(reading.model.coordinates.size());
  if (body.beam) {
    reading.findings.error(
        table->where, fmt::format("{} is a beam and has a table of modes", body.table.what()), "keep one");
    return;
  }
  if (const Value* file =
          modal.table.required("table", Value::Kind::string, "name the file: table = \"panel.modes.toml\"")) {
    const std::size_t before = reading.findings.size();
    const std::filesystem::path folder = std::filesystem::path(file->where.file).parent_path();
    modal.data = read_modal_table(folder / file->text, file->where, reading.findings);
    if (reading.findings.size() > before) modal.data = {};
  }
  add_modal_coordinates(
      modal.table, described, modal.data.modes(), [](std::size_t) { return false; }, "name one for each mode",
      reading, taken);
}

void read_beam_outline(BodyOutline& body, const BodyDescription& described, Reading& reading,
                       std::vector<std::string>& taken) {
  const Value* table = body.table.optional("beam", Value::Kind::table);
  if (table == nullptr) return;
  BeamOutline& beam = body.beam.emplace(
      BeamOutline{TableReader(*table, fmt::format("the beam of {}", body.table.what()), reading.findings),
                  1,
                  {},
                  0,
                  0,
                  0});
  if (const Value* shapes =
          beam.table.optional("shapes", Value::Kind::array)) {  // the user's own: their number
    beam.modes = static_cast<int>(std::min<std::size_t>(shapes->items.size(), most_modes));
  } else {
    beam.modes = beam.table.optional_integer("modes", 0, most_modes).value_or(1);
  }
  beam.planes = planes_of(beam.table);
  beam.torsion_modes = beam.table.optional_integer("torsion_modes", 0, most_modes).value_or(0);
  beam.axial_modes = beam.table.optional_integer("axial_modes", 0, most_modes).value_or(0);
  beam.first_coordinate = static_cast<int>(reading.model.coordinates.size());
  const std::size_t bending = static_cast<std::size_t>(beam.modes) * beam.planes.size();
  const std::size_t twisting = bending + static_cast<std::size_t>(beam.torsion_modes);
  const std::size_t count = twisting + static_cast<std::size_t>(beam.axial_modes);
  add_modal_coordinates(
      beam.table, described, count, [=](std::size_t i) { return i >= bending && i < twisting; },
      "name one for each mode: plane after plane, then torsion, then axial", reading, taken);
}

void read_couplings_outline(TableReader& root, Outline& outline, const std::vector<Coordinate>& joints,
                            Reading& reading) {
  for (const Value* table : tables_of(root, "coupling", reading.findings)) {
    CouplingOutline coupling{TableReader(*table, "a coupling", reading.findings), "", nullptr, table->where};
    const Value* name =
        coupling.table.required("coordinate", Value::Kind::string, "name the coordinate that follows others");
    coupling.equals = coupling.table.required("equals", "write it as an expression of the others");
    coupling.table.report_unknown_keys();
    if (name == nullptr || coupling.equals == nullptr) continue;
    coupling.coordinate = name->text;
    const auto is_it = [&](const auto& other) { return other.name == name->text; };
    const auto is_coupled = [&](const CouplingOutline& other) { return other.coordinate == name->text; };
    if (std::any_of(outline.couplings.begin(), outline.couplings.end(), is_coupled)) {
      reading.findings.error(name->where, fmt::format("'{}' is coupled twice", name->text),
                             "keep one coupling");
    } else if (std::any_of(joints.begin(), joints.end(), is_it)) {
      outline.couplings.push_back(std::move(coupling));
    } else {
      std::vector<std::string> known;
      for (const Coordinate& joint : joints) known.push_back(joint.name);
      reading.findings.error(
          name->where, fmt::format("'{}' is not the coordinate of a joint", name->text),
          did_you_mean(name->text, known,
                       known.empty() ? "there are none" : fmt::format("joints have {}", listed(known))));
    }
  }
}

}  // namespace

std::vector<const Value*> tables_of(TableReader& root, std::string_view key, Findings& findings) {
  std::vector<const Value*> tables;
  const Value* array = root.optional(key);
  if (array == nullptr) return tables;
  if (array->kind != Value::Kind::array) {
    findings.error(array->where, fmt::format("'{}' is {}", key, array->kind_name()),
                   fmt::format("write [[{}]] before each", key));
    return tables;
  }
  for (const Value& item : array->items) {
    if (item.kind == Value::Kind::table) {
      tables.push_back(&item);
    } else {
      findings.error(item.where, fmt::format("an entry of '{}' is {}", key, item.kind_name()),
                     fmt::format("write [[{}]] before each", key));
    }
  }
  return tables;
}

Outline read_outline(TableReader& root, Reading& reading) {
  Outline outline;
  Model& model = reading.model;
  std::vector<std::string> taken = reserved_names();
  for (const Parameter& parameter : model.parameters) taken.push_back(parameter.name);
  for (const Coordinate& coordinate : model.coordinates) taken.push_back(coordinate.name);

  if (model.bodies.empty()) root.required("body", "write at least the reference body: [[body]] with a name");
  const std::vector<const Value*> tables = tables_of(root, "body", reading.findings);
  if (tables.size() > most_bodies) {
    throw ModelError(tables[most_bodies]->where, fmt::format("more than {} bodies", most_bodies),
                     "use fewer");
  }
  std::vector<std::string> all_names;
  for (const BodyDescription& body : model.bodies) all_names.push_back(body.name);
  for (const Value* table : tables) {
    if (const Value* name = table->find("name"); name != nullptr) all_names.push_back(name->text);
  }

  // Coordinates of joints come in the order of their bodies, each before the modes of its body; the coupled
  // ones are taken out as soon as they are known.
  std::vector<Coordinate> joints = model.coordinates;
  std::vector<std::string> coupled;
  if (const Value* couplings = root.table().find("coupling")) {
    for (const Value& item : couplings->items) {
      if (const Value* name = item.find("coordinate")) coupled.push_back(name->text);
    }
  }
  for (const Value* table : tables) {
    BodyOutline& body = outline.bodies.emplace_back(
        BodyOutline{TableReader(*table, "a body", reading.findings), {}, {}, {}, {}, -1, {}});
    BodyDescription described;
    described.where = table->where;
    if (const Value* name = body.table.required("name", Value::Kind::string, "name it: name = \"wheel\"")) {
      described.name = reading.new_name(*name, "a body");
      if (!described.name.empty() && body_index(model, described.name) >= 0)
        reading.findings.error(name->where, fmt::format("there is a body '{}' already", name->text),
                               "rename one");
      body.table = TableReader(*table, fmt::format("body '{}'", name->text), reading.findings);
      body.table.optional("name");
    }
    if (model.bodies.empty()) {
      for (const std::string_view key : {"parent", "joint", "pose", "station"}) {
        if (table->find(key) != nullptr)
          reading.findings.error(body.table.optional(key)->where,
                                 fmt::format("the reference body has a '{}'", key),
                                 "the first body is the reference body and hangs on nothing; remove it");
      }
    } else {
      read_parent(body, described, all_names, reading);
      const std::size_t before = joints.size();
      read_joint_outline(body, described, reading, taken, joints);
      if (joints.size() > before &&
          std::find(coupled.begin(), coupled.end(), described.joint.coordinate) == coupled.end()) {
        body.coordinate = static_cast<int>(model.coordinates.size());
        model.coordinates.push_back(joints.back());
      }
    }
    read_beam_outline(body, described, reading, taken);
    read_modal_outline(body, described, reading, taken);
    model.bodies.push_back(std::move(described));
  }
  read_couplings_outline(root, outline, joints, reading);
  return outline;
}

int body_index(const Model& model, std::string_view name) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (model.bodies[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

int coordinate_index(const Model& model, std::string_view name) {
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    if (model.coordinates[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace anholon
