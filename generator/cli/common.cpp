// SPDX-License-Identifier: GPL-2.0-or-later
#include "cli/common.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "describe/read_model.hpp"
#include "describe/scene.hpp"
#include "describe/specialise.hpp"
#include "emit/write_file.hpp"

namespace anholon::cli {

Model load_model(const ModelOptions& options) {
  if (!options.scene.empty()) {
    const Scene scene = read_scene(options.scene);
    return specialise(scene.model, scene);
  }
  if (is_scene(options.model)) {
    const Scene scene = read_scene(options.model);
    return specialise(scene.model, scene);
  }
  return read_model(options.model);
}

DeriveRequest derive_request(const ModelOptions& options, const Model& model) {
  DeriveRequest request;
  request.functions = options.functions;
  const std::string scene_file = !options.scene.empty()    ? options.scene
                                 : is_scene(options.model) ? options.model
                                                           : "";
  if (!scene_file.empty()) {
    const Scene scene = read_scene(scene_file);
    request.scene = scene.name;
    request.torque_driven = {scene.torque_driven.begin(), scene.torque_driven.end()};
    if (request.functions.empty()) request.functions = scene.functions;
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
    at = next < end && *next == ',' ? next + 1 : next;
    if (at == next && next < end) throw std::invalid_argument("--inverse leading: separate rows by commas");
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
