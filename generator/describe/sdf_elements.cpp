// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/sdf_elements.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/sdf_frames.hpp"
#include "describe/sdf_values.hpp"

namespace anholon {
namespace {

/// A joint as the file has it, until all frames are known.
struct SdfJoint {
  RobotJoint joint;
  std::string axis_frame;
};

class SdfElements : SdfValues {
 public:
  SdfElements(const XmlSource& source, bool snap) : SdfValues(source, snap), frames_(findings_) {}

  RobotFile run() {
    const XMLElement& model = find_model(source_.root());
    read_model(model);
    findings_.throw_if_any();
    for (SdfJoint& j : joints_) resolve(j);
    if (findings_.empty()) frames_.check();
    findings_.throw_if_any();
    place_joints();
    say_base(model);
    Names notes = dropped();
    notes.insert(notes.end(), orientations_.notes().begin(), orientations_.notes().end());
    file_.notes.insert(file_.notes.begin(), notes.begin(), notes.end());
    return std::move(file_);
  }

 private:
  const XMLElement& find_model(const XMLElement& root) {
    check_attributes(root, "the file", {"version", "xmlns:xacro", "xmlns:gz", "xmlns:ignition"});
    const Names versions = {"1.5", "1.6", "1.7", "1.8", "1.9", "1.10", "1.11", "1.12"};
    const std::string version = required(root, "version", "the file");
    const auto found = std::ranges::find(versions, version);
    if (found == versions.end() && !version.empty())
      error(source_.place(root, "version"), fmt::format("the file is of version {}", version),
            "versions 1.5 to 1.12 are read; older files can be converted by 'gz sdf -p'");
    named_frames_ = found - versions.begin() >= 2;
    const std::string way = "write the robot alone, as one <model> right in <sdf>";
    check_children(root, "the file", {"model"}, {}, false, {{"world", way}, {"light", way}, {"actor", way}});
    const XMLElement* model = root.FirstChildElement("model");
    findings_.throw_if_any();
    if (model == nullptr) throw ModelError(source_.place(root), "the file has no model", "write one <model>");
    return *model;
  }

  void read_model(const XMLElement& e) {
    file_.name = required(e, "name", "the model");
    check_attributes(e, "the model", {"name"}, {"canonical_link"});
    Names known = {"pose", "static", "link", "joint"};
    if (named_frames_) known.emplace_back("frame");
    check_parts(e, known);
    if (const XMLElement* is_static = e.FirstChildElement("static")) {
      if (flag(*is_static, "static of the model"))
        error(source_.place(*is_static), "the model is static",
              "remove it; what is fixed to the world is joined to it");
    }
    const XMLElement* pose = e.FirstChildElement("pose");
    frames_.add(model_frame, world_frame, read_pose(pose, "the model", nullptr), source_.place(e));
    model_is_placed_ = pose != nullptr;
    for (const XMLElement* part = e.FirstChildElement(); part != nullptr; part = part->NextSiblingElement()) {
      const std::string_view name = part->Name();
      if (name == "link") read_link(*part);
      if (name == "joint") read_joint(*part);
      if (name == "frame") read_frame(*part);
    }
    if (file_.links.empty() && findings_.empty())
      error(source_.place(e), "the model has no link", "write at least one <link>");
  }

  /// Links, joints and frames may be many; what the model has besides, once.
  void check_parts(const XMLElement& e, const Names& known) {
    const std::string flat = "write its links and joints right into this model";
    check_children(e, "the model", known,
                   {"plugin", "self_collide", "allow_auto_disable", "enable_wind", "gripper"}, true,
                   {{"include", flat}, {"model", flat}});
    for (const char* once : {"pose", "static"}) {
      const XMLElement* first = e.FirstChildElement(once);
      const XMLElement* second = first == nullptr ? nullptr : first->NextSiblingElement(once);
      if (second != nullptr)
        error(source_.place(*second), fmt::format("the model has a second <{}>", once), "remove one of them");
    }
  }

  void read_link(const XMLElement& e) {
    RobotLink link;
    link.where = source_.place(e);
    link.name = required(e, "name", "a link");
    const std::string what = fmt::format("link '{}'", link.name);
    check_attributes(e, what, {"name"});
    check_children(e, what, {"pose", "inertial", "gravity", "kinematic"},
                   {"visual", "collision", "sensor", "light", "audio_sink", "audio_source", "battery",
                    "particle_emitter", "projector", "self_collide", "enable_wind", "must_be_base_link",
                    "plugin", "velocity_decay"});
    const XMLElement* gravity = e.FirstChildElement("gravity");
    if (gravity != nullptr && !flag(*gravity, fmt::format("gravity of {}", what)))
      error(source_.place(*gravity), fmt::format("gravity does not act on {}", what),
            "let it act on all links");
    const XMLElement* kinematic = e.FirstChildElement("kinematic");
    if (kinematic != nullptr && flag(*kinematic, fmt::format("kinematic of {}", what)))
      error(source_.place(*kinematic), fmt::format("{} is kinematic", what),
            "only links that forces move are read");
    if (const XMLElement* inertial = e.FirstChildElement("inertial")) {
      link.inertial = read_inertial(*inertial, what);
    } else {
      link.inertial = RobotInertial{{}, 1, {1, 1, 1, 0, 0, 0}, link.where};
      file_.notes.push_back(fmt::format(
          "assumed: {} has no inertial: 1 kg and 1 kg m^2 about each axis, as SDFormat has it", what));
    }
    add_frame(e, link.name, model_frame, what);
    file_.links.push_back(std::move(link));
  }

  void add_frame(const XMLElement& e, const std::string& name, std::string in, const std::string& what) {
    const XMLElement* pose = e.FirstChildElement("pose");
    const ExactPose value = read_pose(pose, what, &in);
    if (!name.empty())
      frames_.add(name, in, value, pose != nullptr ? source_.place(*pose, "relative_to") : source_.place(e));
  }

  void read_frame(const XMLElement& e) {
    const std::string name = required(e, "name", "a frame");
    const std::string what = fmt::format("frame '{}'", name);
    check_attributes(e, what, {"name", "attached_to"});
    check_children(e, what, {"pose"});
    const char* carrier = e.Attribute("attached_to");
    const std::string on = carrier == nullptr || *carrier == '\0' ? model_frame : carrier;
    carrier_[name] = on;
    add_frame(e, name, on, what);
  }

  void read_joint(const XMLElement& e) {
    SdfJoint j;
    RobotJoint& joint = j.joint;
    joint.where = joint.parent_where = joint.child_where = source_.place(e);
    joint.name = required(e, "name", "a joint");
    const std::string what = fmt::format("joint '{}'", joint.name);
    check_attributes(e, what, {"name", "type"});
    joint.type = read_type(e, what);
    check_children(e, what, {"parent", "child", "pose", "axis"}, {"physics", "sensor", "plugin"}, false,
                   {{"axis2", "write two joints with a link between them"},
                    {"gearbox_ratio", "write a coupling in a side-car file"},
                    {"thread_pitch", "write a helical joint in a model file"}});
    joint.parent = link_of(e, "parent", what, joint.parent_where);
    joint.child = link_of(e, "child", what, joint.child_where);
    add_frame(e, joint.name, joint.child, what);
    j.axis_frame = joint.name;
    const XMLElement* axis = e.FirstChildElement("axis");
    if (axis != nullptr && joint.type != RobotJointType::fixed) {
      read_axis(*axis, what, j);
    } else if (joint.type != RobotJointType::fixed) {
      error(joint.where, fmt::format("{} has no <axis>", what), "write <axis><xyz>...</xyz></axis>");
    }
    joints_.push_back(std::move(j));
  }

  RobotJointType read_type(const XMLElement& e, const std::string& what) {
    const Names types = {"revolute", "continuous", "prismatic", "fixed"};
    const std::map<std::string, std::string> others = {
        {"ball", "write three revolute joints with massless links between them"},
        {"universal", "write two revolute joints with a massless link between them"},
        {"revolute2", "write two revolute joints with a link between them"},
        {"screw", "write a helical joint in a model file"},
        {"gearbox", "write a coupling in a side-car file"}};
    const std::string type = required(e, "type", what);
    const auto found = std::ranges::find(types, type);
    if (found != types.end()) return static_cast<RobotJointType>(found - types.begin());
    if (const auto other = others.find(type); other != others.end())
      error(source_.place(e, "type"), fmt::format("{} has the type '{}', which is not supported", what, type),
            other->second);
    else if (!type.empty())
      error(source_.place(e, "type"), fmt::format("{} has the type '{}'", what, type),
            did_you_mean(type, types, fmt::format("known are {}", listed(types))));
    return RobotJointType::fixed;
  }

  std::string link_of(const XMLElement& joint, const char* role, const std::string& what, Location& where) {
    const XMLElement* e = joint.FirstChildElement(role);
    if (e == nullptr) {
      error(where, fmt::format("{} has no <{}>", what, role), fmt::format("write <{0}>link</{0}>", role));
      return "";
    }
    where = source_.place(*e);
    const std::string name = text(*e, fmt::format("the {} of {}", role, what));
    if (name.empty())
      error(where, fmt::format("the {} of {} is empty", role, what), "write the name of a link");
    return name;
  }

  void read_axis(const XMLElement& e, const std::string& joint, SdfJoint& j) {
    const std::string what = fmt::format("the axis of {}", joint);
    check_attributes(e, what, {});
    Names known = {"xyz", "limit", "dynamics", "mimic"};
    if (!named_frames_) known.emplace_back("use_parent_model_frame");
    check_children(e, what, known, {"initial_position"});
    const XMLElement* xyz = e.FirstChildElement("xyz");
    if (xyz == nullptr) {
      error(source_.place(e), fmt::format("{} has no <xyz>", what), "write its direction, for example 0 0 1");
      return;
    }
    const std::string numbers = text(*xyz, what, named_frames_ ? Names{"expressed_in"} : Names{});
    if (const char* in = xyz->Attribute("expressed_in"); in != nullptr && *in != '\0' && named_frames_)
      j.axis_frame = in;
    const XMLElement* model = e.FirstChildElement("use_parent_model_frame");
    if (model != nullptr && !named_frames_ && flag(*model, fmt::format("use_parent_model_frame of {}", what)))
      j.axis_frame = model_frame;
    if (const auto v = numbers_in(source_.place(*xyz), "xyz", numbers, what, 3)) {
      j.joint.axis = {(*v)[0], (*v)[1], (*v)[2]};
      if (std::ranges::all_of(*v, [](const Exact& x) { return x.is_zero(); }))
        error(source_.place(*xyz), fmt::format("{} is zero", what), "write its direction, for example 0 0 1");
    }
    read_limit(e, joint, j.joint);
    read_dynamics(e, joint, j.joint);
    read_mimic(e, joint, j.joint);
  }

  /// A bound of 1e16 or more, or inf, is none.
  std::optional<Exact> bound(const XMLElement& limit, const char* name, const std::string& what) {
    const XMLElement* e = limit.FirstChildElement(name);
    if (e == nullptr) return std::nullopt;
    const std::string value = text(*e, what);
    if (value == "inf" || value == "-inf" || value == "+inf") return std::nullopt;
    const auto v = numbers_in(source_.place(*e), name, value, what, 1);
    if (!v || abs(v->front()) >= Exact::from_decimal("1e16")) return std::nullopt;
    return v->front();
  }

  void read_limit(const XMLElement& axis, const std::string& joint, RobotJoint& to) {
    const XMLElement* limit = axis.FirstChildElement("limit");
    if (limit == nullptr) return;
    const std::string what = fmt::format("the limit of {}", joint);
    check_attributes(*limit, what, {});
    check_children(*limit, what, {"lower", "upper", "effort", "velocity"}, {"stiffness", "dissipation"});
    const auto lower = bound(*limit, "lower", what), upper = bound(*limit, "upper", what);
    for (const char* name : {"effort", "velocity"}) bound(*limit, name, what);
    if (lower && upper && *upper < *lower) {
      error(source_.place(*limit),
            fmt::format("{} has lower {} above upper {}", what, lower->decimal(8), upper->decimal(8)),
            "exchange them");
    } else if (lower && upper && to.type != RobotJointType::continuous) {
      if (*lower < *upper) to.limit = {*lower, *upper};
    } else if (lower.has_value() != upper.has_value()) {
      error(source_.place(*limit), fmt::format("{} has one bound alone", what), "write <lower> and <upper>");
    }
  }

  void read_dynamics(const XMLElement& axis, const std::string& joint, RobotJoint& to) {
    const XMLElement* dynamics = axis.FirstChildElement("dynamics");
    if (dynamics == nullptr) return;
    const std::string what = fmt::format("the dynamics of {}", joint);
    check_attributes(*dynamics, what, {});
    check_children(*dynamics, what, {"damping", "friction", "spring_stiffness", "spring_reference"});
    const std::array<std::pair<const char*, Exact*>, 3> figures = {
        {{"damping", &to.damping}, {"friction", &to.friction}, {"spring_stiffness", &to.stiffness}}};
    for (const auto& figure : figures) {
      *figure.second = number_in_child(*dynamics, figure.first, what);
      if (const XMLElement* e = dynamics->FirstChildElement(figure.first))
        check_not_negative(*figure.second, source_.place(*e), figure.first, what);
    }
    to.rest = number_in_child(*dynamics, "spring_reference", what);
  }

  /// position = multiplier (position of the leader - reference) + offset
  void read_mimic(const XMLElement& axis, const std::string& joint, RobotJoint& to) {
    const XMLElement* mimic = axis.FirstChildElement("mimic");
    if (mimic == nullptr) return;
    const std::string what = fmt::format("the mimic of {}", joint);
    check_attributes(*mimic, what, {"joint"});
    check_children(*mimic, what, {"multiplier", "offset", "reference"});
    RobotMimic m;
    m.where = source_.place(*mimic);
    m.joint = required(*mimic, "joint", what);
    if (mimic->FirstChildElement("multiplier") != nullptr)
      m.multiplier = number_in_child(*mimic, "multiplier", what);
    m.offset =
        number_in_child(*mimic, "offset", what) - m.multiplier * number_in_child(*mimic, "reference", what);
    to.mimic = m;
  }

  /// Parent and child as links, where frames on them are named.
  void resolve(SdfJoint& j) {
    RobotJoint& joint = j.joint;
    for (const auto& end :
         {std::pair{&joint.parent, &joint.parent_where}, std::pair{&joint.child, &joint.child_where}}) {
      std::string name = *end.first;
      for (std::size_t steps = 0; carrier_.contains(name) && steps <= carrier_.size(); ++steps)
        name = carrier_[name];
      const bool is_world = name == world_frame && end.first == &joint.parent;
      if (name == world_frame && !is_world)
        error(*end.second, fmt::format("the world is the child of joint '{}'", joint.name),
              "let it be the parent");
      if (!is_world && std::ranges::find(file_.links, name, &RobotLink::name) == file_.links.end())
        error(*end.second,
              fmt::format("joint '{}' names a link '{}' that does not exist", joint.name, *end.first),
              did_you_mean(*end.first, link_names(), "write a <link> of this name"));
      *end.first = name;
    }
    if (!frames_.has(j.axis_frame))
      error(
          joint.where,
          fmt::format("the axis of joint '{}' is expressed in a frame '{}' that does not exist", joint.name,
                      j.axis_frame),
          did_you_mean(j.axis_frame, frames_.names(), fmt::format("there are {}", listed(frames_.names()))));
  }

  [[nodiscard]] Names link_names() const {
    Names names;
    for (const RobotLink& link : file_.links) names.push_back(link.name);
    return names;
  }

  /// The frames of the file become poses of links in their parents.
  void place_joints() {
    for (const SdfJoint& j : joints_) {
      PlacedJoint placed{j.joint, frames_.between(j.joint.child, j.joint.name).p, {}};
      if (j.joint.type != RobotJointType::fixed)
        placed.joint.axis = product(frames_.between(j.joint.child, j.axis_frame).R, j.joint.axis);
      RobotJoint fixed;
      fixed.name = fmt::format("{} (fixed)", j.joint.name);
      fixed.where = j.joint.where, fixed.parent_where = j.joint.parent_where,
      fixed.child_where = j.joint.child_where;
      join(file_, j.joint.parent, j.joint.child, frames_.between(j.joint.parent, j.joint.child), {placed},
           fixed);
    }
  }

  void say_base(const XMLElement& model) {
    const bool joined =
        std::ranges::any_of(joints_, [](const SdfJoint& j) { return j.joint.parent == world_frame; });
    file_.base = joined ? RobotBase::fixed : RobotBase::free;
    if (joined) {
      file_.links.insert(file_.links.begin(), {world_frame, std::nullopt, true, source_.place(model)});
      return;
    }
    file_.notes.emplace_back("assumed: no joint has the parent 'world': the root link moves in SE(3)");
    if (model_is_placed_) file_.notes.emplace_back("dropped: the pose of the model, which moves");
  }

  SdfFrames frames_;
  bool model_is_placed_ = false;
  std::map<std::string, std::string> carrier_;  // what each <frame> is attached to
  std::vector<SdfJoint> joints_;
  RobotFile file_;
};

}  // namespace

RobotFile read_sdf_elements(const XmlSource& source, bool snap) { return SdfElements(source, snap).run(); }

}  // namespace anholon
