// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/urdf_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "describe/names.hpp"

namespace anholon {
namespace {

using tinyxml2::XMLElement;
using Names = std::vector<std::string>;

/// Larger numbers are taken for slips of the pen.
const Exact& largest_number() {
  static const Exact largest = Exact::from_decimal("1e30");
  return largest;
}

class ElementReader {
 public:
  explicit ElementReader(const XmlSource& source) : source_(source) {}

  UrdfFile run() {
    const XMLElement& root = source_.root();
    if (std::string_view(root.Name()) != "robot")
      throw ModelError(source_.place(root), fmt::format("the outermost element is <{}>", root.Name()),
                       "a URDF file is one <robot>");
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
    for (const auto& [what, number] : ignored_)
      file_.notes.push_back(fmt::format("dropped: {} {}", number, what));
    return std::move(file_);
  }

 private:
  void error(Location where, std::string fact, std::string mend) {
    findings_.error(std::move(where), std::move(fact), std::move(mend));
  }

  /// @param ignored  attributes that are read over, with a note
  void check_attributes(const XMLElement& e, const std::string& what, const Names& known,
                        const Names& ignored = {}) {
    for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
      if (std::ranges::find(known, a->Name()) != known.end()) continue;
      if (std::ranges::find(ignored, a->Name()) != ignored.end()) {
        ++ignored_[fmt::format("attribute(s) '{}' of <{}>", a->Name(), e.Name())];
        continue;
      }
      error(
          source_.place(e, a->Name()), fmt::format("{} has an unknown attribute '{}'", what, a->Name()),
          did_you_mean(a->Name(), known,
                       known.empty() ? "it has no attributes" : fmt::format("known are {}", listed(known))));
    }
  }

  /// @param repeated  whether known elements may come more than once
  void check_children(const XMLElement& e, const std::string& what, const Names& known,
                      const Names& ignored = {}, bool repeated = false) {
    Names seen;
    Names all = known;
    all.insert(all.end(), ignored.begin(), ignored.end());
    for (const auto* node = e.FirstChild(); node != nullptr; node = node->NextSibling()) {
      if (node->ToText() != nullptr)
        error(source_.place(e), fmt::format("{} has text in it", what),
              "remove the text; data stands in attributes");
      const XMLElement* child = node->ToElement();
      if (child == nullptr) continue;
      if (std::ranges::find(ignored, child->Name()) != ignored.end()) {
        ++ignored_[fmt::format("<{}>", child->Name())];
      } else if (std::ranges::find(known, child->Name()) == known.end()) {
        error(source_.place(*child), fmt::format("{} has an unknown element <{}>", what, child->Name()),
              did_you_mean(child->Name(), all,
                           all.empty() ? "it has no elements" : fmt::format("known are {}", listed(all))));
      } else if (!repeated && std::ranges::find(seen, child->Name()) != seen.end()) {
        error(source_.place(*child), fmt::format("{} has a second <{}>", what, child->Name()),
              "remove one of them");
      }
      seen.emplace_back(child->Name());
    }
  }

  std::string required(const XMLElement& e, const char* attribute, const std::string& what) {
    const char* value = e.Attribute(attribute);
    if (value != nullptr && *value != '\0') return value;
    error(source_.place(e, attribute),
          fmt::format("{} has {} '{}'", what, value == nullptr ? "no" : "an empty", attribute),
          fmt::format("write {}=\"...\"", attribute));
    return "";
  }

  Exact number_in(const XMLElement& e, const char* attribute, std::string_view text,
                  const std::string& what) {
    try {
      const Exact x = Exact::from_decimal(text);
      if (abs(x) <= largest_number()) return x;
      error(source_.place(e, attribute), fmt::format("{} of {} is {}", attribute, what, text),
            "no number may exceed 1e30");
    } catch (const std::invalid_argument&) {
      error(source_.place(e, attribute),
            fmt::format("{} of {} is '{}', not a finite decimal number", attribute, what, text),
            "write a number like -0.25 or 1.5e-3");
    }
    return 0;
  }

  static std::vector<std::string_view> words(std::string_view text) {
    std::vector<std::string_view> result;
    constexpr std::string_view spaces = " \t\n\r";
    for (std::size_t at = text.find_first_not_of(spaces); at < text.size();
         at = text.find_first_not_of(spaces, at)) {
      const std::size_t end = std::min(text.find_first_of(spaces, at), text.size());
      result.push_back(text.substr(at, end - at));
      at = end;
    }
    return result;
  }

  Exact number(const XMLElement& e, const char* attribute, const std::string& what) {
    const std::string text = required(e, attribute, what);
    if (text.empty()) return 0;
    const auto parts = words(text);
    if (parts.size() == 1) return number_in(e, attribute, parts[0], what);
    error(source_.place(e, attribute), fmt::format("{} of {} is '{}'", attribute, what, text),
          "write one number");
    return 0;
  }

  Exact number(const XMLElement& e, const char* attribute, const std::string& what, const Exact& otherwise) {
    return e.Attribute(attribute) == nullptr ? otherwise : number(e, attribute, what);
  }

  ExactVector vector(const XMLElement& e, const char* attribute, const std::string& what,
                     const ExactVector& otherwise) {
    const char* text = e.Attribute(attribute);
    if (text == nullptr) return otherwise;
    const auto parts = words(text);
    if (parts.size() != 3) {
      error(source_.place(e, attribute),
            fmt::format("{} of {} has {} numbers", attribute, what, parts.size()), "write three");
      return otherwise;
    }
    ExactVector v;
    for (std::size_t i = 0; i < 3; ++i) v[i] = number_in(e, attribute, parts[i], what);
    return v;
  }

  UrdfOrigin origin(const XMLElement* e, const std::string& of) {
    UrdfOrigin result;
    if (e == nullptr) return result;
    const std::string what = fmt::format("the origin of {}", of);
    check_attributes(*e, what, {"xyz", "rpy"});
    check_children(*e, what, {});
    result.xyz = vector(*e, "xyz", what, result.xyz);
    result.rpy = vector(*e, "rpy", what, result.rpy);
    return result;
  }

  void read_link(const XMLElement& e) {
    UrdfLink link;
    link.where = source_.place(e);
    link.name = required(e, "name", "a link");
    const std::string what = fmt::format("link '{}'", link.name);
    check_attributes(e, what, {"name"}, {"type"});
    check_children(e, what, {"inertial"}, {"visual", "collision", "contact", "self_collision_checking"});
    if (const XMLElement* inertial = e.FirstChildElement("inertial"))
      link.inertial = read_inertial(*inertial, what);
    file_.links.push_back(std::move(link));
  }

  UrdfInertial read_inertial(const XMLElement& e, const std::string& link) {
    UrdfInertial result;
    result.where = source_.place(e);
    const std::string what = fmt::format("the inertial of {}", link);
    check_attributes(e, what, {});
    check_children(e, what, {"origin", "mass", "inertia"});
    result.origin = origin(e.FirstChildElement("origin"), what);
    if (const XMLElement* mass = e.FirstChildElement("mass")) {
      check_attributes(*mass, fmt::format("the mass of {}", link), {"value"});
      check_children(*mass, fmt::format("the mass of {}", link), {});
      result.mass = number(*mass, "value", fmt::format("the mass of {}", link));
      if (result.mass < Exact(0))
        error(source_.place(*mass, "value"),
              fmt::format("the mass of {} is {}", link, result.mass.decimal(8)), "it must not be negative");
    } else {
      error(result.where, fmt::format("{} has no <mass>", what), "write <mass value=\"...\"/>");
    }
    if (const XMLElement* inertia = e.FirstChildElement("inertia")) {
      const std::string tensor = fmt::format("the inertia of {}", link);
      check_attributes(*inertia, tensor, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"});
      check_children(*inertia, tensor, {});
      constexpr std::array<const char*, 6> entries = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
      for (std::size_t i = 0; i < 6; ++i) result.inertia[i] = number(*inertia, entries[i], tensor);
      check_definite(result.inertia, source_.place(*inertia), tensor);
    } else {
      error(result.where, fmt::format("{} has no <inertia>", what), "write <inertia ixx=\"...\" .../>");
    }
    return result;
  }

  /// Principal minors must not be negative. Rounding of the file's own figures is forgiven.
  void check_definite(const std::array<Exact, 6>& I, const Location& where, const std::string& what) {
    const Exact& xx = I[0];
    const Exact& yy = I[1];
    const Exact& zz = I[2];
    const Exact& xy = I[3];
    const Exact& xz = I[4];
    const Exact& yz = I[5];
    const Exact scale = abs(xx) + abs(yy) + abs(zz) + abs(xy) + abs(xz) + abs(yz);
    const Exact tolerance = Exact::from_decimal("1e-9");
    const Exact det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    bool good = !(xx < Exact(0)) && !(yy < Exact(0)) && !(zz < Exact(0));
    for (const Exact& minor : {xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz})
      good = good && !(minor < -tolerance * scale * scale);
    good = good && !(det < -tolerance * scale * scale * scale);
    if (!good)
      error(where, fmt::format("{} is not positive semidefinite", what),
            "check the signs and the order ixx ixy ixz iyy iyz izz");
  }

  void read_joint(const XMLElement& e) {
    UrdfJoint joint;
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
      joint.type = static_cast<UrdfJointType>(found - types.begin());
    } else if (!type.empty()) {
      error(source_.place(e, "type"), fmt::format("{} has the type '{}'", what, type),
            did_you_mean(type, types, fmt::format("known are {}", listed(types))));
    }
    joint.parent = link_of(e, "parent", what, joint.parent_where);
    joint.child = link_of(e, "child", what, joint.child_where);
    joint.origin = origin(e.FirstChildElement("origin"), what);
    if (const XMLElement* axis = e.FirstChildElement("axis")) {
      const std::string of = fmt::format("the axis of {}", what);
      check_attributes(*axis, of, {"xyz"});
      check_children(*axis, of, {});
      const std::size_t before = findings_.size();
      joint.axis = vector(*axis, "xyz", of, joint.axis);
      const bool is_zero = std::ranges::all_of(joint.axis, [](const Exact& x) { return x.is_zero(); });
      if (is_zero && findings_.size() == before && joint.type != UrdfJointType::fixed)
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
      joint.mimic = UrdfMimic{required(*mimic, "joint", of), number(*mimic, "multiplier", of, 1),
                              number(*mimic, "offset", of, 0), source_.place(*mimic)};
    }
    file_.joints.push_back(std::move(joint));
  }

  void read_limit(const XMLElement& e, const std::string& what, UrdfJoint& joint) {
    const XMLElement* limit = e.FirstChildElement("limit");
    const bool bounded = joint.type == UrdfJointType::revolute || joint.type == UrdfJointType::prismatic;
    if (limit == nullptr) {
      if (joint.type == UrdfJointType::prismatic && e.FirstChildElement("mimic") == nullptr)
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
    if (x < Exact(0))
      error(source_.place(e, attribute), fmt::format("{} of {} is {}", attribute, what, x.decimal(8)),
            "it must not be negative");
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

  const XmlSource& source_;
  Findings findings_;
  UrdfFile file_;
  std::map<std::string, int> ignored_;
};

}  // namespace

UrdfFile read_urdf_elements(const XmlSource& source) { return ElementReader(source).run(); }

}  // namespace anholon
