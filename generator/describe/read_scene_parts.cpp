// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/read_scene_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "describe/motion_table.hpp"
#include "describe/names.hpp"
#include "describe/outline.hpp"
#include "describe/read_bytes.hpp"
#include "describe/read_parts.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

bool is_named(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Active coordinate whose motion is imposed.
std::optional<int> read_moved(const std::string& name, const Location& where, Reading& reading) {
  const auto index = read_coordinate_name(name, where, reading);
  if (!index || reading.model.coordinates[static_cast<std::size_t>(*index)].drive == Drive::active)
    return index;
  reading.findings.error(where, fmt::format("'{}' is passive", name), "only active coordinates move as told");
  return std::nullopt;
}

/// The last row of a periodic table is its first one again. To rounding only, where the table was made with
/// sin(2 pi k/n); it is made exact, so that it closes in any scalar.
void close_table(MotionTable& table, const std::vector<std::string>& names, const Location& top,
                 Findings& findings) {
  constexpr double roundings = 16 * std::numeric_limits<double>::epsilon();
  const std::vector<double>& first = table.rows.front();
  std::vector<double>& last = table.rows.back();
  for (std::size_t c = 0; c < first.size(); ++c) {
    double largest = 0;
    for (const std::vector<double>& row : table.rows) largest = std::max(largest, std::abs(row[c]));
    if (!(std::abs(last[c] - first[c]) <= roundings * largest))
      findings.error(top,
                     fmt::format("the table is periodic, but '{}' begins with {} and ends with {}",
                                 names[c + 1], first[c], last[c]),
                     "repeat the first row at the end of the period, or take other ends");
  }
  last = first;
}

void read_table(TableReader& motion, const std::filesystem::path& scene_file, Scene& scene,
                Reading& reading) {
  const Value* file = motion.required("table", Value::Kind::string, "name the file");
  if (file == nullptr) return;
  const auto ends = motion.optional_choice("ends", {"natural", "clamped", "periodic"});
  MotionTable table;
  table.file = scene_file.parent_path() / file->text;
  if (ends) table.ends = static_cast<MotionTable::Ends>(*ends);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(table.file, ignored)) {
    reading.findings.error(file->where, fmt::format("there is no file '{}'", file->text),
                           "name the table, relative to the scene");
    return;
  }
  const std::string file_name = table.file.string();
  const NumberTable numbers = read_number_table(read_bytes(table.file), file_name, reading.findings);
  const Location top{file_name, 1, 1};
  if (numbers.names.empty() || numbers.names.front() != "t") {
    reading.findings.error(top, "the first column is not t", "write a header line: t,r1,r2");
    return;
  }
  for (std::size_t i = 1; i < numbers.names.size(); ++i) {
    if (const auto index = read_moved(numbers.names[i], top, reading)) table.coordinates.push_back(*index);
  }
  const std::size_t fewest = table.ends == MotionTable::Ends::periodic ? 4 : 2;
  if (numbers.rows.size() < fewest)
    reading.findings.error(top, fmt::format("the table has {} rows", numbers.rows.size()),
                           fmt::format("write at least {}", fewest));
  for (const std::vector<double>& row : numbers.rows) {
    if (!table.times.empty() && row[0] <= table.times.back())
      reading.findings.error(top, fmt::format("the time {} does not follow {}", row[0], table.times.back()),
                             "times increase from row to row");
    table.times.push_back(row[0]);
    table.rows.emplace_back(row.begin() + 1, row.end());
  }
  if (table.ends == MotionTable::Ends::periodic && !table.rows.empty())
    close_table(table, numbers.names, top, reading.findings);
  scene.motion_table = std::move(table);
}

}  // namespace

void read_motion(TableReader& root, const std::filesystem::path& scene_file, Scene& scene, Reading& reading) {
  const Value* value = root.optional("motion", Value::Kind::table);
  if (value == nullptr) return;
  TableReader motion(*value, "the motion", reading.findings);
  Model& model = scene.model;
  Tape& tape = *model.tape;
  if (motion.optional("table") != nullptr) read_table(motion, scene_file, scene, reading);
  for (const Entry& entry : value->entries) {
    if (entry.key == "table" || entry.key == "ends") {
      if (value->find("table") == nullptr)
        reading.findings.error(entry.where, "the motion has ends but no table",
                               "name a table, or remove the ends");
      continue;
    }
    if (value->find("table") != nullptr) {
      reading.findings.error(entry.where, fmt::format("the motion has a table and '{}'", entry.key),
                             "write a column of the table for it, or expressions for all");
      continue;
    }
    const auto index = read_moved(entry.key, entry.where, reading);
    if (!index) continue;
    const bool is_angle = model.coordinates[static_cast<std::size_t>(*index)].is_angle;
    ImposedMotion imposed;
    imposed.coordinate = *index;
    imposed.r = reading.number(entry.value, fmt::format("the motion of '{}'", entry.key),
                               is_angle ? units::one : units::m, SymbolKind::parameter | SymbolKind::time);
    for (const NodeId id : tape.reachable({imposed.r.id(tape)})) {
      if (tape.node(id).op == Op::abs || tape.node(id).op == Op::sign)
        reading.findings.error(entry.value.where, fmt::format("the motion of '{}' has a kink", entry.key),
                               "it needs two derivatives: do without abs and sign");
    }
    const NodeId rate = derivative(tape, imposed.r.id(tape), model.symbols.t);
    imposed.r_dot = Expr(tape, rate);
    imposed.r_ddot = Expr(tape, derivative(tape, rate, model.symbols.t));
    scene.motion.push_back(imposed);
  }
}

void read_torques(TableReader& root, Scene& scene, Reading& reading) {
  const Value* value = root.optional("torque", Value::Kind::table);
  if (value == nullptr) return;
  for (const Entry& entry : value->entries) {
    const auto index = read_coordinate_name(entry.key, entry.where, reading);
    if (!index) continue;
    if (!is_named(scene.torque_driven, entry.key)) {
      reading.findings.error(entry.where, fmt::format("'{}' is not torque-driven", entry.key),
                             "name it in torque_driven, or write a force into the description");
      continue;
    }
    const bool is_angle = scene.model.coordinates[static_cast<std::size_t>(*index)].is_angle;
    scene.torques.push_back(
        {*index, reading.number(entry.value, fmt::format("the torque on '{}'", entry.key),
                                is_angle ? units::newton_m : units::newton,
                                SymbolKind::parameter | SymbolKind::coordinate | SymbolKind::velocity |
                                    SymbolKind::pose | SymbolKind::time)});
  }
}

void read_initial_state(TableReader& root, Scene& scene, Reading& reading) {
  const Value* value = root.optional("initial", Value::Kind::table);
  if (value == nullptr) return;
  const Model& model = scene.model;
  TableReader initial(*value, "the initial state", reading.findings);
  scene.initial_where = value->where;
  const auto at = [&](const Expr& x, const Location& where, const std::string& what) {
    return reading.at_defaults(x, where, what);
  };
  if (const Value* pose = initial.optional("pose", Value::Kind::table)) {
    const PoseDescription described = read_pose(*pose, "the initial pose", reading);
    for (std::size_t i = 0; i < 9; ++i)
      scene.initial.R[i] = at(described.R[i], pose->where, "the initial pose");
    for (std::size_t i = 0; i < 3; ++i)
      scene.initial.p[i] = at(described.p[i], pose->where, "the initial pose");
  }
  if (const Value* table = initial.optional("coordinates", Value::Kind::table)) {
    for (const Entry& entry : table->entries) {
      const auto index = read_coordinate_name(entry.key, entry.where, reading);
      if (!index) continue;
      const Coordinate& coordinate = model.coordinates[static_cast<std::size_t>(*index)];
      if (coordinate.drive == Drive::active && !is_named(scene.torque_driven, coordinate.name)) {
        reading.findings.error(entry.where, fmt::format("'{}' starts where its motion starts", entry.key),
                               "remove it, or name it in torque_driven");
        continue;
      }
      const std::string what = fmt::format("the initial value of '{}'", entry.key);
      const Expr x = reading.number(entry.value, what, coordinate.is_angle ? units::one : units::m);
      scene.initial.coordinates.emplace_back(*index, at(x, entry.value.where, what));
    }
  }
  if (const Value* table = initial.optional("velocities", Value::Kind::table)) {
    std::vector<std::string> known;
    for (const int i : free_components(model.group))
      known.emplace_back(twist_component_names[static_cast<std::size_t>(i)]);
    for (const Coordinate& coordinate : model.coordinates) {
      if (coordinate.drive == Drive::passive || is_named(scene.torque_driven, coordinate.name))
        known.push_back(coordinate.name);
    }
    for (const Entry& entry : table->entries) {
      if (!is_named(known, entry.key)) {
        reading.findings.error(entry.where, fmt::format("'{}' is not a velocity that has a start", entry.key),
                               did_you_mean(entry.key, known, fmt::format("those are of {}", listed(known))));
        continue;
      }
      const auto component = std::find(twist_component_names.begin(), twist_component_names.end(), entry.key);
      const bool is_component = component != twist_component_names.end();
      const int index = is_component ? static_cast<int>(component - twist_component_names.begin())
                                     : 6 + coordinate_index(model, entry.key);
      const bool is_turn =
          is_component ? index >= 3 : model.coordinates[static_cast<std::size_t>(index - 6)].is_angle;
      const std::string what = fmt::format("the initial velocity of '{}'", entry.key);
      const Expr x = reading.number(entry.value, what, is_turn ? units::per_s : units::m_per_s);
      scene.initial.velocities.emplace_back(index, at(x, entry.value.where, what));
    }
  }
  if (const Value* names = initial.optional("equilibrium", Value::Kind::array)) {
    std::vector<std::string> known;
    for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
      const auto is_it = [&](const auto& given) { return given.first == static_cast<int>(i); };
      const auto rate_is = [&](const auto& given) { return given.first == static_cast<int>(i) + 6; };
      if (model.coordinates[i].drive == Drive::passive &&
          std::ranges::none_of(scene.initial.coordinates, is_it) &&
          std::ranges::none_of(scene.initial.velocities, rate_is))
        known.push_back(model.coordinates[i].name);
    }
    for (const std::string& name :
         read_names(*names, "a passive coordinate whose start is open", known, reading.findings))
      scene.initial.equilibrium.push_back(coordinate_index(model, name));
  }
  initial.report_unknown_keys();
}

std::optional<int> read_coordinate_name(const std::string& name, const Location& where, Reading& reading) {
  const int index = coordinate_index(reading.model, name);
  if (index >= 0) return index;
  std::vector<std::string> known;
  for (const Coordinate& coordinate : reading.model.coordinates) known.push_back(coordinate.name);
  reading.findings.error(
      where, fmt::format("'{}' is not an independent coordinate of the model", name),
      did_you_mean(name, known, known.empty() ? "it has none" : fmt::format("it has {}", listed(known))));
  return std::nullopt;
}

std::vector<std::string> read_names(const Value& value, std::string_view what,
                                    const std::vector<std::string>& known, Findings& findings) {
  std::vector<std::string> names;
  if (value.kind != Value::Kind::array) {
    findings.error(value.where, fmt::format("the list is {}", value.kind_name()),
                   "write an array of names, or \"all\"");
    return names;
  }
  for (const Value& item : value.items) {
    if (item.kind != Value::Kind::string || !is_named(known, item.text)) {
      findings.error(item.where, fmt::format("'{}' is not {} of the model", item.text, what),
                     did_you_mean(item.text, known, fmt::format("choose from {}", listed(known))));
    } else if (is_named(names, item.text)) {
      findings.error(item.where, fmt::format("'{}' is named twice", item.text), "remove one");
    } else {
      names.push_back(item.text);
    }
  }
  return names;
}

}  // namespace anholon
