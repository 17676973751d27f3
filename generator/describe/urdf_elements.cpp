// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/urdf_elements.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/orientations.hpp"
#include "describe/xml_reader.hpp"

namespace anholon {
namespace {

class UrdfElements : XmlReader {
 public:
  UrdfElements(const XmlSource& source, bool snap) : XmlReader(source), orientations_(snap) {}

  RobotFile run() {
    const XMLElement& root = source_.root();
    check_attributes(root, "the robot", {"name", "version", "xmlns:xacro"});
    file_.name = required(root, "name", "the robot");
    check_children(root, "the robot", {"link", "joint"}, {"material", "transmission", "gazebo", "sensor"},
                   true);
    for (const XMLElement* e = root.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      if (std::string_view(e->Name()) == "link") read_link(*e);
      if (std::string_view(e->Name()) == "joint") read_joint(*e);
    }
    if (file_.links.empty()) error(source_.place(root), "the robot has no link", "write at least one <link>");
    findings_.throw_if_any();
    file_.notes = dropped();
    file_.notes.insert(file_.notes.end(), orientations_.notes().begin(), orientations_.notes().end());
    return std::move(file_);
  }

 private:
  ExactPose origin(const XMLElement* e, const std::string& of) {
    ExactPose result;
    if (e == nullptr) return result;
    const std::string what = fmt::format("the origin of {}", of);
    check_attributes(*e, what, {"xyz", "rpy"});
    check_children(*e, what, {});
    result.p = vector(*e, "xyz", what, result.p);
    result.R = orientations_.rpy(vector(*e, "rpy", what, {0, 0, 0}), of);
    return result;
  }

  void read_link(const XMLElement& e) {
    RobotLink link;
    link.where = source_.place(e);
    link.name = required(e, "name", "a link");
    const std::string what = fmt::format("link '{}'", link.name);
    check_attributes(e, what, {"name"}, {"type"});
    check_children(e, what, {"inertial"}, {"visual", "collision", "contact", "self_collision_checking"});
    if (const XMLElement* inertial = e.FirstChildElement("inertial"))
      link.inertial = read_inertial(*inertial, what);
    file_.links.push_back(std::move(link));
  }

  RobotInertial read_inertial(const XMLElement& e, const std::string& link) {
    RobotInertial result;
    result.where = source_.place(e);
    const std::string what = fmt::format("the inertial of {}", link);
    check_attributes(e, what, {});
    check_children(e, what, {"origin", "mass", "inertia"});
    result.pose = origin(e.FirstChildElement("origin"), what);
    if (const XMLElement* mass = e.FirstChildElement("mass")) {
      check_attributes(*mass, fmt::format("the mass of {}", link), {"value"});
      check_children(*mass, fmt::format("the mass of {}", link), {});
      result.mass = number(*mass, "value", fmt::format("the mass of {}", link));
      check_mass(result.mass, source_.place(*mass, "value"), link);
    } else {
      error(result.where, fmt::format("{} has no <mass>", what), "write <mass value=\"...\"/>");
    }
    if (const XMLElement* inertia = e.FirstChildElement("inertia")) {
      const std::string tensor = fmt::format("the inertia of {}", link);
      check_attributes(*inertia, tensor, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
      check_children(*inertia, tensor, {});
      constexpr std::array<const char*, 6> entries = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
      for (std::size_t i = 0; i < 6; ++i) result.inertia[i] = number(*inertia, entries[i], tensor);
      check_definite(result.inertia, source_.place(*inertia), tensor, "ixx ixy ixz iyy iyz izz");
    } else {
      error(result.where, fmt::format("{} has no <inertia>", what), "write <inertia ixx=\"...\" .../>");
    }
    return result;
  }

  void read_joint(const XMLElement& e) {
    RobotJoint joint;
    joint.where = joint.parent_where = joint.child_where = source_.place(e);
    joint.name = required(e, "name", "a joint");
    const std::string what = fmt::format("joint '{}'", joint.name);
    check_attributes(e, what, {"name", "type"});
    check_children(e, what, {"parent", "child", "origin", "axis", "limit", "dynamics", "mimic"},
                   {"calibration", "safety_controller", "hardwareInterface"});
    const Names types = {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
    const std::string type = required(e, "type", what);
    const auto found = std::ranges::find(types, type);
    if (found != types.end()) {
      joint.type = static_cast<RobotJointType>(found - types.begin());
    } else if (!type.empty()) {
      error(source_.place(e, "type"), fmt::format("{} has the type '{}'", what, type),
            did_you_mean(type, types, fmt::format("known are {}", listed(types))));
    }
    joint.parent = link_of(e, "parent", what, joint.parent_where);
    joint.child = link_of(e, "child", what, joint.child_where);
    joint.pose = origin(e.FirstChildElement("origin"), what);
    if (const XMLElement* axis = e.FirstChildElement("axis")) {
      const std::string of = fmt::format("the axis of {}", what);
      check_attributes(*axis, of, {"xyz"});
      check_children(*axis, of, {});
      const std::size_t before = findings_.size();
      joint.axis = vector(*axis, "xyz", of, joint.axis);
      const bool is_zero = std::ranges::all_of(joint.axis, [](const Exact& x) { return x.is_zero(); });
      if (is_zero && findings_.size() == before && joint.type != RobotJointType::fixed)
        error(source_.place(*axis, "xyz"), fmt::format("{} is zero", of),
              "write its direction, for example \"0 0 1\"");
    }
    read_limit(e, what, joint);
    if (const XMLElement* dynamics = e.FirstChildElement("dynamics")) {
      const std::string of = fmt::format("the dynamics of {}", what);
      check_attributes(*dynamics, of, {"damping", "friction"}, {"spring_reference", "spring_stiffness"});
      check_children(*dynamics, of, {});
      joint.damping = not_negative(*dynamics, "damping", of);
      joint.friction = not_negative(*dynamics, "friction", of);
    }
    if (const XMLElement* mimic = e.FirstChildElement("mimic")) {
      const std::string of = fmt::format("the mimic of {}", what);
      check_attributes(*mimic, of, {"joint", "multiplier", "offset"});
      check_children(*mimic, of, {});
      joint.mimic = RobotMimic{required(*mimic, "joint", of), number(*mimic, "multiplier", of, 1),
                               number(*mimic, "offset", of, 0), source_.place(*mimic)};
    }
    file_.joints.push_back(std::move(joint));
  }

  void read_limit(const XMLElement& e, const std::string& what, RobotJoint& joint) {
    const XMLElement* limit = e.FirstChildElement("limit");
    const bool bounded = joint.type == RobotJointType::revolute || joint.type == RobotJointType::prismatic;
    if (limit == nullptr) {
      if (joint.type == RobotJointType::prismatic && e.FirstChildElement("mimic") == nullptr)
        error(source_.place(e), fmt::format("{} is prismatic and has no <limit>", what),
              "write its working range, <limit lower=\"...\" upper=\"...\" effort=\"0\" velocity=\"0\"/>");
      return;
    }
    const std::string of = fmt::format("the limit of {}", what);
    check_attributes(*limit, of, {"lower", "upper", "effort", "velocity"},
                     {"acceleration", "command_effort", "current", "gear_velocity", "jerk"});
    check_children(*limit, of, {});
    const std::array<Exact, 2> range = {number(*limit, "lower", of, 0), number(*limit, "upper", of, 0)};
    for (const char* attribute : {"effort", "velocity"}) number(*limit, attribute, of, 0);
    if (range[1] < range[0]) {
      error(source_.place(*limit, "lower"),
            fmt::format("{} has lower {} above upper {}", of, range[0].decimal(8), range[1].decimal(8)),
            "exchange them");
    } else if (bounded && range[0] < range[1]) {
      joint.limit = range;
    }
  }

  Exact not_negative(const XMLElement& e, const char* attribute, const std::string& what) {
    const Exact x = number(e, attribute, what, 0);
    check_not_negative(x, source_.place(e, attribute), attribute, what);
    return x;
  }

  std::string link_of(const XMLElement& joint, const char* role, const std::string& what, Location& where) {
    const XMLElement* e = joint.FirstChildElement(role);
    if (e == nullptr) {
      error(where, fmt::format("{} has no <{}>", what, role), fmt::format("write <{} link=\"...\"/>", role));
      return "";
    }
    const std::string of = fmt::format("the {} of {}", role, what);
    check_attributes(*e, of, {"link"});
    check_children(*e, of, {});
    where = source_.place(*e, "link");
    return required(*e, "link", of);
  }

  Orientations orientations_;
  RobotFile file_;
};

}  // namespace

RobotFile read_urdf_elements(const XmlSource& source, bool snap) { return UrdfElements(source, snap).run(); }

}  // namespace anholon
