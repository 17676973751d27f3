// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/read_supplement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "describe/names.hpp"
#include "describe/read_parts.hpp"
#include "describe/read_robot.hpp"
#include "describe/sha256.hpp"

namespace anholon {
namespace {

class SupplementReader {
 public:
  SupplementReader(const Value& document, std::string_view text, std::string file_name,
                   const ParameterValues& overrides)
      : root_(document, "the description", findings_),
        text_(text),
        file_name_(std::move(file_name)),
        overrides_(overrides) {}

  Model run() {
    read_robot_part();
    look_at_parts();
    Model model = read_robot(robot_file_, options_, supplement_, format_);
    adopt_header(model);
    Reading reading(model, findings_);
    name_symbols(reading);
    append_bodies(model);
    fill_model(file_name_, findings_, [&] {
      read_couplings(outline_, reading);
      fill(model, reading);
      root_.report_unknown_keys();
    });
    return model;
  }

 private:
  /// Which robot file, and how it is to be read.
  void read_robot_part() {
    if (root_.required("anholon", "write anholon = 1, the version of this format") != nullptr)
      root_.optional_integer("anholon", 1, 1);
    const auto name = read_file_key();
    const auto flag = [&](const char* key, bool& to) {
      if (const Value* value = root_.optional(key, Value::Kind::boolean)) to = value->text == "true";
    };
    flag("as_written", options_.as_written);
    flag("symbolic_inertia", options_.symbolic_inertia);
    findings_.throw_if_any();
    robot_file_ = std::filesystem::path(file_name_).parent_path() / *name;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(robot_file_, ignored) || !is_robot_file(robot_file_))
      throw ModelError(root_.find_where(key_), fmt::format("'{}' is not a {} file", *name, name_of(format_)),
                       "name a file ending in .urdf, .sdf, .mjcf or .xml, relative to this one");
  }

  /// The key that names the robot's file is its format.
  std::optional<std::string> read_file_key() {
    std::optional<std::string> name;
    for (std::size_t i = 0; i < supplement_keys.size(); ++i) {
      const char* key = supplement_keys[i];
      if (root_.table().find(key) == nullptr) continue;
      const auto given = root_.required_string(key, "name the robot's file, relative to this one");
      if (!key_.empty()) {
        findings_.error(root_.find_where(key),
                        fmt::format("the description stands on two files, '{}' and '{}'", key_, key),
                        "name one");
        continue;
      }
      name = given;
      key_ = key;
      format_ = static_cast<RobotFormat>(i);
    }
    return name;
  }

  /// First look, at a model that is thrown away: parameters, bodies that are added, what is coupled. They
  /// decide the inputs of the tape, which the robot's reader makes.
  void look_at_parts() {
    Model first = read_robot(robot_file_, options_, {}, format_);
    for (const Coordinate& c : first.coordinates) file_coordinates_.push_back(c.name);
    file_bodies_ = first.bodies.size();
    Model with_parameters;
    Reading parameter_reading(with_parameters, findings_);
    read_parameters(root_, parameter_reading);
    for (Parameter& p : with_parameters.parameters) {
      if (std::ranges::find(first.parameters, p.name, &Parameter::name) != first.parameters.end())
        findings_.error(p.where, fmt::format("the robot's file has an inertial figure '{}' already", p.name),
                        "choose another name");
      if (const auto value = overrides_.find(p.name); value != overrides_.end()) p.value = value->second;
    }
    supplement_.parameters = with_parameters.parameters;
    first.parameters.insert(first.parameters.begin(), supplement_.parameters.begin(),
                            supplement_.parameters.end());

    Reading reading(first, findings_);
    outline_ = read_outline(root_, reading);
    findings_.throw_if_any();
    for (const CouplingOutline& c : outline_.couplings) {
      if (std::ranges::find(file_coordinates_, c.coordinate) != file_coordinates_.end())
        supplement_.coupled.push_back(c.coordinate);
    }
    const auto own = static_cast<std::ptrdiff_t>(file_coordinates_.size());
    supplement_.coordinates.assign(first.coordinates.begin() + own, first.coordinates.end());
    const int gone = static_cast<int>(supplement_.coupled.size());
    for (BodyOutline& body : outline_.bodies) {
      if (body.coordinate >= 0) body.coordinate -= gone;
      if (body.beam) body.beam->first_coordinate -= gone;
      if (body.modal) body.modal->first_coordinate -= gone;
    }
    added_bodies_.assign(first.bodies.begin() + static_cast<std::ptrdiff_t>(file_bodies_),
                         first.bodies.end());
  }

  void adopt_header(Model& model) {
    model.file = std::filesystem::path(file_name_).filename().string();
    model.sha256 = sha256_of(std::string(text_) + model.sha256);  // of both files
    for (Parameter& p : model.parameters) {
      if (const auto value = overrides_.find(p.name); value != overrides_.end()) p.value = value->second;
    }
    Reading reading(model, findings_);
    if (const Value* name = root_.optional("name", Value::Kind::string))
      model.name = reading.new_name(*name, "the model");
    model.title = root_.optional_string("title").value_or(model.title);
    if (const auto group = root_.optional_choice("group", group_names()))
      model.group = static_cast<GroupKind>(*group);
  }

  void append_bodies(Model& model) {
    for (BodyDescription& body : added_bodies_) model.bodies.push_back(std::move(body));
  }

  void fill(Model& model, Reading& reading) {
    if (root_.table().find("gravity") != nullptr) read_gravity(root_, reading);
    for (std::size_t i = 0; i < outline_.bodies.size(); ++i) {
      BodyOutline& body = outline_.bodies[i];
      BodyDescription& described = model.bodies[file_bodies_ + i];
      const int parent = described.parent - static_cast<int>(file_bodies_);
      read_station(body, described, parent < 0 ? nullptr : &outline_.bodies[static_cast<std::size_t>(parent)],
                   reading);
      read_pose(body, described, reading);
      read_joint(body, described, reading);
      read_inertia(body, described, reading);
      read_beam(body, described, reading);
      read_modal_body(body, described, reading);
      body.table.report_unknown_keys();
    }
    read_joints(model, reading);
    read_energies(root_, reading);
    read_constraints(root_, reading);
    read_forces(root_, reading);
    read_fluids(root_, outline_, static_cast<int>(file_bodies_), reading);
    read_free_velocities(root_, reading);
  }

  /// [[joint]]: what the robot's file does not say of one of its joints.
  void read_joints(Model& model, Reading& reading) {
    std::vector<std::string> known, seen;
    for (std::size_t k = 0; k < file_bodies_; ++k) {
      const std::string& name = model.bodies[k].joint.coordinate;
      if (!name.empty() && std::ranges::find(known, name) == known.end()) known.push_back(name);
    }
    for (const Value* table : tables_of(root_, "joint", findings_)) {
      TableReader joint(*table, "a joint", findings_);
      const Value* name =
          joint.required("name", Value::Kind::string, "name one of the joints of the robot's file");
      if (name == nullptr) continue;
      if (std::ranges::find(known, name->text) == known.end()) {
        findings_.error(name->where, fmt::format("'{}' is not a joint that moves a coordinate", name->text),
                        did_you_mean(name->text, known, fmt::format("there are {}", listed(known))));
        continue;
      }
      if (std::ranges::find(seen, name->text) != seen.end()) {
        findings_.error(name->where, fmt::format("joint '{}' stands here twice", name->text),
                        "write its keys in one table");
        continue;
      }
      seen.push_back(name->text);
      joint = TableReader(*table, fmt::format("joint '{}'", name->text), findings_);
      joint.optional("name");
      const int coordinate = coordinate_index(model, name->text);
      const auto body = std::ranges::find_if(model.bodies, [&](const BodyDescription& b) {
        return b.joint.coordinate == name->text &&  // of all that follow it, the joint itself
               (coordinate < 0 || b.joint.displacement.id(*model.tape) ==
                                      model.symbols.r[static_cast<std::size_t>(coordinate)]);
      });
      read_joint_supplement(joint, *body, coordinate, reading);
      joint.report_unknown_keys();
    }
  }

  Findings findings_;
  TableReader root_;
  std::string_view text_;
  std::string file_name_;
  const ParameterValues& overrides_;
  std::string key_;  // urdf, sdf or mjcf
  RobotFormat format_ = RobotFormat::urdf;
  std::filesystem::path robot_file_;
  RobotOptions options_;
  RobotSupplement supplement_;
  Outline outline_;
  std::vector<std::string> file_coordinates_;
  std::size_t file_bodies_ = 0;
  std::vector<BodyDescription> added_bodies_;
};

}  // namespace

Model read_supplemented_robot(const Value& document, std::string_view text, const std::string& file_name,
                              const ParameterValues& overrides) {
  return SupplementReader(document, text, file_name, overrides).run();
}

}  // namespace anholon
