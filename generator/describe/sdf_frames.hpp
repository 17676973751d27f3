// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The frames of an SDFormat model: the world, the model's own, and those of links, joints and <frame>s, each
// posed in another one by the file.

#include <map>
#include <string>
#include <vector>

#include "describe/exact_rotation.hpp"
#include "describe/findings.hpp"

namespace anholon {

inline constexpr const char* world_frame = "world";
inline constexpr const char* model_frame = "__model__";

class SdfFrames {
 public:
  explicit SdfFrames(Findings& findings) : findings_(findings) { frames_[world_frame]; }

  /// @param in  the frame that the pose is given in; @param where  of that name, for messages
  void add(const std::string& name, const std::string& in, const ExactPose& pose, const Location& where);
  [[nodiscard]] bool has(const std::string& name) const { return frames_.contains(name); }
  [[nodiscard]] std::vector<std::string> names() const;
  /// Errors for frames that do not exist, and for those that are posed in themselves in the end.
  void check();
  /// The frame b in the frame a, both known. What they have in common on the way to the world is left out, so
  /// that poses which the file writes between two frames stay as they are.
  [[nodiscard]] ExactPose between(const std::string& a, const std::string& b) const;

 private:
  struct Frame {
    std::string in;
    ExactPose pose;
    Location where;
  };
  /// b and the frames that it is posed in, up to the world.
  [[nodiscard]] std::vector<std::string> way_up(const std::string& b) const;

  Findings& findings_;
  std::map<std::string, Frame> frames_;
};

}  // namespace anholon
