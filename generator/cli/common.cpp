// SPDX-License-Identifier: GPL-2.0-or-later
#include "cli/common.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "describe/function_names.hpp"
#include "describe/read_model.hpp"
#include "describe/scene.hpp"
#include "describe/specialise.hpp"
#include "emit/write_file.hpp"

namespace anholon::cli {

namespace {

bool named(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// Options that only a robot file has.
RobotOptions robot_options(const ModelOptions& options) {
  RobotOptions robot = options.robot;
  if (options.gravity.empty()) return robot;
  try {
    robot.gravity = Exact::from_decimal(options.gravity);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(
        fmt::format("--gravity is '{}', not a decimal number in m/s^2", options.gravity));
  }
  return robot;
}

/// --count N=12 as numbers by name.
CountValues counts_of(const ModelOptions& options) {
  CountValues counts;
  for (const std::string& text : options.counts) {
    const std::size_t equals = text.find('=');
    int number = 0;
    const char* end = text.data() + text.size();
    const char* begin = equals == std::string::npos ? end : text.data() + equals + 1;
    const auto [rest, error] = std::from_chars(begin, end, number);
    if (error != std::errc() || rest != end)
      throw std::invalid_argument(fmt::format("--count is '{}', not NAME=NUMBER", text));
    counts[text.substr(0, equals)] = number;
  }
  return counts;
}

}  // namespace

std::string scene_file(const ModelOptions& options) {
  if (!options.scene.empty()) return options.scene;
  return !is_robot_file(options.model) && is_scene(options.model) ? options.model : "";
}

Scene load_scene(const ModelOptions& options) {
  if (!options.counts.empty())
    throw std::invalid_argument("--count is for a model file; a scene says it itself: counts = { N = 12 }");
  Scene scene = read_scene(scene_file(options));
  if (!options.scene.empty() &&
      std::filesystem::weakly_canonical(options.model) != std::filesystem::weakly_canonical(scene.model_file))
    throw ModelError(
        scene.where,
        fmt::format("the scene is one of '{}', not of '{}'", scene.model_file.string(), options.model),
        "name that model, or the scene alone");
  if (options.contacts.empty()) return scene;
  if (std::ranges::find(scene.contact_sets, options.contacts, &ContactSet::name) == scene.contact_sets.end())
    throw std::invalid_argument(
        fmt::format("--contacts: the scene has no contact set '{}'", options.contacts));
  scene.contact_set = options.contacts;
  return scene;
}

Model load_model(const ModelOptions& options) {
  const bool has_robot_option = options.robot.floating || options.robot.as_written ||
                                options.robot.symbolic_inertia || !options.gravity.empty() || !options.search;
  const bool has_scene = !scene_file(options).empty();
  if (is_robot_file(options.model) && !has_scene) {
    if (!options.counts.empty()) throw std::invalid_argument("--count is for a model file");
    if (!options.contacts.empty())
      throw std::invalid_argument("--contacts: contact sets are those of a scene");
    return read_robot(options.model, robot_options(options));
  }
  if (has_robot_option)
    throw std::invalid_argument(
        "--floating, --as-written, --symbolic-inertia, --gravity and --no-search are for a robot file (URDF, "
        "SDFormat, MJCF) without a scene; a model file says these things itself (docs/robot-files.md)");
  if (has_scene) {
    const Scene scene = load_scene(options);
    return specialise(scene.model, scene);
  }
  if (!options.contacts.empty()) throw std::invalid_argument("--contacts: contact sets are those of a scene");
  return read_model(options.model, {}, counts_of(options));
}

bool wants_tree(const ModelOptions& options, const Model& model) {
  const auto only_in = [&](const std::vector<std::string>& these, const std::vector<std::string>& others) {
    return std::ranges::any_of(options.functions, [&](const std::string& name) {
      return named(these, name) && !named(others, name);
    });
  };
  if (!options.scene.empty() || !is_driven_tree(model)) return false;
  return is_robot_file(options.model) ? !only_in(function_names(), tree_function_names())
                                      : only_in(tree_function_names(), function_names());
}

TreeRequest tree_request(const ModelOptions& options) {
  TreeRequest request;
  request.search = options.search;
  request.optimise = optimise_for(options.optimise);
  request.functions = options.functions;
  if (named(request.functions, "all")) request.functions = tree_function_names();
  return request;
}

AnyDerivation derive_any(const ModelOptions& options, const Model& model, bool trace) {
  AnyDerivation result;
  if (wants_tree(options, model)) {
    TreeRequest request = tree_request(options);
    request.trace = trace;
    result.tree = derive_tree(model, request);
  } else {
    DeriveRequest request = derive_request(options, model);
    request.trace = trace;
    result.reduction = derive(model, request);
  }
  return result;
}

DeriveRequest derive_request(const ModelOptions& options, const Model& model) {
  DeriveRequest request;
  request.functions = options.functions;
  if (named(request.functions, "all")) request.functions.clear();
  request.optimise = optimise_for(options.optimise);
  if (!scene_file(options).empty()) {
    const Scene scene = load_scene(options);
    request.scene = program_name(scene);
    request.torque_driven = {scene.torque_driven.begin(), scene.torque_driven.end()};
    if (request.functions.empty()) request.functions = scene.functions;
    request.state_jacobian = request.functions.empty() && may_be_stiff(scene.integrator);
  }
  const std::string prefix = "leading:";
  if (options.inverse == "pseudo") return request;
  if (!options.inverse.starts_with(prefix))
    throw std::invalid_argument(
        fmt::format("--inverse is '{}', not pseudo or leading:ROWS", options.inverse));
  request.inverse = Inverse::leading;
  const char* at = options.inverse.data() + prefix.size();
  const char* end = options.inverse.data() + options.inverse.size();
  const int rows = static_cast<int>(model.rows.size());
  if (rows == 0)
    throw std::invalid_argument("--inverse leading: the model has no constraint rows; leave the option out");
  if (at == end) throw std::invalid_argument("--inverse leading: name rows, for example leading:1");
  while (at < end) {
    int row = 0;
    const auto [next, error] = std::from_chars(at, end, row);
    if (error != std::errc() || row < 1 || row > rows)
      throw std::invalid_argument(
          fmt::format("--inverse leading: rows are whole numbers from 1 to {}", rows));
    request.leading_rows.push_back(row - 1);
    at = next < end ? next + 1 : next;
    if (next < end && (*next != ',' || at == end))
      throw std::invalid_argument("--inverse leading: separate rows by commas");
  }
  return request;
}

void write_output(const std::string& path, const std::string& text) {
  if (path.empty()) {
    fmt::print("{}", text);
  } else {
    write_file(path, text);
  }
}

}  // namespace anholon::cli
