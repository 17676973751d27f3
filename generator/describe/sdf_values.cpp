// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/sdf_values.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"

namespace anholon {

bool SdfValues::flag(const XMLElement& e, const std::string& what) {
  const std::string value = text(e, what);
  if (value == "1" || value == "true") return true;
  if (value != "0" && value != "false")
    error(source_.place(e), fmt::format("{} is '{}'", what, value), "write true or false");
  return false;
}

ExactPose SdfValues::read_pose(const XMLElement* e, const std::string& of, std::string* frame) {
  ExactPose pose;
  if (e == nullptr) return pose;
  const std::string what = fmt::format("the pose of {}", of);
  Names attributes = {"degrees", "rotation_format"};
  if (named_frames_ && frame != nullptr) attributes.emplace_back("relative_to");
  const std::string numbers = text(*e, what, attributes);
  if (const char* in = e->Attribute("relative_to"); in != nullptr && *in != '\0' && frame != nullptr)
    *frame = in;
  if (numbers.empty()) return pose;
  const std::string format = choice(*e, "rotation_format", {"euler_rpy", "quat_xyzw"}, what);
  const bool degrees = choice(*e, "degrees", {"false", "true", "0", "1"}, what).find_first_of("t1") == 0;
  const bool is_quaternion = format == "quat_xyzw";
  const auto v = numbers_in(source_.place(*e), "the pose", numbers, of, is_quaternion ? 7 : 6);
  if (!v) return pose;
  pose.p = {(*v)[0], (*v)[1], (*v)[2]};
  if (!is_quaternion) {
    const Exact unit = degrees ? Exact::pi() / Exact(180) : Exact(1);
    pose.R = orientations_.rpy({unit * (*v)[3], unit * (*v)[4], unit * (*v)[5]}, of);
  } else if (std::all_of(v->begin() + 3, v->end(), [](const Exact& x) { return x.is_zero(); })) {
    error(source_.place(*e), fmt::format("the quaternion of {} is zero", what), "write 0 0 0 1 for no turn");
  } else {
    pose.R = orientations_.quaternion({(*v)[6], (*v)[3], (*v)[4], (*v)[5]}, of);
  }
  return pose;
}

std::string SdfValues::choice(const XMLElement& e, const char* attribute, const Names& words,
                              const std::string& what) {
  const char* value = e.Attribute(attribute);
  if (value == nullptr) return words.front();
  if (std::ranges::find(words, value) == words.end())
    error(source_.place(e, attribute), fmt::format("{} of {} is '{}'", attribute, what, value),
          fmt::format("known are {}", listed(words)));
  return value;
}

RobotInertial SdfValues::read_inertial(const XMLElement& e, const std::string& link) {
  RobotInertial result;
  result.where = source_.place(e);
  const std::string what = fmt::format("the inertial of {}", link);
  check_attributes(e, what, {});
  const std::string way = "write <mass> and <inertia>";
  check_children(e, what, {"pose", "mass", "inertia"}, {}, false,
                 {{"density", way}, {"auto_inertia_params", way}, {"fluid_added_mass", "remove it"}});
  result.pose = read_pose(e.FirstChildElement("pose"), what, nullptr);
  if (const XMLElement* mass = e.FirstChildElement("mass")) {
    result.mass = number_of(*mass, "mass", what);
    check_mass(result.mass, source_.place(*mass), link);
  } else {
    error(result.where, fmt::format("{} has no <mass>", what), "write <mass>...</mass>, in kg");
  }
  if (const XMLElement* inertia = e.FirstChildElement("inertia")) {
    const std::string tensor = fmt::format("the inertia of {}", link);
    check_attributes(*inertia, tensor, {});
    constexpr std::array<const char*, 6> entries = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    check_children(*inertia, tensor, {entries.begin(), entries.end()});
    for (std::size_t i = 0; i < 6; ++i) {
      const XMLElement* entry = inertia->FirstChildElement(entries[i]);
      if (entry != nullptr)
        result.inertia[i] = number_of(*entry, entries[i], tensor);
      else if (i < 3)
        error(source_.place(*inertia), fmt::format("{} has no <{}>", tensor, entries[i]),
              "write <ixx>, <iyy> and <izz>; the others are zero where they are missing");
    }
    check_definite(result.inertia, source_.place(*inertia), tensor, "ixx ixy ixz iyy iyz izz");
  } else {
    error(result.where, fmt::format("{} has no <inertia>", what),
          "write <inertia><ixx>...</ixx> ...</inertia>");
  }
  return result;
}

Exact SdfValues::number_of(const XMLElement& e, const char* label, const std::string& what) {
  const auto v = numbers_in(source_.place(e), label, text(e, what), what, 1);
  return v ? v->front() : Exact(0);
}

Exact SdfValues::number_in_child(const XMLElement& e, const char* name, const std::string& what) {
  const XMLElement* child = e.FirstChildElement(name);
  return child == nullptr ? Exact(0) : number_of(*child, name, what);
}

}  // namespace anholon
