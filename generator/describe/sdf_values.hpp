// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The values of SDFormat's elements: flags, numbers, poses and inertials.

#include "describe/orientations.hpp"
#include "describe/robot_file.hpp"
#include "describe/xml_reader.hpp"

namespace anholon {

class SdfValues : protected XmlReader {
 protected:
  SdfValues(const XmlSource& source, bool snap) : XmlReader(source), orientations_(snap) {}

  bool flag(const XMLElement& e, const std::string& what);
  /// The number that an element, or a child of it (else zero), holds.
  Exact number_of(const XMLElement& e, const char* label, const std::string& what);
  Exact number_in_child(const XMLElement& e, const char* name, const std::string& what);
  /// @param frame  takes the name of the frame that the pose is given in, where the file names one; null: it
  /// must not
  ExactPose read_pose(const XMLElement* e, const std::string& of, std::string* frame);
  RobotInertial read_inertial(const XMLElement& e, const std::string& link);

  Orientations orientations_;
  bool named_frames_ = false;  // version 1.7 and later: poses and axes name the frame that they are given in

 private:
  /// One of several words; the first of them where there is none.
  std::string choice(const XMLElement& e, const char* attribute, const Names& words, const std::string& what);
};

}  // namespace anholon
