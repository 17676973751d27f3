// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/sdf_frames.hpp"

#include <fmt/format.h>

#include "describe/names.hpp"

namespace anholon {

void SdfFrames::add(const std::string& name, const std::string& in, const ExactPose& pose,
                    const Location& where) {
  const auto [found, is_new] = frames_.try_emplace(name, Frame{in, pose, where});
  if (!is_new)
    findings_.error(where, fmt::format("there is a second frame '{}'", name),
                    "links, joints and frames share their names with the format's own; rename one");
}

std::vector<std::string> SdfFrames::names() const {
  std::vector<std::string> result;
  for (const auto& [name, frame] : frames_) result.push_back(name);
  return result;
}

void SdfFrames::check() {
  for (const auto& [name, frame] : frames_) {
    if (name != world_frame && !has(frame.in))
      findings_.error(frame.where,
                      fmt::format("'{}' is posed in a frame '{}' that does not exist", name, frame.in),
                      did_you_mean(frame.in, names(), fmt::format("there are {}", listed(names()))));
  }
  if (!findings_.empty()) return;
  for (const auto& [name, frame] : frames_) {
    std::size_t steps = 0;
    for (std::string at = name; at != world_frame && steps <= frames_.size(); ++steps) at = frames_.at(at).in;
    if (steps <= frames_.size()) continue;
    findings_.error(frame.where, fmt::format("'{}' is posed in itself in the end", name),
                    "let one frame of the circle be posed in the model");
    return;
  }
}

std::vector<std::string> SdfFrames::way_up(const std::string& b) const {
  std::vector<std::string> way = {b};
  while (way.back() != world_frame) way.push_back(frames_.at(way.back()).in);
  return way;
}

ExactPose SdfFrames::between(const std::string& a, const std::string& b) const {
  std::vector<std::string> from = way_up(a), to = way_up(b);
  while (!from.empty() && !to.empty() && from.back() == to.back()) from.pop_back(), to.pop_back();
  const auto along = [&](const std::vector<std::string>& way) {
    ExactPose pose;
    for (std::size_t i = way.size(); i-- > 0;) pose = compose(pose, frames_.at(way[i]).pose);
    return pose;
  };
  return compose(inverse(along(from)), along(to));
}

}  // namespace anholon
