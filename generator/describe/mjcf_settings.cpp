// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/mjcf_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"

namespace anholon {

void MjcfSettings::read_settings() {
  const XMLElement& root = source_.root();
  each(root, "compiler", [&](const XMLElement& e) { read_compiler(e); });
  each(root, "option", [&](const XMLElement& e) { read_option(e); });
  each(root, "default", [&](const XMLElement& e) {
    check_default(e);
    classes_.read(e, "", source_, findings_);
  });
}

Exact MjcfSettings::number(const MjcfAttributes& a, const std::string& name, const std::string& what,
                           const Exact& otherwise) {
  const auto given = a.find(name);
  if (given == a.end()) return otherwise;
  const auto v = numbers_in(given->second.where, name, given->second.text, what, 1);
  return v ? v->front() : otherwise;
}
ExactVector MjcfSettings::vector(const MjcfAttributes& a, const std::string& name, const std::string& what,
                                 const ExactVector& otherwise) {
  const auto given = a.find(name);
  if (given == a.end()) return otherwise;
  const auto v = numbers_in(given->second.where, name, given->second.text, what, 3);
  return v ? ExactVector{(*v)[0], (*v)[1], (*v)[2]} : otherwise;
}
std::string MjcfSettings::word(const MjcfAttributes& a, const std::string& name, const Names& words,
                               const std::string& what, const std::string& otherwise) {
  const auto given = a.find(name);
  if (given == a.end()) return otherwise;
  if (std::ranges::find(words, given->second.text) != words.end()) return given->second.text;
  error(given->second.where, fmt::format("{} of {} is '{}'", name, what, given->second.text),
        did_you_mean(given->second.text, words, fmt::format("known are {}", listed(words))));
  return otherwise;
}
void MjcfSettings::must_be(const MjcfAttributes& a, const std::string& name, const std::string& value,
                           const std::string& what, const std::string& way) {
  const auto given = a.find(name);
  if (given != a.end() && given->second.text != value)
    error(given->second.where,
          fmt::format("{} of {} is '{}', which is not supported", name, what, given->second.text), way);
}
void MjcfSettings::must_be_zero(const MjcfAttributes& a, const std::string& name, const std::string& what,
                                const std::string& way, std::size_t count) {
  const auto given = a.find(name);
  if (given == a.end()) return;
  const auto v = numbers_in(given->second.where, name, given->second.text, what, count);
  if (v && !std::ranges::all_of(*v, [](const Exact& x) { return x.is_zero(); }))
    error(given->second.where,
          fmt::format("{} of {} is {}, which is not supported", name, what, given->second.text), way);
}

void MjcfSettings::read_compiler(const XMLElement& e) {
  const std::string what = "the compiler";
  check_attributes(e, what,
                   {"angle", "eulerseq", "autolimits", "coordinate", "inertiafromgeom", "balanceinertia",
                    "inertiagrouprange", "boundmass", "boundinertia", "settotalmass"},
                   {"strippath", "meshdir", "texturedir", "assetdir", "discardvisual", "usethread",
                    "fusestatic", "convexhull", "exactmeshinertia", "alignfree", "saveinertial", "fitaabb"});
  check_children(e, what, {}, {"lengthrange"});
  const MjcfAttributes a = merged({}, e, source_);
  degrees_ = word(a, "angle", {"degree", "radian"}, what, degrees_ ? "degree" : "radian") == "degree";
  word(a, "autolimits", {"true", "false"}, what, "true");
  must_be(a, "coordinate", "local", what, "write poses in the frame of the parent");
  must_be(a, "balanceinertia", "false", what, "write the figures that are meant");
  if (const auto given = a.find("inertiafromgeom"); given != a.end() && given->second.text == "true")
    error(given->second.where, "the compiler takes all inertias from geoms",
          "remove it, and every <inertial> that is not meant");
  must_be(a, "inertiagrouprange", "0 5", what,
          "write <inertial> for the bodies that have geoms of other groups");
  for (const char* name : {"boundmass", "boundinertia"})
    must_be_zero(a, name, what, "write the figures that are meant");
  if (const auto given = a.find("settotalmass");
      given != a.end() && number(a, "settotalmass", what, -1) > Exact(0))
    error(given->second.where, "the compiler scales all masses", "write the figures that are meant");
  if (const auto given = a.find("eulerseq"); given != a.end()) read_euler_order(given->second);
}

void MjcfSettings::read_euler_order(const MjcfValue& value) {
  const std::string& order = value.text;
  const bool good = order.size() == 3 && std::ranges::all_of(order, [](char c) {
                      return std::string_view("xyzXYZ").find(c) != std::string_view::npos;
                    });
  const auto capitals = std::ranges::count_if(order, [](char c) { return c < 'a'; });
  if (!good || (capitals != 0 && capitals != 3)) {
    error(value.where, fmt::format("eulerseq of the compiler is '{}'", order),
          "write three of xyz, for turned axes, or three of XYZ, for axes that stay");
    return;
  }
  for (std::size_t i = 0; i < 3; ++i)
    euler_axes_[i] = static_cast<std::size_t>(order[i] - (capitals > 0 ? 'X' : 'x'));
  fixed_axes_ = capitals > 0;
}

void MjcfSettings::read_option(const XMLElement& e) {
  const std::string what = "the option";
  check_attributes(e, what, {"gravity", "density", "viscosity"},
                   {"timestep",
                    "apirate",
                    "impratio",
                    "wind",
                    "magnetic",
                    "o_margin",
                    "o_solref",
                    "o_solimp",
                    "o_friction",
                    "integrator",
                    "cone",
                    "jacobian",
                    "solver",
                    "iterations",
                    "tolerance",
                    "ls_iterations",
                    "ls_tolerance",
                    "noslip_iterations",
                    "noslip_tolerance",
                    "mpr_iterations",
                    "mpr_tolerance",
                    "ccd_iterations",
                    "ccd_tolerance",
                    "sdf_iterations",
                    "sdf_initpoints",
                    "actuatorgroupdisable",
                    "collision"});
  check_children(e, what, {"flag"});
  const MjcfAttributes a = merged({}, e, source_);
  gravity_ = vector(a, "gravity", what, gravity_);
  for (const char* name : {"density", "viscosity"})
    must_be_zero(a, name, what, "remove it; forces of a fluid are written as [[force]] in a side-car file");
  if (const XMLElement* flags = e.FirstChildElement("flag")) {
    const MjcfAttributes f = merged({}, *flags, source_);
    for (const auto& [name, value] : f) {
      const bool acts = name == "gravity" || name == "passive" || name == "frictionloss" ||
                        name == "equality" || name == "spring" || name == "damper";
      if (acts && value.text == "disable")
        error(value.where, fmt::format("the flag '{}' switches off what the bodies say", name),
              "remove it, and what it switches off");
    }
    leave_out("<flag>");
  }
}

void MjcfSettings::check_default(const XMLElement& e) {
  const std::string what = "a <default>";
  check_attributes(e, what, {"class"});
  check_children(e, what, {"default", "joint", "geom", "tendon"},
                 {"mesh", "material", "site", "camera", "light", "pair", "equality", "general", "motor",
                  "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion", "flex"},
                 true);
  each(e, "joint",
       [&](const XMLElement& joint) { check_joint_attributes(joint, "the <joint> of a <default>"); });
  each(e, "tendon", [&](const XMLElement& tendon) { check_tendon(tendon); });
  each(e, "default", [&](const XMLElement& inner) { check_default(inner); });
}

void MjcfSettings::check_class(const MjcfValue& value) {
  if (!classes_.has(value.text))
    error(value.where, fmt::format("there is no class '{}'", value.text),
          did_you_mean(value.text, classes_.names(), "write a <default> of this class"));
}

MjcfAttributes MjcfSettings::with_defaults(const XMLElement& e, const std::string& childclass) {
  std::string name = childclass;
  if (const char* own = e.Attribute("class")) {
    check_class({own, source_.place(e, "class")});
    name = own;
  }
  const bool is_known = name.empty() || classes_.has(name);
  return merged(is_known ? classes_.defaults(name, e.Name()) : MjcfAttributes{}, e, source_);
}

void MjcfSettings::check_joint_attributes(const XMLElement& e, const std::string& what) {
  check_attributes(e, what,
                   {"name", "class", "type", "pos", "axis", "limited", "range", "ref", "springref",
                    "stiffness", "damping", "armature", "frictionloss", "springdamper"},
                   {"group", "margin", "solreflimit", "solimplimit", "solreffriction", "solimpfriction",
                    "user", "actuatorfrcrange", "actuatorfrclimited", "actuatorgravcomp"});
  check_children(e, what, {});
}

void MjcfSettings::check_tendon(const XMLElement& e) {
  const MjcfAttributes a = merged({}, e, source_);
  for (const char* figure : {"stiffness", "damping", "frictionloss", "armature"})
    must_be_zero(a, figure, "a tendon", "write its force as [[force]] or potential in a side-car file");
}

Exact MjcfSettings::radians(const Exact& angle) const {
  return degrees_ ? angle * Exact::pi() / Exact(180) : angle;
}

ExactPose MjcfSettings::read_pose(const MjcfAttributes& a, const std::string& what) {
  ExactPose pose;
  pose.p = vector(a, "pos", what, pose.p);
  std::string first;
  for (const char* name : {"quat", "axisangle", "xyaxes", "zaxis", "euler"}) {
    const auto given = a.find(name);
    if (given == a.end()) continue;
    if (!first.empty()) {
      error(given->second.where, fmt::format("{} has both '{}' and '{}'", what, first, name),
            "write one of them");
      continue;
    }
    first = name;
    pose.R = read_orientation(name, given->second, what);
  }
  return pose;
}

ExactMatrix MjcfSettings::read_orientation(const std::string& kind, const MjcfValue& value,
                                           const std::string& what) {
  const std::map<std::string, std::size_t> sizes = {
      {"quat", 4}, {"axisangle", 4}, {"xyaxes", 6}, {"zaxis", 3}, {"euler", 3}};
  const auto v = numbers_in(value.where, kind, value.text, what, sizes.at(kind));
  if (!v) return identity_matrix();
  const auto& n = *v;
  const auto is_zero = [&](std::size_t from, std::size_t to) {
    return std::all_of(n.begin() + static_cast<std::ptrdiff_t>(from),
                       n.begin() + static_cast<std::ptrdiff_t>(to),
                       [](const Exact& x) { return x.is_zero(); });
  };
  const auto reject = [&](const char* fact) {
    error(value.where, fmt::format("{} of {} {}", kind, what, fact), "write a direction that is one");
    return identity_matrix();
  };
  if (kind == "quat") {
    if (is_zero(0, 4)) return reject("is zero");
    return orientations_.quaternion({n[0], n[1], n[2], n[3]}, what);
  }
  if (kind == "axisangle") {
    if (is_zero(0, 3)) return reject("has a zero axis");
    return orientations_.axis_angle({n[0], n[1], n[2]}, radians(n[3]), what);
  }
  if (kind == "xyaxes") {
    const bool parallel = (n[1] * n[5] - n[2] * n[4]).is_zero() && (n[2] * n[3] - n[0] * n[5]).is_zero() &&
                          (n[0] * n[4] - n[1] * n[3]).is_zero();
    if (parallel) return reject("has parallel axes");
    return orientations_.x_and_y({n[0], n[1], n[2]}, {n[3], n[4], n[5]}, what);
  }
  if (kind == "zaxis") {
    if (is_zero(0, 3)) return reject("is zero");
    return orientations_.z_axis({n[0], n[1], n[2]}, what);
  }
  ExactVector angles = {radians(n[0]), radians(n[1]), radians(n[2])};
  std::array<std::size_t, 3> axes = euler_axes_;
  if (fixed_axes_)
    std::swap(angles[0], angles[2]), std::swap(axes[0], axes[2]);  // turned axes, from the last
  return orientations_.euler(axes, angles, what);
}

}  // namespace anholon
