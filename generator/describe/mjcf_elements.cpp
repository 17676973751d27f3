// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/mjcf_elements.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/mjcf_inertials.hpp"
#include "describe/names.hpp"

namespace anholon {
namespace {

constexpr const char* world = "world";

class MjcfElements : MjcfInertials {
 public:
  MjcfElements(const XmlSource& source, bool snap) : MjcfInertials(source, snap) {}

  RobotFile run() {
    const XMLElement& root = source_.root();
    check_attributes(root, "the file", {"model"});
    const char* name = root.Attribute("model");
    file_.name = name == nullptr ? "mujoco" : name;
    check_children(
        root, "the file", {"compiler", "option", "default", "worldbody", "equality", "tendon"},
        {"actuator", "sensor", "asset", "visual", "statistic", "size", "keyframe", "contact", "custom"}, true,
        {{"include", "write the parts into one file"},
         {"extension", "plugins act by code of their own; remove it"},
         {"deformable", "only rigid bodies are read"}});
    read_settings();
    findings_.throw_if_any();
    file_.gravity = gravity_;
    file_.base = RobotBase::fixed;
    file_.links.push_back({world, std::nullopt, true, source_.place(root)});
    each(root, "worldbody", [&](const XMLElement& e) { read_worldbody(e); });
    each(root, "equality", [&](const XMLElement& e) { read_equalities(e); });
    each(root, "tendon", [&](const XMLElement& e) { read_tendons(e); });
    if (file_.links.size() == 1 && findings_.empty())
      error(source_.place(root), "the file has no body", "write at least one <body> in <worldbody>");
    findings_.throw_if_any();
    Names notes = dropped();
    notes.insert(notes.end(), orientations_.notes().begin(), orientations_.notes().end());
    file_.notes.insert(file_.notes.begin(), notes.begin(), notes.end());
    return std::move(file_);
  }

 private:
  // ---- bodies ---------------------------------------------------------------------------------------------

  const std::vector<std::string> decorations_ = {"site", "camera", "light"};
  Refused refused_parts() const {
    return {{"include", "write the parts into one file"},
            {"composite", "only rigid bodies are read"},
            {"flexcomp", "only rigid bodies are read"},
            {"plugin", "plugins act by code of their own; remove it"},
            {"frame", "write its pose into the bodies that stand in it"},
            {"attach", "write the other model's bodies here"},
            {"replicate", "write the bodies one by one"}};
  }

  void read_worldbody(const XMLElement& e) {
    check_attributes(e, "the worldbody", {});
    check_children(e, "the worldbody", {"body", "geom"}, decorations_, true, refused_parts());
    each(e, "geom", [&](const XMLElement&) { leave_out("<geom>"); });
    each(e, "body", [&](const XMLElement& body) { read_body(body, world, ""); });
  }

  void read_body(const XMLElement& e, const std::string& parent, std::string childclass) {
    RobotLink link;
    link.where = source_.place(e);
    if (const char* name = e.Attribute("name"); name != nullptr && *name != '\0') {
      link.name = name;
    } else {
      link.name = fmt::format("body_{}", file_.links.size());
      file_.notes.push_back(
          fmt::format("named: the body in line {} is called {}", link.where.line, link.name));
    }
    const std::string what = fmt::format("body '{}'", link.name);
    check_attributes(
        e, what,
        {"name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "mocap", "gravcomp"},
        {"user", "sleep"});
    check_children(e, what, {"inertial", "joint", "freejoint", "body", "geom"}, decorations_, true,
                   refused_parts());
    const MjcfAttributes a = merged({}, e, source_);
    must_be(a, "mocap", "false", what, "only bodies that forces move are read");
    must_be_zero(a, "gravcomp", what, "remove it; a force against gravity is a [[force]] of a side-car file");
    if (const auto given = a.find("childclass"); given != a.end()) {
      childclass = given->second.text;
      check_class(given->second);
    }
    const ExactPose pose = read_pose(a, what);
    link.inertial = read_inertial(e, what, childclass, file_.notes);
    const std::string name = link.name;
    const Location where = link.where;
    file_.links.push_back(std::move(link));
    read_joints(e, parent, name, childclass, pose, where);
    each(e, "body", [&](const XMLElement& body) { read_body(body, name, childclass); });
  }

  // ---- joints ---------------------------------------------------------------------------------------------

  void read_joints(const XMLElement& body, const std::string& parent, const std::string& child,
                   const std::string& childclass, const ExactPose& pose, const Location& where) {
    std::vector<PlacedJoint> joints;
    int unnamed = 0;
    for (const XMLElement* e = body.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      const std::string_view kind = e->Name();
      if (kind != "joint" && kind != "freejoint") continue;
      PlacedJoint placed;
      RobotJoint& j = placed.joint;
      j.where = j.parent_where = j.child_where = source_.place(*e);
      if (const char* name = e->Attribute("name"); name != nullptr && *name != '\0') {
        j.name = name;
      } else {
        j.name = unnamed++ == 0 ? fmt::format("{}_joint", child) : fmt::format("{}_joint_{}", child, unnamed);
        file_.notes.push_back(fmt::format("named: the joint in line {} is called {}", j.where.line, j.name));
      }
      if (kind == "freejoint") {
        check_attributes(*e, fmt::format("joint '{}'", j.name), {"name"}, {"group", "align"});
        check_children(*e, fmt::format("joint '{}'", j.name), {});
        j.type = RobotJointType::floating;
      } else {
        read_joint(*e, childclass, placed);
      }
      joints.push_back(std::move(placed));
    }
    const auto is_free = [](const PlacedJoint& j) { return j.joint.type == RobotJointType::floating; };
    const auto free = std::ranges::find_if(joints, is_free);
    if (free != joints.end() && (joints.size() > 1 || parent != world)) {
      error(free->joint.where,
            fmt::format("body '{}' has a free joint and {}", child,
                        joints.size() > 1 ? "others" : "stands in another body"),
            "only a body right in the worldbody can have a free joint, and no other");
      return;
    }
    if (free != joints.end() && (pose.R != identity_matrix() || pose.p != ExactVector{0, 0, 0}))
      file_.notes.push_back(fmt::format("dropped: the pose of body '{}', which moves", child));
    RobotJoint fixed;
    fixed.name = fmt::format("{} (fixed)", child);
    fixed.where = fixed.parent_where = fixed.child_where = where;
    join(file_, parent, child, pose, std::move(joints), fixed);
  }

  void read_joint(const XMLElement& e, const std::string& childclass, PlacedJoint& placed) {
    RobotJoint& j = placed.joint;
    const std::string what = fmt::format("joint '{}'", j.name);
    check_joint_attributes(e, what);
    const MjcfAttributes a = with_defaults(e, childclass);
    const std::string type = word(a, "type", {"hinge", "slide", "free", "ball"}, what, "hinge");
    if (type == "ball")
      error(a.at("type").where, fmt::format("{} is a ball joint, which is not supported", what),
            "write three hinges, one after the other");
    must_be_zero(a, "springdamper", what, "write stiffness and damping", 2);
    if (type == "free") {
      j.type = RobotJointType::floating;
      for (const char* figure : {"stiffness", "damping", "frictionloss", "armature"})
        must_be_zero(a, figure, what, "write <freejoint/>, which has no such default");
      return;
    }
    const bool turns = type == "hinge";
    j.type = turns ? RobotJointType::revolute : RobotJointType::prismatic;
    j.axis = vector(a, "axis", what, {0, 0, 1});
    if (std::ranges::all_of(j.axis, [](const Exact& x) { return x.is_zero(); })) {
      error(a.at("axis").where, fmt::format("the axis of {} is zero", what),
            "write its direction, for example \"0 0 1\"");
      return;
    }
    placed.at = vector(a, "pos", what, {0, 0, 0});
    for (const auto& [figure, to] :
         {std::pair{"stiffness", &j.stiffness}, std::pair{"damping", &j.damping},
          std::pair{"frictionloss", &j.friction}, std::pair{"armature", &j.armature}}) {
      *to = number(a, figure, what, 0);
      if (const auto given = a.find(figure); given != a.end())
        check_not_negative(*to, given->second.where, figure, what);
    }
    const auto displacement = [&](const Exact& x) { return turns ? radians(x) : x; };
    j.rest = displacement(number(a, "springref", what, 0));
    const Exact reference = displacement(number(a, "ref", what, 0));
    if (!reference.is_zero()) placed.back = motion(j, -reference, what);
    reference_[j.name] = reference;
    read_range(a, what, displacement, j);
  }

  /// What a joint does by itself.
  ExactPose motion(const RobotJoint& j, const Exact& by, const std::string& what) {
    if (j.type == RobotJointType::revolute) return {orientations_.axis_angle(j.axis, by, what), {0, 0, 0}};
    const ExactVector u = unit_vector(j.axis, true);
    return {identity_matrix(), {by * u[0], by * u[1], by * u[2]}};
  }

  template <class Displacement>
  void read_range(const MjcfAttributes& a, const std::string& what, const Displacement& displacement,
                  RobotJoint& j) {
    const std::string limited = word(a, "limited", {"auto", "true", "false"}, what, "auto");
    const auto range = a.find("range");
    if (limited == "true" && range == a.end())
      error(a.at("limited").where, fmt::format("{} is limited and has no 'range'", what),
            "write range=\"... ...\"");
    if (limited == "false" || range == a.end()) return;
    const auto v = numbers_in(range->second.where, "range", range->second.text, what, 2);
    if (!v) return;
    if ((*v)[1] < (*v)[0])
      error(range->second.where,
            fmt::format("the range of {} has lower {} above upper {}", what, (*v)[0].decimal(8),
                        (*v)[1].decimal(8)),
            "exchange them");
    else if ((*v)[0] < (*v)[1])
      j.limit = {displacement((*v)[0]), displacement((*v)[1])};
  }

  // ---- couplings ------------------------------------------------------------------------------------------

  void read_equalities(const XMLElement& e) {
    check_attributes(e, "the <equality>", {});
    const std::string way = "remove it; a loop is closed by a [[constraint]] of a side-car file";
    check_children(e, "the <equality>", {"joint"}, {}, true,
                   {{"connect", way}, {"weld", way}, {"tendon", way}, {"flex", way}, {"distance", way}});
    each(e, "joint", [&](const XMLElement& joint) { read_equality(joint); });
  }

  /// joint1 - ref1 = c0 + c1 (joint2 - ref2)
  void read_equality(const XMLElement& e) {
    const std::string what = "a joint equality";
    check_attributes(e, what, {"name", "class", "active", "joint1", "joint2", "polycoef"},
                     {"solref", "solimp"});
    check_children(e, what, {});
    const MjcfAttributes a = merged({}, e, source_);
    if (word(a, "active", {"true", "false"}, what, "true") == "false") {
      leave_out("<equality> that is not active");
      return;
    }
    const std::string follower = required(e, "joint1", what), leader = required(e, "joint2", what);
    if (follower.empty() || leader.empty()) return;
    const auto joint = std::ranges::find(file_.joints, follower, &RobotJoint::name);
    for (const auto& [key, name] : {std::pair{"joint1", follower}, std::pair{"joint2", leader}}) {
      if (reference_.contains(name)) continue;
      error(source_.place(e, key), fmt::format("there is no joint '{}' that an equality can couple", name),
            did_you_mean(name, joint_names(), "name a hinge or a slide"));
    }
    if (joint == file_.joints.end() || !reference_.contains(leader)) return;
    std::vector<Exact> c = {0, 1, 0, 0, 0};
    if (const auto given = a.find("polycoef"); given != a.end()) {
      const auto v = numbers_in(given->second.where, "polycoef", given->second.text, what, 5);
      if (!v) return;
      c = *v;
      if (!c[2].is_zero() || !c[3].is_zero() || !c[4].is_zero())
        error(given->second.where,
              fmt::format("the polynomial that couples '{}' to '{}' is not linear", follower, leader),
              "remove it, and write a [[coupling]] in a side-car file");
    }
    if (joint->mimic)
      error(source_.place(e), fmt::format("joint '{}' follows two others", follower),
            "remove one of the equalities");
    joint->mimic =
        RobotMimic{leader, c[1], reference_[follower] + c[0] - c[1] * reference_[leader], source_.place(e)};
    file_.notes.push_back(
        fmt::format("assumed: joint '{}' follows '{}' exactly, not by a soft constraint", follower, leader));
  }

  [[nodiscard]] Names joint_names() const {
    Names names;
    for (const auto& [name, reference] : reference_) names.push_back(name);
    return names;
  }

  void read_tendons(const XMLElement& e) {
    check_children(e, "the <tendon>", {"fixed", "spatial"}, {}, true);
    for (const XMLElement* tendon = e.FirstChildElement(); tendon != nullptr;
         tendon = tendon->NextSiblingElement()) {
      check_tendon(*tendon);
      leave_out(fmt::format("tendon(s) <{}>", tendon->Name()));
    }
  }

  std::map<std::string, Exact> reference_;  // of hinges and slides: their coordinate in the pose of the file
  RobotFile file_;
};

}  // namespace

RobotFile read_mjcf_elements(const XmlSource& source, bool snap) { return MjcfElements(source, snap).run(); }

}  // namespace anholon
