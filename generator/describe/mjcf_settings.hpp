// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What holds for a whole MJCF file: units and conventions of <compiler>, gravity of <option>, the classes of
// <default>; and how attributes and orientations are read under it.

#include "describe/mjcf_classes.hpp"
#include "describe/orientations.hpp"
#include "describe/xml_reader.hpp"

namespace anholon {

class MjcfSettings : protected XmlReader {
 protected:
  MjcfSettings(const XmlSource& source, bool snap) : XmlReader(source), orientations_(snap) {}

  /// <compiler>, <option> and <default>, which bodies are read under.
  void read_settings();

  [[nodiscard]] Exact radians(const Exact& angle) const;
  ExactPose read_pose(const MjcfAttributes& a, const std::string& what);

  // Attributes of an element or of its class.
  Exact number(const MjcfAttributes& a, const std::string& name, const std::string& what,
               const Exact& otherwise);
  ExactVector vector(const MjcfAttributes& a, const std::string& name, const std::string& what,
                     const ExactVector& otherwise);
  std::string word(const MjcfAttributes& a, const std::string& name, const Names& words,
                   const std::string& what, const std::string& otherwise);
  /// Errors for values that are not supported. @param way  out
  void must_be(const MjcfAttributes& a, const std::string& name, const std::string& value,
               const std::string& what, const std::string& way);
  void must_be_zero(const MjcfAttributes& a, const std::string& name, const std::string& what,
                    const std::string& way, std::size_t count = 1);

  void check_class(const MjcfValue& value);
  /// The attributes of an element that stands in a body, with the defaults of its class or the body's.
  MjcfAttributes with_defaults(const XMLElement& e, const std::string& childclass);

  void check_joint_attributes(const XMLElement& e, const std::string& what);
  /// Tendons that have no spring and no damper of their own only carry the forces of actuators.
  void check_tendon(const XMLElement& e);

  template <class Read>
  static void each(const XMLElement& parent, const char* name, const Read& read) {
    for (const XMLElement* e = parent.FirstChildElement(name); e != nullptr; e = e->NextSiblingElement(name))
      read(*e);
  }

  Orientations orientations_;
  MjcfClasses classes_;
  ExactVector gravity_ = {0, 0, -Exact::from_decimal("9.81")};

 private:
  void read_compiler(const XMLElement& e);
  void read_euler_order(const MjcfValue& value);
  void read_option(const XMLElement& e);
  void check_default(const XMLElement& e);
  ExactMatrix read_orientation(const std::string& kind, const MjcfValue& value, const std::string& what);

  bool degrees_ = true;
  std::array<std::size_t, 3> euler_axes_ = {0, 1, 2};
  bool fixed_axes_ = false;
};

}  // namespace anholon
