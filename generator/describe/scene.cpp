// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "describe/deformation.hpp"
#include "describe/function_names.hpp"
#include "describe/names.hpp"
#include "describe/outline.hpp"
#include "describe/read_bytes.hpp"
#include "describe/read_model.hpp"
#include "describe/read_scene_parts.hpp"
#include "describe/sha256.hpp"

namespace anholon {
namespace {

/// The scene's own values of parameters: [parameters] l = 0.3.
ParameterValues read_parameter_values(TableReader& root, const Model& model, Findings& findings) {
  ParameterValues values;
  const Value* table = root.optional("parameters", Value::Kind::table);
  if (table == nullptr) return values;
  std::vector<std::string> known;
  for (const Parameter& parameter : model.parameters) known.push_back(parameter.name);
  for (const Entry& entry : table->entries) {
    if (std::find(known.begin(), known.end(), entry.key) == known.end()) {
      findings.error(entry.where, fmt::format("'{}' is not a parameter of the model", entry.key),
                     did_you_mean(entry.key, known, fmt::format("it has {}", listed(known))));
      continue;
    }
    if (const auto value = decimal_value(entry.value)) {
      values[entry.key] = *value;
    } else {
      findings.error(entry.value.where,
                     fmt::format("the value of parameter '{}' is not a decimal number", entry.key),
                     "write for example 0.25 or 1e-3");
    }
  }
  return values;
}

/// frozen = "all" or a list of parameters.
void read_frozen(TableReader& root, Scene& scene, Findings& findings) {
  const Value* value = root.optional("frozen");
  if (value == nullptr) return;
  std::vector<std::string> known;
  for (const Parameter& parameter : scene.model.parameters) known.push_back(parameter.name);
  if (value->kind == Value::Kind::string && value->text == "all") {
    scene.frozen = known;
    return;
  }
  scene.frozen = read_names(*value, "a frozen parameter", known, findings);
}

bool is_modal(const Model& model, int coordinate) {
  for (const BodyDescription& body : model.bodies) {
    for (const ModeDescription& mode : body.modes) {
      if (mode.coordinate == coordinate) return true;
    }
  }
  return false;
}

/// locked = { r1 = 0.2 }
void read_locked(TableReader& root, Scene& scene, Reading& reading) {
  const Value* table = root.optional("locked", Value::Kind::table);
  if (table == nullptr) return;
  for (const Entry& entry : table->entries) {
    const auto index = read_coordinate_name(entry.key, entry.where, reading);
    if (!index) continue;
    const bool is_angle = scene.model.coordinates[static_cast<std::size_t>(*index)].is_angle;
    if (is_modal(scene.model, *index)) {
      reading.findings.error(entry.where, fmt::format("'{}' is a mode and cannot be locked", entry.key),
                             "keep fewer modes: modes = { beam = 0 }");
      continue;
    }
    scene.locked.push_back({*index, reading.number(entry.value, fmt::format("the place of '{}'", entry.key),
                                                   is_angle ? units::one : units::m)});
  }
}

/// modes = { beam = 1 }: modes kept in each family; deformation = "linear" in place of the model's.
void read_modes(TableReader& root, Scene& scene, Findings& findings) {
  if (const auto deformation = root.optional_choice("deformation", deformation_names()))
    scene.deformation = static_cast<Deformation>(*deformation);
  const Value* table = root.optional("modes", Value::Kind::table);
  if (table == nullptr) return;
  TableReader modes(*table, "the modes", findings);
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
    const BodyDescription& body = scene.model.bodies[i];
    if (body.modes.empty()) continue;
    if (const auto kept = modes.optional_integer(body.name, 0, static_cast<int>(body.modes.size())))
      scene.modes.emplace_back(static_cast<int>(i), *kept);
  }
  modes.report_unknown_keys();
}

void read_torque_driven(TableReader& root, Scene& scene, Findings& findings) {
  const Value* value = root.optional("torque_driven");
  if (value == nullptr) return;
  if (root.table().find("drive") != nullptr) {
    findings.error(value->where, "the scene has 'drive' and 'torque_driven'",
                   "say it in one place: drive = { r1 = \"torque\" }");
    return;
  }
  std::vector<std::string> known;
  for (const Coordinate& coordinate : scene.model.coordinates) {
    if (coordinate.drive == Drive::active) known.push_back(coordinate.name);
  }
  if (value->kind == Value::Kind::string && value->text == "all") {
    scene.torque_driven = known;
    return;
  }
  scene.torque_driven = read_names(*value, "a torque-driven coordinate", known, findings);
}

/// A positive number that needs no exactness.
double read_positive(const Value& value, const std::string& what, Reading& reading) {
  const Expr x = reading.number(value, what, std::nullopt);
  const double number = reading.at_defaults(x, value.where, what).to_double();
  if (number > 0) return number;
  reading.findings.error(value.where, fmt::format("{} is {}", what, number), "it must be positive");
  return 1;
}

void read_integrator(TableReader& root, Scene& scene, Reading& reading) {
  const Value* value = root.optional("integrator", Value::Kind::table);
  if (value == nullptr) return;
  TableReader table(*value, "the integrator", reading.findings);
  Integrator& integrator = scene.integrator;
  integrator.where = value->where;
  if (const auto method =
          table.optional_choice("method", {Integrator::method_names.begin(), Integrator::method_names.end()}))
    integrator.method = static_cast<Integrator::Method>(*method);
  const std::string name = integrator.name();
  const Value* tolerance = table.optional("tolerance");
  const Value* step = table.optional("step");
  const bool has_fixed_step = integrator.has_fixed_step();
  if (tolerance != nullptr) integrator.tolerance = read_positive(*tolerance, "the tolerance", reading);
  if (step != nullptr) integrator.step = read_positive(*step, "the step", reading);
  if (has_fixed_step && step == nullptr)
    reading.findings.error(value->where, "the method " + name + " has no step", "write step = 0.01, in s");
  if (has_fixed_step && tolerance != nullptr)
    reading.findings.error(tolerance->where, "the method " + name + " has no tolerance",
                           "remove it; its step is fixed");
  if (!has_fixed_step && step != nullptr)
    reading.findings.error(step->where, "the method " + name + " chooses its steps", "remove the step");
  table.report_unknown_keys();
}

/// duration with output_times = [...] or output_step.
void read_times(TableReader& root, Scene& scene, Reading& reading) {
  constexpr double most_outputs = 1e6;
  if (const Value* duration = root.optional("duration"))
    scene.duration = read_positive(*duration, "the duration", reading);
  const Value* times = root.optional("output_times", Value::Kind::array);
  const Value* step = root.optional("output_step");
  if (times != nullptr && step != nullptr) {
    reading.findings.error(step->where, "the scene has output_times and an output_step", "keep one");
  } else if (times != nullptr) {
    for (const Value& item : times->items) {
      const Expr x = reading.number(item, "an output time", units::s);
      const double t = reading.at_defaults(x, item.where, "an output time").to_double();
      const double before = scene.output_times.empty() ? -1 : scene.output_times.back();
      if (t <= before || t < 0 || t > scene.duration)
        reading.findings.error(item.where, fmt::format("the output time {} is out of order", t),
                               "they increase from 0 to the duration");
      scene.output_times.push_back(t);
    }
  } else if (step != nullptr) {
    const double h = read_positive(*step, "the output step", reading);
    if (scene.duration / h > most_outputs) {
      reading.findings.error(step->where, "the scene asks for more than a million outputs",
                             "take a larger step");
      return;
    }
    const auto count = static_cast<long>(std::floor(scene.duration / h * (1 + 1e-12)));
    for (long i = 0; i <= count; ++i)
      scene.output_times.push_back(std::min(static_cast<double>(i) * h, scene.duration));
    if (scene.output_times.back() < scene.duration * (1 - 1e-9)) scene.output_times.push_back(scene.duration);
  }
}

/// Each active coordinate of a scene with a duration moves as told, by motion or by torque; no coordinate
/// twice.
void check_drives(const TableReader& root, const Scene& scene, Findings& findings) {
  const Model& model = scene.model;
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    const Coordinate& coordinate = model.coordinates[i];
    const auto is_it = [&](const auto& entry) { return entry.coordinate == static_cast<int>(i); };
    const bool moved =
        std::any_of(scene.motion.begin(), scene.motion.end(), is_it) ||
        (scene.motion_table && std::count(scene.motion_table->coordinates.begin(),
                                          scene.motion_table->coordinates.end(), static_cast<int>(i)) > 0);
    const bool locked = std::any_of(scene.locked.begin(), scene.locked.end(), is_it);
    const bool torque_driven = std::find(scene.torque_driven.begin(), scene.torque_driven.end(),
                                         coordinate.name) != scene.torque_driven.end();
    if (moved + locked + torque_driven > 1) {
      findings.error(root.table().where, fmt::format("'{}' is driven in more than one way", coordinate.name),
                     "keep it in one of locked, motion and torque_driven");
    } else if (scene.duration > 0 && coordinate.drive == Drive::active && !moved && !locked &&
               !torque_driven) {
      findings.error(root.table().where,
                     fmt::format("the scene does not say how '{}' moves", coordinate.name),
                     "name it in motion, locked or torque_driven");
    }
  }
}

/// The scene's description, relative to the scene. @throws ModelError where there is none
std::string model_name_of(const Value& document, Findings& findings) {
  TableReader root(document, "the scene", findings);
  const auto name = root.required_string(
      "model", "name the description, relative to the scene: model = \"snakeboard.toml\"");
  findings.throw_if_any();
  const Location where = root.find_where("model");
  const std::filesystem::path file = std::filesystem::path(where.file).parent_path() / *name;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw ModelError(where, fmt::format("there is no file '{}'", *name),
                     "name the description, relative to the scene");
  return *name;
}

void read_header(TableReader& root, Scene& scene, Reading& reading) {
  if (root.required("anholon", "write anholon = 1, the version of this format") != nullptr)
    root.optional_integer("anholon", 1, 1);
  if (const Value* name = root.required("name", Value::Kind::string, "name it: name = \"gait\""))
    scene.name = reading.new_name(*name, "the scene");
  scene.title = root.optional_string("title").value_or(scene.name);
  if (const Value* functions = root.optional("functions", Value::Kind::array)) {
    for (const Value& item : functions->items) {
      if (item.kind != Value::Kind::string) {
        reading.findings.error(item.where, fmt::format("a function is {}", item.kind_name()),
                               "write its name");
      } else if (std::ranges::find(function_names(), item.text) == function_names().end()) {
        const std::string near = closest_name(item.text, function_names());
        reading.findings.error(
            item.where, fmt::format("there is no function '{}'", item.text),
            fmt::format("{}choose from {}", near.empty() ? "" : fmt::format("did you mean '{}'? ", near),
                        listed(function_names())));
      } else if (std::ranges::find(scene.functions, item.text) != scene.functions.end()) {
        reading.findings.error(item.where, fmt::format("function '{}' is named twice", item.text),
                               "remove one");
      } else {
        scene.functions.push_back(item.text);
      }
    }
  }
  if (const Value* gravity = root.optional("gravity", Value::Kind::boolean))
    scene.gravity = gravity->text == "true";
}

}  // namespace

Scene read_scene_text(std::string_view text, const std::filesystem::path& path) {
  Value document = read_document(text, path.string());
  Findings findings;
  const CountValues counts = read_count_values(document, findings);
  findings.throw_if_any();
  std::erase_if(document.entries, [](const Entry& e) { return e.key == "counts"; });
  Scene scene;
  scene.file = path.filename().string();
  scene.where = scene.initial_where = document.where;
  scene.sha256 = sha256_of(text);
  if (document.find("model") == nullptr && document.find("body") != nullptr)
    throw ModelError(
        document.where, "the file describes a robot, not a scene",
        fmt::format("write a scene beside it that begins with anholon = 1, a name and model = \"{}\"",
                    scene.file));
  scene.model_file = path.parent_path() / model_name_of(document, findings);
  scene.model = read_model(scene.model_file, {}, counts);
  write_out(document, scene.model.counts, findings);
  findings.throw_if_any();
  TableReader root(document, "the scene", findings);
  root.optional("model");
  if (const ParameterValues values = read_parameter_values(root, scene.model, findings); !values.empty()) {
    findings.throw_if_any();
    scene.model = read_model(scene.model_file, values, counts);
  }
  Reading reading(scene.model, findings);
  name_symbols(reading);
  name_coupled_coordinates(reading);
  read_header(root, scene, reading);
  read_drive(root, scene, reading);
  read_frozen(root, scene, findings);
  read_locked(root, scene, reading);
  read_modes(root, scene, findings);
  read_torque_driven(root, scene, findings);
  read_motion(root, path, scene, reading);
  if (const auto choice = root.optional_choice("incompatible_motion", {"refuse", "project"}))
    scene.project_motion = *choice == 1;
  read_torques(root, scene, reading);
  read_initial_state(root, scene, reading);
  read_integrator(root, scene, reading);
  read_times(root, scene, reading);
  read_phases(root, scene, reading);
  root.report_unknown_keys();
  if (findings.empty()) check_drives(root, scene, findings);
  findings.throw_if_any();
  return scene;
}

std::string program_name(const Scene& scene) {
  return scene.contact_set.empty() ? scene.name : scene.name + "_" + scene.contact_set;
}

std::vector<std::string> Scene::open_contacts() const {
  const auto in_force = std::ranges::find(contact_sets, contact_set, &ContactSet::name);
  std::vector<std::string> open;
  for (const ContactSet& set : contact_sets) {
    for (const std::string& contact : set.contacts) {
      if (std::ranges::find(in_force->contacts, contact) == in_force->contacts.end() &&
          std::ranges::find(open, contact) == open.end())
        open.push_back(contact);
    }
  }
  return open;
}

Scene read_scene(const std::filesystem::path& path) { return read_scene_text(read_bytes(path), path); }

bool is_scene(const std::filesystem::path& path) {
  const Value document = read_document(read_bytes(path), path.string());
  return document.find("model") != nullptr && document.find("body") == nullptr;
}

}  // namespace anholon
