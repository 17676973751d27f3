// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/mjcf_inertials.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace anholon {
namespace {

constexpr const char* write_inertial = "write <inertial pos=\"...\" mass=\"...\" fullinertia=\"...\"/>";
constexpr std::array<const char*, 5> orientations = {"quat", "axisangle", "xyaxes", "zaxis", "euler"};

}  // namespace

std::optional<RobotInertial> MjcfInertials::read_inertial(const XMLElement& body, const std::string& what,
                                                          const std::string& childclass,
                                                          std::vector<std::string>& notes) {
  const XMLElement* e = body.FirstChildElement("inertial");
  if (e == nullptr) return from_geoms(body, what, childclass, notes);
  if (const XMLElement* second = e->NextSiblingElement("inertial"))
    error(source_.place(*second), fmt::format("{} has a second <inertial>", what), "remove one of them");
  each(body, "geom", [&](const XMLElement&) { leave_out("<geom>"); });
  return read_figures(*e, what);
}

RobotInertial MjcfInertials::read_figures(const XMLElement& e, const std::string& what) {
  const std::string of = fmt::format("the inertial of {}", what);
  check_attributes(
      e, of, {"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "mass", "diaginertia", "fullinertia"});
  check_children(e, of, {});
  const MjcfAttributes a = merged({}, e, source_);
  RobotInertial result;
  result.where = source_.place(e);
  for (const char* name : {"pos", "mass"}) {
    if (!a.contains(name)) error(result.where, fmt::format("{} has no '{}'", of, name), write_inertial);
  }
  result.pose = read_pose(a, of);
  result.mass = number(a, "mass", of, 0);
  check_mass(result.mass, source_.place(e, "mass"), what);
  const auto full = a.find("fullinertia"), diagonal = a.find("diaginertia");
  if ((full == a.end()) == (diagonal == a.end())) {
    const bool neither = full == a.end();
    error(result.where,
          fmt::format("{} has {} 'diaginertia' {} 'fullinertia'", of, neither ? "neither" : "both",
                      neither ? "nor" : "and"),
          "write one of them");
    return result;
  }
  const bool is_full = full != a.end();
  const MjcfValue& figures = is_full ? full->second : diagonal->second;
  const std::size_t count = is_full ? 6 : 3;
  if (const auto v =
          numbers_in(figures.where, is_full ? "fullinertia" : "diaginertia", figures.text, of, count))
    std::copy(v->begin(), v->end(), result.inertia.begin());
  check_definite(result.inertia, figures.where, fmt::format("the inertia of {}", what),
                 is_full ? "xx yy zz xy xz yz" : "xx yy zz");
  for (const char* turned : orientations) {
    if (const auto given = a.find(turned); is_full && given != a.end())
      error(given->second.where, fmt::format("{} has both 'fullinertia' and '{}'", of, turned),
            "write fullinertia in the axes of the body");
  }
  return result;
}

std::optional<RobotInertial> MjcfInertials::from_geoms(const XMLElement& body, const std::string& what,
                                                       const std::string& childclass,
                                                       std::vector<std::string>& notes) {
  std::vector<PlacedSolid> solids;
  each(body, "geom", [&](const XMLElement& e) {
    if (const auto solid = read_geom(e, what, childclass)) solids.push_back(*solid);
  });
  if (solids.empty()) return std::nullopt;
  notes.push_back(fmt::format("assumed: {} has no inertial: that of {} geom{}", what, solids.size(),
                              solids.size() == 1 ? "" : "s"));
  const BodyOfSolids sum = joined(solids);
  return RobotInertial{{identity_matrix(), sum.centre}, sum.mass, sum.inertia, source_.place(body)};
}

std::optional<PlacedSolid> MjcfInertials::read_geom(const XMLElement& e, const std::string& what,
                                                    const std::string& childclass) {
  const std::string of = fmt::format("a geom of {}", what);
  const Names looks_and_contacts = {"name",     "class",    "contype", "conaffinity", "condim", "group",
                                    "priority", "material", "rgba",    "friction",    "solmix", "solref",
                                    "solimp",   "margin",   "gap",     "user"};
  Names known = {"type", "size", "mass",      "density", "shellinertia", "fromto",
                 "pos",  "quat", "axisangle", "xyaxes",  "zaxis",        "euler"};
  known.insert(known.end(), looks_and_contacts.begin(), looks_and_contacts.end());
  known.insert(known.end(), {"mesh", "hfield", "fitscale", "fluidshape", "fluidcoef"});
  check_attributes(e, of, known);
  check_children(e, of, {});
  const MjcfAttributes a = with_defaults(e, childclass);
  must_be(a, "shellinertia", "false", of, write_inertial);
  const std::string type =
      word(a, "type", {"sphere", "capsule", "cylinder", "ellipsoid", "box", "mesh", "plane", "hfield"}, of,
           "sphere");
  const Exact mass = number(a, "mass", of, -1), density = number(a, "density", of, 1000);
  for (const char* name : {"mass", "density"}) {
    if (const auto given = a.find(name); given != a.end())
      check_not_negative(number(a, name, of, 0), given->second.where, name, of);
  }
  if (mass.is_zero() || (mass < Exact(0) && density.is_zero())) return std::nullopt;
  PlacedSolid placed;
  const auto solid = read_solid(type, a, of, source_.place(e), placed);
  if (!solid || !findings_.empty()) return std::nullopt;
  placed.solid = *solid;
  placed.mass = mass < Exact(0) ? density * solid->volume : mass;
  return placed;
}

/// @param placed  takes the pose
std::optional<Solid> MjcfInertials::read_solid(const std::string& type, const MjcfAttributes& a,
                                               const std::string& what, const Location& where,
                                               PlacedSolid& placed) {
  const bool is_long = type == "capsule" || type == "cylinder";
  const auto ends = a.find("fromto");
  if (type == "mesh" || type == "plane" || type == "hfield" || (ends != a.end() && !is_long)) {
    error(where,
          fmt::format("{} is a {}{}, and the body has no <inertial>", what, type,
                      ends == a.end() ? "" : " from end to end"),
          write_inertial);
    return std::nullopt;
  }
  placed.pose = read_pose(a, what);
  std::size_t count = type == "sphere" ? 1 : is_long ? 2 : 3;
  Exact half = 0;
  if (ends != a.end()) {
    const auto v = numbers_in(ends->second.where, "fromto", ends->second.text, what, 6);
    if (!v) return std::nullopt;
    const auto& n = *v;
    const ExactVector along = {n[0] - n[3], n[1] - n[4], n[2] - n[5]};
    const Exact square = along[0] * along[0] + along[1] * along[1] + along[2] * along[2];
    if (square.is_zero()) {
      error(ends->second.where, fmt::format("fromto of {} has no length", what), "write two different ends");
      return std::nullopt;
    }
    half = settled(sqrt(square)) / Exact(2);
    for (std::size_t i = 0; i < 3; ++i) placed.pose.p[i] = (n[i] + n[i + 3]) / Exact(2);
    placed.pose.R = orientations_.z_axis(along, what);
    count = 1;
  }
  const auto size = a.find("size");
  if (size == a.end()) {
    error(where, fmt::format("{} has no 'size'", what), "write its radius, or half its lengths");
    return std::nullopt;
  }
  // more sizes than the shape has are left over from a class
  const auto given = words(size->second.text);
  std::string first;
  for (std::size_t i = 0; i < std::min(count, given.size()); ++i) first += std::string(given[i]) + " ";
  const auto v = numbers_in(size->second.where, "size", first, what, count);
  if (!v) return std::nullopt;
  const auto& s = *v;
  if (std::ranges::any_of(s, [](const Exact& x) { return !(x > Exact(0)); })) {
    error(size->second.where, fmt::format("size of {} is {}", what, size->second.text), "sizes are positive");
    return std::nullopt;
  }
  if (count == 2) half = s[1];
  if (type == "sphere") return ball(s[0]);
  if (type == "box") return box({s[0], s[1], s[2]});
  if (type == "ellipsoid") return ellipsoid({s[0], s[1], s[2]});
  return type == "cylinder" ? cylinder(s[0], half) : capsule(s[0], half);
}

}  // namespace anholon
